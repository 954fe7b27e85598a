// SPDX-License-Identifier: BSD-3-Clause
// Highlights given back: the two formulas against double precision, there and back, and what a frame makes of them with
// every engine, in every format, in place, on any number of threads.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pixel/highlight.h"
#include "pixel/kernels.h"
#include "support/check.h"
#include "support/image.h"

static const struct hf_highlight_params cases[] = {{8, 0.9f}, {64, 0.99f}, {64, 0}, {1.01f, 0.5f}, {16, 0.8f}};
enum { CASES = sizeof cases / sizeof *cases };

// m raised, in double precision, of the floats that the parameters are.
static double raised(const struct hf_highlight_params *p, double m)
{
    const double t = fmin(fmax((m - (double)p->threshold) / (1 - (double)p->threshold), 0), 1);
    return m + ((double)p->gain - 1) * t * t;
}

// What was raised to this, found by halving.
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

// Roundings, each of at most half a last place, 2^-24: of m - threshold 1; of the scale 2, 1 of the product; doubled by
// the square, 1 of it; gain - 1 and the product with it 2; the quotient, the product and the sum 3: 14. Back: of d 1 and of
// the root's argument 4, halved; of span 1, sum and quotient 2, product and sum with the threshold 2; the part and the
// product 2: fewer than 14. One more for what a float between two halvings is.
static const double ROUNDINGS = 15 * 0x1p-24;

static void check_formulas(const struct hf_highlight_params *p)
{
    const struct hf_highlight h = hf_highlight_of(p);
    struct rng rng = rng_seed(7);
    double worst[2] = {0, 0}, last = -1;
    int grows = 1;
    for (int i = 0; i <= 40000; i++) {
        const float m = i < 30000 ? (float)i / 20000 : rng_range(&rng, 0, 100), part = rng_float(&rng);
        float r = m * part, g = m, b = -m;
        const float red = r;
        hf_raise_row_c(&h, &r, &g, &b, 1);
        const double want = raised(p, m);
        worst[0] = worse(worst[0], fabs((double)g - want) / fmax(want, 1e-30));
        worst[0] =
            worse(worst[0], fabs((double)r - (m > 0 ? red * want / m : 0)) / fmax(red * want / fmax(m, 1e-30), 1e-30));
        CHECK_MSG(b == -m, "a negative channel of %g became %g", (double)-m, (double)b);
        grows = grows && (i >= 30000 || (double)g > last);
        last = g;
        float v = m * p->gain, u = v * part, w = 0;
        const double most = v, share = u;
        hf_lower_row_c(&h, &w, &v, &u, 1);
        const double back = most > (double)p->threshold ? lowered(p, most) : most;
        worst[1] = worse(worst[1], fabs((double)v - back) / fmax(back, 1e-30));
        worst[1] = worse(worst[1], fabs((double)u - (most > 0 ? share * back / most : 0)) /
                                       fmax(share * back / fmax(most, 1e-30), 1e-30));
    }
    CHECK_MSG(grows, "gain %g from %g: a brighter highlight is not raised to more", p->gain, p->threshold);
    CHECK_MSG(worst[0] <= ROUNDINGS, "gain %g from %g: raised %g off", p->gain, p->threshold, worst[0]);
    CHECK_MSG(worst[1] <= ROUNDINGS, "gain %g from %g: lowered %g off", p->gain, p->threshold, worst[1]);
    // Where nothing is to be done nothing is done, and nothing overflows.
    float still[3] = {p->threshold, -0.0f, -FLT_MAX}, huge[3] = {FLT_MAX, FLT_MAX, 0x1p-149f};
    for (int i = 0; i < 2; i++) {
        (i ? hf_lower_row_c : hf_raise_row_c)(&h, &still[0], &still[1], &still[2], 1);
        CHECK(still[0] == p->threshold && signbit(still[1]) && still[2] == -FLT_MAX);
        (i ? hf_lower_row_c : hf_raise_row_c)(&h, &huge[0], &huge[1], &huge[2], 1);
        CHECK(huge[0] == FLT_MAX && huge[1] == FLT_MAX && huge[2] == 0x1p-149f);
    }
}

enum { WIDTH = 150, HEIGHT = 61 };

// A wall with clipped lamps of all sizes far behind what is in focus, which has a clipped half and sharp edges.
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
    struct hf_params p = hf_default_params;
    p.engine = engine;
    p.model = HF_MODEL_LENS;
    p.focus = 5;
    p.lens.f_number = 1.4f;
    p.lens.world_unit_m = 0.05f;  // 11 pixels behind
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

// As the format holds it.
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
    // A threshold without a gain does nothing.
    off.highlight.threshold = 0;
    struct picture same = render(contexts[0], &colour, &z, &off, format, 0);
    CHECK(picture_same_bits(&plain, &same));
    // Far from the edge the sharp side, clipped as it is, is what it was; the lamps are brighter, and none is cut.
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

// A disc of radius 11 is a mean of fewer than 512 samples; each is multiplied and added, which rounds by half a last place.
static const double SUMS = 2 * 512 * 0x1p-24;

// What is evenly bright stays so, whatever the blur.
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
        // Lowering makes a distance no larger.
        CHECK_MSG(off <= SUMS + 2 * ROUNDINGS, "%s: an even %g becomes %g of it another", hf_engine_name(engine),
                  values[v], off);
        picture_free(&colour);
        picture_free(&z);
        picture_free(&out);
    }
}

// A clipped lamp in the dark leaves a disc of gain times the light, all of it below the threshold, where nothing is lowered.
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

int main(void)
{
    struct hf_context *contexts[2];
    const struct hf_config one = {.threads = 1}, three = {.threads = 3, .isa = HF_ISA_SCALAR};
    if (hf_open(&contexts[0], &one) || hf_open(&contexts[1], &three))
        return 1;
    for (int i = 0; i < CASES; i++)
        check_formulas(&cases[i]);
    for (int e = 0; e < HF_ENGINE_COUNT; e++) {
        check_even(contexts[0], (enum hf_engine)e);
        check_lamp(contexts[0], (enum hf_engine)e);
        for (int f = 0; f <= HF_FORMAT_PLANAR32F; f++)
            check_frame(contexts, (enum hf_engine)e, (enum hf_format)f);
    }
    hf_close(&contexts[0]);
    hf_close(&contexts[1]);
    return check_report();
}
