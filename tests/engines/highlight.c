// SPDX-License-Identifier: BSD-3-Clause
// Restored highlights: both formulas against double precision, and forwards and backwards; then whole frames with every
// engine, in every format, in place, with any number of threads.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pixel/highlight.h"
#include "pixel/kernels.h"
#include "support/check.h"
#include "support/image.h"
#include "tools/common/report.h"

static const struct hf_highlight_params cases[] = {
    {8, 0.9f, {0}}, {64, 0.99f, {0}}, {64, 0, {0}}, {1.01f, 0.5f, {0}}, {16, 0.8f, {0}}};
enum { CASES = sizeof cases / sizeof *cases };

// m raised in double precision; the parameters are floats.
static double raised(const struct hf_highlight_params *p, double m)
{
    const double t = fmin(fmax((m - (double)p->threshold) / (1 - (double)p->threshold), 0), 1);
    return m + ((double)p->gain - 1) * t * t;
}

// The inverse, found by bisection.
static double lowered(const struct hf_highlight_params *p, double most)
{
    double low = 0, high = most;
    for (int i = 0; i < 200; i++) {
        const double m = 0.5 * (low + high);
        if (raised(p, m) < most)
            low = m;
        else
            high = m;
    }
    return 0.5 * (low + high);
}

// Roundings, each of at most half a last place, 2^-24. Raising: m - threshold 1; the scale 2, the product 1; doubled by
// the square, which adds 1; gain - 1 and the product with it 2; quotient, product and sum 3: 14. Lowering: d 1, the
// root's argument 4, halved; span 1, sum and quotient 2, product and sum with the threshold 2; the part and the product
// 2: fewer than 14. One more for the float that bisection finds.
static const double ROUNDINGS = 15 * 0x1p-24;

// Luminance rounds three times, which changes the result by its condition number: m M'(m) / M(m) for raising; for
// lowering M / m beyond the gain, where m grows as M does, and less than 1 below.
static double condition(const struct hf_highlight_params *p, double m)
{
    const double span = 1 - (double)p->threshold, t = fmin(fmax((m - (double)p->threshold) / span, 0), 1);
    return m * (1 + 2 * ((double)p->gain - 1) * t / span) / raised(p, m);
}

static double luminance(const float v[3])
{
    return (double)HF_LUMINANCE_R * fmax(v[0], 0) + (double)HF_LUMINANCE_G * fmax(v[1], 0) +
           (double)HF_LUMINANCE_B * fmax(v[2], 0);
}

// How far channels that were raised are off from `times` their value, relative; a negative channel must not change.
static double off_by(const float from[3], const float to[3], double times)
{
    double worst = 0;
    for (int c = 0; c < 3; c++) {
        CHECK_MSG(from[c] > 0 || to[c] == from[c], "a channel of %g became %g", (double)from[c], (double)to[c]);
        if (from[c] > 0)
            worst = worse(worst, fabs((double)to[c] / from[c] - times) / times);
    }
    return worst;
}

static void check_formulas(const struct hf_highlight_params *p)
{
    const struct hf_highlight h = hf_highlight_of(p);
    struct rng rng = rng_seed(7);
    double worst[2] = {0, 0};
    float last = -1;
    int grows = 1;
    for (int i = 0; i <= 40000; i++) {
        const float m = i < 30000 ? (float)i / 20000 : rng_range(&rng, 0, 100);
        float grey[3] = {m, m, m};
        hf_raise_row_c(&h, &grey[0], &grey[1], &grey[2], 1);
        grows = grows && (i >= 30000 || grey[1] > last);
        last = grey[1];
        const float v[3] = {m * rng_float(&rng), m, i % 3 ? m * rng_float(&rng) : -m};
        float up[3] = {v[0], v[1], v[2]}, down[3];
        const double y = luminance(v);
        hf_raise_row_c(&h, &up[0], &up[1], &up[2], 1);
        if (y > 0)
            worst[0] = worse(worst[0], off_by(v, up, raised(p, y) / y) - 3 * 0x1p-24 * condition(p, y));
        const float bright[3] = {v[0] * p->gain, v[1] * p->gain, v[2]};
        memcpy(down, bright, sizeof down);
        const double most = luminance(bright);
        hf_lower_row_c(&h, &down[0], &down[1], &down[2], 1);
        const double back = lowered(p, most), grows_by = most > (double)p->gain ? most / back : 1;
        if (most > 0)
            worst[1] = worse(worst[1], off_by(bright, down, back / most) - 3 * 0x1p-24 * grows_by);
    }
    CHECK_MSG(grows, "gain %g from %g: a brighter highlight is not raised to more", p->gain, p->threshold);
    CHECK_MSG(worst[0] <= ROUNDINGS, "gain %g from %g: raised %g off", p->gain, p->threshold, worst[0]);
    CHECK_MSG(worst[1] <= ROUNDINGS, "gain %g from %g: lowered %g off", p->gain, p->threshold, worst[1]);
    // Where nothing needs to change, nothing changes, and nothing overflows.
    static const float fixed[][3] = {{0, -0.0f, -FLT_MAX}, {FLT_MAX, FLT_MAX, 0x1p-149f}, {FLT_MAX, FLT_MAX, FLT_MAX}};
    for (int i = 0; i < 6; i++) {
        float v[3] = {fixed[i / 2][0], fixed[i / 2][1], fixed[i / 2][2]};
        (i % 2 ? hf_lower_row_c : hf_raise_row_c)(&h, &v[0], &v[1], &v[2], 1);
        CHECK(!memcmp(v, fixed[i / 2], sizeof v));
    }
}

// Paint that is full in one channel or two (except yellow) is not a lamp at a threshold of 0.9; white is.
static void check_colours(void)
{
    const struct hf_highlight h = hf_highlight_of(&cases[0]);
    for (int i = 0; i < 8; i++) {
        const float paint[3] = {(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)};
        float v[3] = {paint[0], paint[1], paint[2]};
        hf_raise_row_c(&h, &v[0], &v[1], &v[2], 1);
        if (i == 3)
            CHECK_MSG(v[0] > 1 && v[0] < 2, "yellow becomes %g", (double)v[0]);
        else if (i == 7)
            CHECK_MSG(fabs((double)v[0] - 8) < 1e-4, "white becomes %g", (double)v[0]);
        else
            CHECK_MSG(!memcmp(v, paint, sizeof v), "colour %d becomes %g %g %g", i, (double)v[0], (double)v[1],
                      (double)v[2]);
    }
}

enum { WIDTH = 150, HEIGHT = 61 };

// A wall with clipped lamps of all sizes, far behind a sharp surface that has a clipped half and sharp edges.
static void make_scene(struct picture *colour, struct picture *z, int alpha)
{
    struct rng rng = rng_seed(11);
    *colour = picture_new(WIDTH, HEIGHT, alpha ? 4 : 3);
    *z = picture_new(WIDTH, HEIGHT, 1);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const int i = y * WIDTH + x, near = x > 100,
                      lamp = near ? x > 125 : x % 37 < 1 + x / 37 && y % 29 < 1 + x / 37;
            for (int c = 0; c < 3; c++)
                colour->plane[c][i] = lamp ? 1 - 0.02f * (float)c : 0.3f * rng_float(&rng);
            if (alpha)
                colour->plane[3][i] = 1;
            z->plane[0][i] = near ? 5 : 20;
        }
}

static struct hf_params lens(enum hf_engine engine, float gain)
{
    struct hf_params p = hf_default_params();
    p.engine = engine;
    p.model = HF_MODEL_LENS;
    p.focus = 5;
    p.lens.f_number = 1.4f;
    p.lens.world_unit_m = 0.05f;  // 11 pixels of radius for the wall
    p.highlight.gain = gain;
    p.highlight.threshold = 0.8f;
    p.run.deterministic = 1;
    return p;
}

static struct picture render(struct hf_context *c, const struct picture *in, const struct picture *z,
                             const struct hf_params *p, enum hf_format format, int in_place)
{
    struct packed from = packed_new(WIDTH, HEIGHT, format, in->channels == 4, 12, 0, 0, 0x5a);
    struct packed to = packed_new(WIDTH, HEIGHT, format, in->channels == 4, 12, 0, 0, 0x5a);
    const struct hf_depth depth = picture_depth(z);
    packed_write(&from, in);
    CHECK(hf_render(c, in_place ? &from.image : &to.image, &from.image, &depth, p) == HF_OK);
    CHECK(packed_junk_intact(&from, 0x5a) && packed_junk_intact(&to, 0x5a));
    struct picture out = packed_read(in_place ? &from : &to);
    packed_free(&from);
    packed_free(&to);
    return out;
}

// The picture as the format holds it.
static struct picture stored(const struct picture *in, enum hf_format format)
{
    struct packed p = packed_new(WIDTH, HEIGHT, format, in->channels == 4, 0, 0, 0, 0);
    packed_write(&p, in);
    struct picture out = packed_read(&p);
    packed_free(&p);
    return out;
}

static double sum_of(const struct picture *p, int x0, int x1)
{
    double sum = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = x0; x < x1; x++)
            sum += p->plane[0][y * WIDTH + x];
    return sum;
}

static void check_frame(struct hf_context *const contexts[2], enum hf_engine engine, enum hf_format format)
{
    struct picture colour, z;
    const int alpha = format_channels(format) == 4 && engine != HF_ENGINE_GATHER;
    make_scene(&colour, &z, alpha);
    struct hf_params off = lens(engine, 1), on = lens(engine, 8);
    struct picture given = stored(&colour, format);
    struct picture plain = render(contexts[0], &colour, &z, &off, format, 0);
    struct picture bright = render(contexts[0], &colour, &z, &on, format, 0);
    struct picture again = render(contexts[1], &colour, &z, &on, format, 1);
    CHECK_MSG(picture_same_bits(&bright, &again), "%s, format %s: in place on three threads it is another picture",
              hf_engine_name(engine), hf_name(HF_NAMES_FORMAT, (int)format));
    on.run.no_skip = 1;
    struct picture all = render(contexts[1], &colour, &z, &on, format, 0);
    CHECK_MSG(picture_same_bits(&bright, &all), "%s, format %s: it is another picture where nothing is skipped",
              hf_engine_name(engine), hf_name(HF_NAMES_FORMAT, (int)format));
    // A threshold without a gain has no effect.
    off.highlight.threshold = 0;
    struct picture same = render(contexts[0], &colour, &z, &off, format, 0);
    CHECK(picture_same_bits(&plain, &same));
    // Far from the edge the sharp side, clipped as it is, is unchanged. The lamps are brighter, and none is cut off.
    int kept = 1, sharp = 0;
    float most = 0;
    for (int c = 0; c < given.channels; c++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const int i = y * WIDTH + x;
                most = c < 3 ? fmaxf(most, bright.plane[c][i]) : most;
                if (x <= 100 || plain.plane[c][i] != given.plane[c][i])
                    continue;
                kept = kept && bright.plane[c][i] == plain.plane[c][i];
                sharp += x > 125;
            }
    CHECK_MSG(sharp > 20 * HEIGHT, "%s: %d samples are not blurred", hf_engine_name(engine), sharp);
    CHECK_MSG(kept, "%s, format %s: a pixel that is not blurred is another", hf_engine_name(engine),
              hf_name(HF_NAMES_FORMAT, (int)format));
    CHECK_MSG(most <= 1.000001f, "%s, format %s: up to %g", hf_engine_name(engine),
              hf_name(HF_NAMES_FORMAT, (int)format), (double)most);
    const double more = sum_of(&bright, 0, 100) / sum_of(&plain, 0, 100);
    CHECK_MSG(more > 1, "%s, format %s: lamps bring %g times the light", hf_engine_name(engine),
              hf_name(HF_NAMES_FORMAT, (int)format), more);
    struct picture *const made[] = {&colour, &z, &given, &plain, &bright, &again, &all, &same};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        picture_free(made[i]);
}

// A disc of radius 11 is a mean of fewer than 512 samples; each product and each sum rounds by half a last place.
static const double SUMS = 2 * 512 * 0x1p-24;

// An evenly bright picture stays so under any blur.
static void check_even(struct hf_context *c, enum hf_engine engine)
{
    static const float values[] = {0.5f, 0.85f, 0.93f, 1, 3};
    for (int v = 0; v < 5; v++) {
        struct picture colour, z;
        make_scene(&colour, &z, 0);
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            for (int k = 0; k < 3; k++)
                colour.plane[k][i] = values[v];
        const struct hf_params p = lens(engine, 8);
        struct picture out = render(c, &colour, &z, &p, HF_FORMAT_PLANAR32F, 0);
        double off = 0;
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            off = worse(off, fabs((double)out.plane[1][i] - values[v]) / values[v]);
        // Lowering does not enlarge a difference.
        CHECK_MSG(off <= SUMS + 2 * ROUNDINGS, "%s: an even %g becomes %g of it another", hf_engine_name(engine),
                  values[v], off);
        picture_free(&colour);
        picture_free(&z);
        picture_free(&out);
    }
}

// A clipped lamp in the dark leaves a disc with gain times the light. All of it is below the threshold, where nothing
// is lowered.
static void check_lamp(struct hf_context *c, enum hf_engine engine)
{
    struct picture colour, z;
    make_scene(&colour, &z, 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 3; k++) {
            colour.plane[k][i] = i / WIDTH / 2 == HEIGHT / 4 && i % WIDTH / 2 == 25;
            z.plane[0][i] = 20;
        }
    struct hf_params off = lens(engine, 1), on = lens(engine, 8);
    off.gaussian.sigma = on.gaussian.sigma = 5;
    struct picture plain = render(c, &colour, &z, &off, HF_FORMAT_PLANAR32F, 0);
    struct picture bright = render(c, &colour, &z, &on, HF_FORMAT_PLANAR32F, 0);
    const double gain = sum_of(&bright, 0, WIDTH) / sum_of(&plain, 0, WIDTH);
    CHECK_MSG(fabs(gain - 8) <= 8 * SUMS, "%s: the lamp has %g times the light", hf_engine_name(engine), gain);
    struct picture *const made[] = {&colour, &z, &plain, &bright};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        picture_free(made[i]);
}

// Saturated paint, blurred, has the same bits with a gain and without.
static void check_paint(struct hf_context *c, enum hf_engine engine)
{
    struct picture colour, z;
    struct rng rng = rng_seed(5);
    make_scene(&colour, &z, 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int full = rng_below(&rng, 3);
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = k == full ? 1 : 0.5f * rng_float(&rng);
    }
    struct hf_params off = lens(engine, 1), on = lens(engine, 8);
    off.highlight.threshold = on.highlight.threshold = 0.9f;
    struct picture plain = render(c, &colour, &z, &off, HF_FORMAT_PLANAR32F, 0);
    struct picture bright = render(c, &colour, &z, &on, HF_FORMAT_PLANAR32F, 0);
    CHECK_MSG(picture_same_bits(&plain, &bright), "%s: paint of a full channel counts as a lamp",
              hf_engine_name(engine));
    struct picture *const made[] = {&colour, &z, &plain, &bright};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        picture_free(made[i]);
}

// A frame with a gain is the same as one without, of the raised picture, lowered: each pixel as a whole, or it has the picture's
// own bits as a whole. Lamps have a colour, and stand among dark ones, so that one channel alone may stay as it was.
static void check_whole_pixels(struct hf_context *c, enum hf_engine engine)
{
    struct picture colour, z;
    struct rng rng = rng_seed(3);
    make_scene(&colour, &z, 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        const int lamp = rng_below(&rng, 5) == 0;
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = lamp ? 1 - 0.3f * rng_float(&rng) : 0.3f * rng_float(&rng);
        // From the focus on up to a pixel and a half; or up to 11, and as much behind.
        z.plane[0][i] = 5 + (i < WIDTH * HEIGHT / 2 ? 0.4f : i % 8 ? 15 : 0) * (float)(i % WIDTH) / WIDTH;
    }
    struct hf_params on = lens(engine, 8), off = lens(engine, 1);
    const struct hf_highlight h = hf_highlight_of(&on.highlight);
    struct picture bright = render(c, &colour, &z, &on, HF_FORMAT_PLANAR32F, 0), raised = picture_copy(&colour);
    hf_raise_row_c(&h, raised.plane[0], raised.plane[1], raised.plane[2], WIDTH * HEIGHT);
    struct picture lowered = render(c, &raised, &z, &off, HF_FORMAT_PLANAR32F, 0);
    hf_lower_row_c(&h, lowered.plane[0], lowered.plane[1], lowered.plane[2], WIDTH * HEIGHT);
    int mixed = 0, blurred = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int as_lowered = 1, as_given = 1;
        for (int k = 0; k < 3; k++) {
            as_lowered = as_lowered && bright.plane[k][i] == lowered.plane[k][i];
            as_given = as_given && bright.plane[k][i] == colour.plane[k][i];
        }
        blurred += !as_given;
        mixed += !as_lowered && !as_given;
    }
    CHECK_MSG(mixed == 0 && blurred > WIDTH, "%s: of %d blurred pixels %d are neither lowered nor as they were",
              hf_engine_name(engine), blurred, mixed);
    struct picture *const made[] = {&colour, &z, &bright, &raised, &lowered};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        picture_free(made[i]);
}

int main(void)
{
    struct hf_context *contexts[2];
    const struct hf_config one = {.size = sizeof one, .threads = 1},
                           three = {.size = sizeof three, .threads = 3, .isa = HF_ISA_SCALAR};
    if (hf_open(&contexts[0], &one) || hf_open(&contexts[1], &three))
        return 1;
    for (int i = 0; i < CASES; i++)
        check_formulas(&cases[i]);
    check_colours();
    for (int e = 0; e < tool_engines(); e++) {
        check_even(contexts[0], (enum hf_engine)e);
        check_lamp(contexts[0], (enum hf_engine)e);
        check_paint(contexts[0], (enum hf_engine)e);
        check_whole_pixels(contexts[0], (enum hf_engine)e);
        for (int f = 0; f <= HF_FORMAT_PLANAR32F; f++)
            check_frame(contexts, (enum hf_engine)e, (enum hf_format)f);
    }
    hf_close(&contexts[0]);
    hf_close(&contexts[1]);
    return check_report();
}
