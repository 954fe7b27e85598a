// SPDX-License-Identifier: BSD-3-Clause
// Hard cases of the gaussian engine: the same bits from any tiles and instruction set, flips, crops, exposure, bad
// samples, constants, copies, a focus pull.
//
//     gaussian_hard [seed]
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "support/gaussian.h"
#include "support/reference.h"
#include "tools/common/report.h"

static const double U = FLT_EPSILON / 2;
static unsigned seed = 1;

// Tiles, threads, skipping, in place, other instruction sets: the same bits, deterministic or not.
static void same_bits(struct hf_context *plain, enum hf_isa id, const char *isa)
{
    static const int setups[][3] = {{1, 0, 0}, {2, 16, 16}, {3, 48, 17}, {2, 32, 33}};
    uint64_t run = 0, all = 0;
    for (int k = 0; k < 4; k++) {
        struct hf_context *c = context_new(id, setups[k][0], setups[k][1], setups[k][2]);
        for (unsigned i = 0; i < 40; i++) {
            struct rng rng = rng_seed(seed + i);
            const enum scene_kind kind = (enum scene_kind)rng_below(&rng, SCENE_KINDS);
            const int w = 1 + rng_below(&rng, i % 4 ? 90 : 330), h = 1 + rng_below(&rng, i % 4 ? 60 : 200);
            struct scene s = scene_new(&rng, kind, w, h, 3 + rng_below(&rng, 2));
            struct hf_params p = random_params(&rng);
            p.run.deterministic = rng_below(&rng, 2);
            for (int j = 0; j < w * h / 20; j++)
                s.colour.plane[rng_below(&rng, 3)][rng_below(&rng, w * h)] = rng_below(&rng, 2) ? -0.0f : -1e-3f;
            struct picture a = render_scene(c, &s, &p);
            struct tool_report stats;
            tool_report_get(c, &stats);
            run += stats.pass[tool_passes(HF_ENGINE_GAUSSIAN) - 1].ran;
            all += stats.pass[tool_passes(HF_ENGINE_GAUSSIAN) - 1].all;
            p.run.no_skip = 1;
            struct picture b = render_scene(plain, &s, &p);
            CHECK_MSG(picture_same_bits(&a, &b), "%s: seed %u, %s %d x %d, setup %d: skipping gives other bits", isa,
                      seed + i, scene_name(kind), w, h, k);
            p.run.no_skip = 0;
            CHECK_INT(try_scene(c, &s.colour, &s, &p), HF_OK);
            CHECK_MSG(picture_same_bits(&a, &s.colour), "%s: seed %u, %d x %d, setup %d: in place gives other bits",
                      isa, seed + i, w, h, k);
            picture_free(&a);
            picture_free(&b);
            scene_free(&s);
        }
        hf_close(&c);
    }
    printf("%s: skipping: %.0f %% of the tiles merged\n", isa, 100.0 * (double)run / (double)all);
    CHECK(run < all);
}

static void flips(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 30; i++) {
        struct rng rng = rng_seed(seed + i);
        struct hf_params p = random_params(&rng);
        const int step = 1 << p.gaussian.resolution;
        p.focus = 20;  // the pixel in the middle is another one
        struct scene s =
            scene_new(&rng, SCENE_HIGHLIGHTS, step * (1 + rng_below(&rng, 90 / step)), 1 + rng_below(&rng, 50), 3);
        struct scene mirror = {picture_flipped(&s.colour), picture_flipped(&s.depth)};
        struct picture a = render_scene(c, &s, &p), b = render_scene(c, &mirror, &p), back = picture_flipped(&b);
        CHECK_MSG(picture_same_bits(&a, &back), "%s: seed %u, %d x %d, resolution %d: flipping gives other bits", isa,
                  seed + i, s.colour.width, s.colour.height, p.gaussian.resolution);
        picture_free(&a);
        picture_free(&b);
        picture_free(&back);
        scene_free(&mirror);
        scene_free(&s);
    }
}

// Crops by whole pixels of the working buffer: farther from the crop's edge than the blur reaches, the result is the
// same.
static void crops(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 30; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_HIGHLIGHTS, 150 + rng_below(&rng, 60), 140 + rng_below(&rng, 20), 3);
        struct hf_params p = random_params(&rng);
        p.focus = 20;
        p.view.display_width = 200;
        p.gaussian.iterations = hf_default_params().gaussian.iterations;
        p.gaussian.sigma = i % 3 ? HF_DERIVE : fminf(p.gaussian.sigma, 2);
        p.gaussian.resolution = p.gaussian.sigma > 0 ? HF_RESOLUTION_FULL : p.gaussian.resolution;
        const int step = 2 << p.gaussian.resolution, x0 = step * rng_below(&rng, 4), y0 = step * rng_below(&rng, 4);
        const int w = 108, h = 104,
                  m = p.gaussian.sigma > 0 ? 20 : (2 * p.gaussian.iterations + 2) << p.gaussian.resolution;
        struct scene part = {picture_cut(&s.colour, x0, y0, w, h), picture_cut(&s.depth, x0, y0, w, h)};
        struct picture whole = render_scene(c, &s, &p), a = render_scene(c, &part, &p);
        struct picture b = picture_cut(&whole, x0 + m, y0 + m, w - 2 * m, h - 2 * m),
                       inner = picture_cut(&a, m, m, w - 2 * m, h - 2 * m);
        CHECK_MSG(picture_same_bits(&b, &inner), "%s: seed %u, crop at (%d, %d), resolution %d: other bits", isa,
                  seed + i, x0, y0, p.gaussian.resolution);
        picture_free(&whole);
        picture_free(&a);
        picture_free(&b);
        picture_free(&inner);
        scene_free(&part);
        scene_free(&s);
    }
}

static void exposures(struct hf_context *c, const char *isa)
{
    static const int exponents[] = {-20, -3, 1, 12, 30};
    for (unsigned i = 0; i < 20; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_HIGHLIGHTS, 30 + rng_below(&rng, 60), 20 + rng_below(&rng, 40), 4);
        struct hf_params p = random_params(&rng);
        struct picture a = render_scene(c, &s, &p);
        const float scale = ldexpf(1, exponents[i % 5]);
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < a.width * a.height; j++) {
                s.colour.plane[k][j] *= scale;
                a.plane[k][j] *= scale;
            }
        struct picture b = render_scene(c, &s, &p);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: seed %u: exposure x 2^%d gives other bits", isa, seed + i,
                  exponents[i % 5]);
        picture_free(&a);
        picture_free(&b);
        scene_free(&s);
    }
}

// ---- values ----

static void bad_samples(struct hf_context *c, const char *isa)
{
    static const float strange[] = {NAN,   INFINITY, -INFINITY, 1e-40f, -1e-42f, -3,
                                    65504, 1e30f,    -0.0f,     -1e30f, FLT_MAX, -FLT_MAX};
    for (unsigned i = 0; i < 8; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_BLOCKS, 61, 45, 4);
        uint64_t bad = 0, holes = 0;
        for (int k = 0; k < 150; k++) {
            s.colour.plane[rng_below(&rng, 4)][rng_below(&rng, 61 * 45)] = strange[rng_below(&rng, 12)];
            s.depth.plane[0][rng_below(&rng, 61 * 45)] = NAN;
        }
        struct scene mended = {picture_copy(&s.colour), picture_copy(&s.depth)};
        const struct hf_depth depth = picture_depth(&s.depth);
        double *v = malloc(sizeof *v * 61 * 45);
        ref_depths(v, &depth, 1, 61, 45);
        for (int k = 0; k < 61 * 45; k++) {
            holes += isnan(s.depth.plane[0][k]) != 0;
            mended.depth.plane[0][k] = (float)v[k];
        }
        for (int ch = 0; ch < 4; ch++) {
            ref_repair(v, s.colour.plane[ch], 61, 45);
            for (int k = 0; k < 61 * 45; k++) {
                bad += !isfinite(s.colour.plane[ch][k]);
                mended.colour.plane[ch][k] = isfinite(s.colour.plane[ch][k]) ? s.colour.plane[ch][k] : (float)v[k];
            }
        }
        free(v);
        struct hf_params p = random_params(&rng);
        p.run.no_skip = i % 2;
        struct picture a = render_scene(c, &s, &p);
        struct tool_report stats;
        tool_report_get(c, &stats);
        CHECK_INT(stats.all.colour_repaired, bad);
        CHECK_INT(stats.all.depth_repaired, holes);
        CHECK_INT(stats.all.near_pixels + stats.all.sharp_pixels + stats.all.far_pixels, 61 * 45);
        struct picture b = render_scene(c, &mended, &p);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: seed %u: mending first gives other bits", isa, seed + i);
        for (int ch = 0; ch < 4; ch++)
            for (int k = 0; k < 61 * 45; k++)
                CHECK(isfinite(a.plane[ch][k]));
        picture_free(&a);
        picture_free(&b);
        scene_free(&mended);
        scene_free(&s);
    }
}

// The largest floats of both signs side by side; their difference is not a finite float. Values between them are
// finite, in planes and in pixels, and equal to the plain C's.
static void largest_floats(struct hf_context *plain, struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 24; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_NOISE, 1 + rng_below(&rng, 200), 1 + rng_below(&rng, 30), 3);
        for (int ch = 0; ch < 3; ch++)
            for (int k = 0; k < s.colour.width * s.colour.height; k++)
                s.colour.plane[ch][k] = k / 3 % 5 < 3 ? FLT_MAX : -FLT_MAX;
        struct hf_params p = random_params(&rng);
        p.gaussian.resolution = (enum hf_resolution)(i % 3);
        const struct hf_depth depth = picture_depth(&s.depth);
        const enum hf_format format = i % 2 ? HF_FORMAT_RGB32F : HF_FORMAT_PLANAR32F;
        struct packed in = packed_new(s.colour.width, s.colour.height, format, 0, 0, 0, 0, 0);
        packed_write(&in, &s.colour);
        struct picture out[2];
        for (int k = 0; k < 2; k++) {
            struct packed to = packed_new(s.colour.width, s.colour.height, format, 0, 0, 0, 0, 0);
            CHECK_INT(hf_render(k ? c : plain, &to.image, &in.image, &depth, &p), HF_OK);
            out[k] = packed_read(&to);
            packed_free(&to);
        }
        CHECK_MSG(all_finite(&out[1]), "%s: seed %u: between the largest floats is what is not finite", isa, seed + i);
        CHECK_MSG(picture_same_bits(&out[0], &out[1]), "%s: seed %u: largest floats: other bits than the C's", isa,
                  seed + i);
        picture_free(&out[0]);
        picture_free(&out[1]);
        packed_free(&in);
        scene_free(&s);
    }
}

// A constant picture stays the same, bit for bit; a denormal one within a few of its steps. Faithful weights add up to
// 1 only within rounding: 20 roundings an iteration, and as many for resampling.
static void constants(struct hf_context *c, const char *isa)
{
    static const float values[] = {0.1f, 1, -3.3f, 65504, 1e30f, FLT_MAX, 0};
    for (unsigned i = 0; i < 42; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_NOISE, 1 + rng_below(&rng, 80), 1 + rng_below(&rng, 60), 3);
        struct hf_params p = random_params(&rng);
        const float value = values[i % 7];
        for (int ch = 0; ch < 3; ch++)
            for (int k = 0; k < s.colour.width * s.colour.height; k++)
                s.colour.plane[ch][k] = value;
        struct picture a = render_scene(c, &s, &p);
        const double bound = p.gaussian.faithful ? (20 * p.gaussian.iterations + 20) * U * fabs((double)value) : 0;
        CHECK_MSG(largest_difference(&a, &s.colour) <= bound, "%s: seed %u: constant %g changes by %g, bound %g", isa,
                  seed + i, value, largest_difference(&a, &s.colour), bound);
        picture_free(&a);
        scene_free(&s);
    }
}

// Where nothing is blurred, the picture is copied bit for bit.
static void copies(struct hf_context *c, const char *isa)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_NEGATIVE, 90, 70, 4);
    for (int i = 0; i < 5; i++) {
        struct hf_params p = gaussian_params();
        p.range.strength = i == 0 ? 0 : 1;
        p.max_radius = i == 1 ? 0 : 12;
        p.gaussian.iterations = i == 2 ? 0 : 3;
        p.range.distance = i == 3 ? INFINITY : HF_DERIVE;
        if (i == 4) {
            p.model = HF_MODEL_LENS;
            p.lens.f_number = INFINITY;
        }
        struct picture a = render_scene(c, &s, &p);
        CHECK_MSG(picture_same_bits(&a, &s.colour), "%s: copy %d has other bits", isa, i);
        picture_free(&a);
    }
    scene_free(&s);
}

// Tiny steps of the focus make tiny steps in the picture: 3 |d(focus) - d| has a slope of 3 / 100 per unit, the blend
// of at most 1.
static void focus_pull(struct hf_context *c, const char *isa)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_RAMP, 80, 60, 3);
    struct hf_params p = gaussian_params();
    const float step = 1.0f / 512;
    struct picture before = render_scene(c, &s, &p);
    double worst = 0;
    for (int i = 1; i <= 30; i++) {
        p.focus = 20 + (float)i * step;
        struct picture now = render_scene(c, &s, &p);
        worst = worse(worst, largest_difference(&now, &before));
        picture_free(&before);
        before = now;
    }
    const double lipschitz = worst / step / largest_sample(&s.colour), bound = 3.0 / 100 + 64 * U / step;
    printf("%s: focus pull: Lipschitz constant %.3g a unit, bound %.3g\n", isa, lipschitz, bound);
    CHECK(lipschitz <= bound);
    picture_free(&before);
    scene_free(&s);
}

// The blend by depth has the range model's strength, with a lens too.
static void strengths(void)
{
    static const float odd[] = {NAN, INFINITY, -1, 1.5f};
    const struct hf_depth depth = {.size = sizeof depth, .type = HF_DEPTH_VIEW};
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_GAUSSIAN;
    p.model = HF_MODEL_LENS;
    for (int i = 0; i < 4; i++) {
        p.range.strength = odd[i];
        p.gaussian.by_depth = 1;
        CHECK_INT(hf_resolve(21, 13, &depth, &p, NULL, NULL, NULL), HF_ERR_ARG);
        p.gaussian.by_depth = 0;
        CHECK_INT(hf_resolve(21, 13, &depth, &p, NULL, NULL, NULL), HF_OK);
    }
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    struct hf_context *plain = context_new(HF_ISA_SCALAR, 2, 0, 0);
    for (int id = HF_ISA_SCALAR; id <= HF_ISA_NEON; id++) {
        if (!hf_isa_available((enum hf_isa)id))
            continue;
        const char *isa = hf_isa_name((enum hf_isa)id);
        struct hf_context *c = context_new((enum hf_isa)id, 2, 0, 0);
        same_bits(plain, (enum hf_isa)id, isa);
        flips(c, isa);
        crops(c, isa);
        exposures(c, isa);
        bad_samples(c, isa);
        largest_floats(plain, c, isa);
        constants(c, isa);
        copies(c, isa);
        focus_pull(c, isa);
        hf_close(&c);
    }
    hf_close(&plain);
    strengths();
    return check_report();
}
