// SPDX-License-Identifier: BSD-3-Clause
// The layers engine: bits that depend only on the input, for any aperture; constant pictures, alpha, samples that are
// not finite, a focus pull.
//
//     layers [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"

static unsigned seed = 1;

static const enum hf_isa isas[] = {HF_ISA_SCALAR, HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON};
enum { ISAS = sizeof isas / sizeof *isas };

static void random_aperture(struct rng *rng, struct hf_aperture_params *a)
{
    static float bright[3][9 * 7];
    static const struct hf_image picture = {
        sizeof picture, 9, 7, HF_FORMAT_PLANAR32F, HF_TRANSFER_LINEAR, {bright[0], bright[1], bright[2]}, {36, 36, 36}};
    a->chromatic = rng_below(rng, 3) ? 0 : rng_range(rng, -0.5f, 0.5f);
    if (rng_below(rng, 4) == 0) {
        for (int i = 0; i < 9 * 7; i++)
            for (int k = 0; k < 3; k++)
                bright[k][i] = k == 0 ? rng_float(rng) : bright[0][i];
        a->picture = &picture;
        return;
    }
    a->blades = rng_below(rng, 3) ? 3 + rng_below(rng, 14) : 0;
    a->rotation = rng_range(rng, -180, 180);
    a->roundness = rng_below(rng, 2) ? 0 : rng_float(rng);
    a->ring = rng_below(rng, 3) ? 0 : rng_range(rng, 0, 0.95f);
    a->cat_eye = rng_below(rng, 3) ? 0 : rng_float(rng);
}

static struct hf_params random_params(struct rng *rng)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_LAYERS;
    p.run.deterministic = 1;
    p.max_radius = rng_range(rng, 1, 45);
    p.layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    p.layers.no_unmix = rng_below(rng, 5) == 0;
    p.layers.no_hidden = rng_below(rng, 5) == 0;
    p.layers.no_highlights = rng_below(rng, 5) == 0;
    p.layers.no_patterns = rng_below(rng, 5) == 0;
    p.aperture.squeeze = rng_below(rng, 4) ? 1 : rng_range(rng, 0.5f, 2);
    if (rng_below(rng, 2))
        random_aperture(rng, &p.aperture);
    return p;
}

// Every instruction set, any number of threads, tiles of any size: the bits of the plain C on one thread.
static void bits(void)
{
    struct hf_context *plain = context_new(HF_ISA_SCALAR, 1, 0, 0);
    struct rng rng = rng_seed(seed);
    for (int n = 0; n < 12; n++) {
        const int width = 1 + rng_below(&rng, n % 3 ? 90 : 300), height = 1 + rng_below(&rng, n % 3 ? 70 : 150);
        const enum scene_kind kind = (enum scene_kind)rng_below(&rng, SCENE_KINDS);
        struct scene s = scene_new(&rng, kind, width, height, 3 + rng_below(&rng, 2));
        const struct hf_params p = random_params(&rng);
        struct picture want = render_scene(plain, &s, &p);
        for (int i = 0; i < ISAS; i++) {
            if (!hf_isa_available(isas[i]))
                continue;
            const int threads = 1 + rng_below(&rng, 4), tile = rng_below(&rng, 5);
            struct hf_context *c = context_new(isas[i], threads, 16 * tile, tile ? 16 + tile : 0);
            struct picture got = render_scene(c, &s, &p);
            CHECK_MSG(picture_same_bits(&want, &got), "%s, scene %d (%s, %d x %d): not the bits of the C",
                      hf_isa_name(isas[i]), n, scene_name(kind), width, height);
            picture_free(&got);
            hf_close(&c);
        }
        picture_free(&want);
        scene_free(&s);
    }
    hf_close(&plain);
}

// The sums of weights and of colours are rounded separately. Each is a blur of at most a few hundred terms whose errors
// average out, twice, and then a quotient. 2e-6 is 34 half units of the last place.
static void constants(void)
{
    struct rng rng = rng_seed(seed + 1);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int n = 0; n < 6; n++) {
        struct scene s = scene_new(&rng, n % 2 ? SCENE_NOISE : SCENE_BLOCKS, 200, 120, 4);
        struct hf_params p = random_params(&rng);
        p.run.deterministic = n % 2;
        const float value[4] = {0.7f, 0.013f, 91.3f, 1};
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 200 * 120; i++)
                s.colour.plane[k][i] = value[k];
        struct picture out = render_scene(c, &s, &p);
        for (int k = 0; k < 4; k++) {
            double worst = 0;
            for (int i = 0; i < 200 * 120; i++)
                worst = fmax(worst, fabs((double)out.plane[k][i] / value[k] - 1));
            CHECK_MSG(worst <= (k < 3 ? 2e-6 : 0), "constant %d, channel %d: off by %g", n, k, worst);
        }
        picture_free(&out);
        scene_free(&s);
    }
    hf_close(&c);
}

// Colour and alpha of a picture with holes stay within the input's range, and a sample that is not finite does not
// spread.
static void ranges(void)
{
    struct rng rng = rng_seed(seed + 2);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int n = 0; n < 6; n++) {
        struct scene s = scene_new(&rng, SCENE_BLOCKS, 150, 100, 4);
        struct hf_params p = random_params(&rng);
        p.layers.no_highlights = 1;  // highlights are drawn at a finer resolution than their coverage
        for (int i = 0; i < 150 * 100; i++) {
            const float a = i / 150 / 20 % 2 && i % 150 / 17 % 2 ? 0 : 1;
            for (int k = 0; k < 4; k++)
                s.colour.plane[k][i] = k < 3 ? 0.5f * a : a;
        }
        for (int k = 0; n % 2 && k < 40; k++)
            s.colour.plane[rng_below(&rng, 3)][rng_below(&rng, 150 * 100)] = k % 2 ? NAN : INFINITY;
        struct picture out = render_scene(c, &s, &p);
        int inside = 1, matched = 1;
        for (int i = 0; i < 150 * 100; i++) {
            inside &= out.plane[3][i] >= 0 && out.plane[3][i] <= 1.00001f;
            for (int k = 0; k < 3; k++) {
                inside &= out.plane[k][i] >= 0 && out.plane[k][i] <= 0.50001f;
                matched &= n % 2 || fabsf(out.plane[k][i] - 0.5f * out.plane[3][i]) < 1e-5f;
            }
        }
        CHECK_MSG(inside, "case %d: samples beyond those of the input", n);
        CHECK_MSG(matched, "case %d: colours that do not go with their alpha", n);
        picture_free(&out);
        scene_free(&s);
    }
    hf_close(&c);
}

// A focus pull: no pixel changes by more than 4 times the picture's range for each pixel of radius.
static void pull(void)
{
    struct rng rng = rng_seed(seed + 3);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    static const float steps[] = {1e-4f, 1e-3f, 1e-2f, 0.1f};
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 128, 96, 3);
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_LAYERS;
    const struct hf_depth depth = picture_radii(&s.depth);
    struct picture out[2] = {picture_new(128, 96, 3), picture_new(128, 96, 3)};
    for (int i = 0; i < 128 * 96; i++) {
        // A difference of radii of 1 makes an edge, and a radius midway between two others is rounded either way. The
        // radii avoid both.
        const float step = roundf(fminf(fmaxf(s.depth.plane[0][i] - 20, -15), 15));
        s.depth.plane[0][i] = 1.37f * step + 0.013f * step * step;
        for (int k = 0; k < 3; k++)
            s.colour.plane[k][i] = fminf(fmaxf(s.colour.plane[k][i], 0), 1);
    }
    for (int n = 0; n < 4; n++)
        for (int at = 0; at < 6; at++) {
            for (int k = 0; k < 2; k++) {
                CHECK_INT(try_render(c, &out[k], &s.colour, &depth, &p), HF_OK);
                for (int i = 0; i < 128 * 96; i++)
                    s.depth.plane[0][i] += k ? 0.37f : steps[n];
            }
            double worst = 0;
            for (int k = 0; k < 3; k++)
                for (int i = 0; i < 128 * 96; i++)
                    worst = fmax(worst, fabs((double)out[0].plane[k][i] - out[1].plane[k][i]));
            // Plus the roundings of both pictures.
            CHECK_MSG(worst <= 4 * steps[n] * 1.01 + 4e-6, "a step of %g changes a pixel by %g", steps[n], worst);
        }
    picture_free(&out[0]);
    picture_free(&out[1]);
    scene_free(&s);
    hf_close(&c);
}

// In small cells runs of tiles begin elsewhere. These scenes once lost parts where a run of second hidden samples began
// in the middle of a run of hidden samples.
static void cells(void)
{
    static const unsigned failed[] = {140, 509, 1480, 1700, 2562};
    const unsigned more = check_long() ? 3000 : 40;
    for (unsigned i = 0; i < sizeof failed / sizeof *failed + more; i++) {
        struct rng rng = rng_seed(i < more ? seed + i : failed[i - more]);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_LAYERS;
        p.max_radius = rng_range(&rng, 4, 12);
        p.layers.quality = rng_below(&rng, 2) ? HF_LAYERS_HIGH : HF_LAYERS_STANDARD;
        p.layers.lens_points = rng_below(&rng, 2) ? 24 : 1;
        const enum scene_kind kind = (enum scene_kind)rng_below(&rng, SCENE_FAR);
        const int width = 40 + rng_below(&rng, 110), height = 3 + rng_below(&rng, 60);
        struct scene s = scene_new(&rng, kind, width, height, 3);
        struct hf_context *whole = context_new(HF_ISA_AUTO, 1, 0, 0);
        struct hf_context *small = context_new(HF_ISA_AUTO, 1, 16 * (1 + rng_below(&rng, 3)), 16);
        struct picture want = render_scene(whole, &s, &p), got = render_scene(small, &s, &p);
        CHECK_MSG(!samples_other(&want, &got), "%s %d x %d, radius %g: %d samples differ in small cells",
                  scene_name(kind), width, height, (double)p.max_radius, samples_other(&want, &got));
        picture_free(&want);
        picture_free(&got);
        scene_free(&s);
        hf_close(&whole);
        hf_close(&small);
    }
}

// What a lens sees at x, as a mean over rays: a ramp of radius 4 behind a black rod of radius -8, from x = ROD to ROD +
// WIDE.
enum { ROD = 94, WIDE = 12, RAMP = 200 };
static double ramp_at(double x)
{
    return 0.2 + 0.6 * fmin(fmax(x / RAMP, 0), 1);
}

static double seen_at(double x)
{
    double sum = 0, all = 0;
    for (int i = 0; i < 1000; i++) {
        const double u = (i + 0.5) / 500 - 1, w = sqrt(1 - u * u), near = x - 8 * u;
        sum += near >= ROD && near < ROD + WIDE ? 0 : w * ramp_at(x + 4 * u);
        all += w;
    }
    return sum / all;
}

// Rays cross at the plane in focus: beside a rod a lens sees what the rod hides, not what lies beside it. The root mean
// squares were 0.00358, 0.00342 and 0.00347 (standard, high, best) with no coverage withheld, and 0.00309, 0.00291 and
// 0.00257 with it. The bounds, 0.00315 and 0.0027, lie between these measured values; nothing else justifies them.
static void crossed(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    struct picture colour = picture_new(RAMP, 64, 3), radii = picture_new(RAMP, 64, 1);
    const struct hf_depth depth = picture_radii(&radii);
    for (int i = 0; i < RAMP * 64; i++) {
        const int x = i % RAMP, rod = x >= ROD && x < ROD + WIDE;
        radii.plane[0][i] = rod ? -8 : 4;
        for (int k = 0; k < 3; k++)
            colour.plane[k][i] = rod ? 0 : (float)ramp_at(x + 0.5);
    }
    for (int q = HF_LAYERS_STANDARD; q <= HF_LAYERS_BEST; q++) {
        struct hf_params p = hf_default_params();
        p.engine = HF_ENGINE_LAYERS;
        p.layers.quality = (enum hf_layers_quality)q;
        struct picture out = render(c, &colour, &depth, &p);
        double error = 0;
        for (int x = ROD - 8; x < ROD + WIDE + 8; x++)
            error += pow(out.plane[0][32 * RAMP + x] - seen_at(x + 0.5), 2);
        error = sqrt(error / (WIDE + 16));
        if (q != HF_LAYERS_DRAFT)  // it has no hidden samples
            CHECK_MSG(error < 0.0036 * (q == HF_LAYERS_BEST ? 3.0 / 4 : 7.0 / 8), "quality %d is off by %g", q, error);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radii);
    hf_close(&c);
}

// A lens that is half open beside a card, of radius r and with its edge at x 0, sees this part of what lies behind it at
// pixel x: the part of a disc beyond a chord.
static double beside_card(double x, double r)
{
    const double t = fmin(fmax(x / r, -1), 1);
    return 0.5 + (t * sqrt(1 - t * t) + asin(t)) / 3.14159265358979323846;
}

// A black card before a white wall. Behind the card's edge the lens sees the wall as many pixels as their radii differ by,
// so nothing but the card's own coverage darkens it, at any radius. A disc of 2 pixels is a sum of whole pixels' rows and
// its edge's response is off by 0.034; at 2.5, two such discs share it, and it is off by 0.035; from 4 on by 0.026 at
// most. A search that ends too early was off by 0.24 at a radius of 6.
static void card(void)
{
    enum { W = 256, H = 16 };
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    struct picture colour = picture_new(W, H, 3), radii = picture_new(W, H, 1);
    const struct hf_depth depth = picture_radii(&radii);
    for (int n = 0; n < 3 * 44; n++) {
        const double r = 2 + 0.5 * (n % 44), wall = n / 44 * 4;
        for (int i = 0; i < W * H; i++) {
            radii.plane[0][i] = i % W < W / 2 ? (float)-r : (float)wall;
            for (int k = 0; k < 3; k++)
                colour.plane[k][i] = i % W < W / 2 ? 0 : 1;
        }
        struct hf_params p = hf_default_params();
        p.engine = HF_ENGINE_LAYERS;
        struct picture out = render(c, &colour, &depth, &p);
        double off = 0;
        for (int x = 64; x < W - 64; x++)
            off = fmax(off, fabs(out.plane[0][H / 2 * W + x] - beside_card(x + 0.5 - W / 2, r)));
        CHECK_MSG(off < (r < 4 ? 0.036 : 0.027), "a card of radius %g before a wall of %g is off by %g", -r, wall, off);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&radii);
    hf_close(&c);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)atoi(argv[1]) : 1;
    bits();
    constants();
    ranges();
    pull();
    cells();
    crossed();
    card();
    return check_report();
}
