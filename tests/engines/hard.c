// SPDX-License-Identifier: BSD-3-Clause
// Hard cases of gather and chapter, values: bad samples, exact copies, constants, energy, ranges, extreme sizes.
// invariance.c has the cases that compare two pictures (shifts, flips, threads, skipping).
//
//     hard [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/reference.h"
#include "support/render.h"
#include "tools/common/report.h"

static unsigned seed = 1;

struct run {
    struct hf_context *c;
    const char *isa;
};

// Bad and strange colour samples. Rendering them must give, bit for bit, what rendering the repaired picture gives.
static void bad_colours(const struct run *run, unsigned variant)
{
    static const float strange[] = {NAN, INFINITY, -INFINITY, 1e-40f, -1e-42f, -3, 65504, 1e30f, -0.0f, -1e30f};
    struct rng rng = rng_seed(seed + variant);
    struct scene s = scene_new(&rng, SCENE_BLOCKS, 61, 45, 4);
    const struct hf_depth depth = picture_depth(&s.depth);
    uint64_t bad = 0;
    for (int i = 0; i < 150; i++)
        s.colour.plane[rng_below(&rng, 4)][rng_below(&rng, 61 * 45)] = strange[rng_below(&rng, 10)];
    for (int y = 10; y < 14; y++)  // a patch that no mean of neighbours can repair completely
        for (int x = 20; x < 25; x++)
            s.colour.plane[1][y * 61 + x] = NAN;
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < 61 * 45; i++)
            bad += !isfinite(s.colour.plane[c][i]);
    struct hf_params p = scene_params();
    p.range.strength = 0;  // a copy, repaired
    struct picture repaired = render(run->c, &s.colour, &depth, &p);
    struct tool_report stats;
    tool_report_get(run->c, &stats);
    CHECK_INT(stats.all.colour_repaired, bad);
    double *want = malloc(sizeof *want * 61 * 45);
    for (int c = 0; c < 4; c++) {
        ref_repair(want, s.colour.plane[c], 61, 45);
        for (int i = 0; i < 61 * 45; i++) {
            const float in = s.colour.plane[c][i], out = repaired.plane[c][i];
            if (isfinite(in))
                CHECK_MSG(memcmp(&in, &out, 4) == 0, "%s: finite sample %g copied as %g", run->isa, in, out);
            else  // summed in double: one rounding
                CHECK_MSG(out == (float)want[i], "%s: channel %d (%d, %d) repaired to %g, expected %g", run->isa, c,
                          i % 61, i / 61, out, want[i]);
        }
    }
    free(want);
    p.range.strength = 1;
    p.chapter.karis = variant % 2 == 1;
    p.chapter.fill = (enum hf_fill)(variant % 3);
    p.chapter.per_pixel_kernel = variant % 4 == 3;
    choose_fields(&p);
    for (int no_skip = 0; no_skip < 2; no_skip++) {
        p.run.no_skip = no_skip;
        struct picture a = render(run->c, &s.colour, &depth, &p);
        tool_report_get(run->c, &stats);
        CHECK_INT(stats.all.colour_repaired, bad);
        struct picture b = render(run->c, &repaired, &depth, &p);
        CHECK_MSG(all_finite(&a), "%s: bad colours spread", run->isa);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: repairing first gives other bits, variant %u", run->isa, variant);
        picture_free(&a);
        picture_free(&b);
    }
    picture_free(&repaired);
    scene_free(&s);
}

static void all_bad(const struct run *run)
{
    struct picture colour = picture_new(9, 6, 3), depth = picture_new(9, 6, 1);
    for (int i = 0; i < 54; i++) {
        for (int c = 0; c < 3; c++)
            colour.plane[c][i] = i % 2 ? NAN : INFINITY;
        depth.plane[0][i] = NAN;
    }
    const struct hf_depth d = picture_depth(&depth);
    const struct hf_params p = scene_params();
    struct picture out = render(run->c, &colour, &d, &p);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 54; i++)
            CHECK_MSG(out.plane[c][i] == 0, "%s: nothing finite gives %g", run->isa, out.plane[c][i]);
    struct tool_report stats;
    tool_report_get(run->c, &stats);
    CHECK_INT(stats.all.colour_repaired, 3 * 54);
    CHECK_INT(stats.all.depth_repaired, 54);
    CHECK_INT(stats.all.no_surface, 54);
    picture_free(&out);
    picture_free(&colour);
    picture_free(&depth);
}

// NaN depths: the same bits as the depth repaired by hand; 0, negative, infinite and huge ones: as 1e10.
static void bad_depths(const struct run *run)
{
    struct rng rng = rng_seed(seed);
    for (int i = 0; i < 6; i++) {
        struct scene s = scene_new(&rng, SCENE_BLOCKS, 50 + i, 31 + i, 3);
        const int n = (50 + i) * (31 + i);
        static const float strange[] = {NAN, NAN, NAN, 0, -0.0f, -5, INFINITY, -INFINITY, 1e10f, 3e38f, 1e-42f};
        for (int k = 0; k < 200; k++)
            s.depth.plane[0][rng_below(&rng, n)] = strange[rng_below(&rng, 11)];
        struct picture mended = picture_copy(&s.depth);
        const struct hf_depth depth = picture_depth(&s.depth), clean = picture_depth(&mended);
        double *z = malloc(sizeof *z * (size_t)n);
        ref_depths(z, &depth, 1, 50 + i, 31 + i);
        int repaired = 0, no_surface = 0;
        for (int k = 0; k < n; k++) {
            mended.plane[0][k] = (float)fmin(z[k], 1e10);
            repaired += isnan(s.depth.plane[0][k]);
            no_surface += isinf(z[k]);
        }
        free(z);
        struct hf_params p = scene_params();
        p.model = i % 2 ? HF_MODEL_LENS : HF_MODEL_RANGE;
        p.lens.f_number = 0.1f;
        struct picture a = render(run->c, &s.colour, &depth, &p);
        struct tool_report stats;
        tool_report_get(run->c, &stats);
        CHECK_INT(stats.all.depth_repaired, repaired);
        CHECK_INT(stats.all.no_surface, no_surface);
        struct picture b = render(run->c, &s.colour, &clean, &p);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: mending depth by hand gives other bits", run->isa);
        CHECK(all_finite(&a));
        picture_free(&a);
        picture_free(&b);
        picture_free(&mended);
        scene_free(&s);
    }
}

// The largest floats, hardly blurred: a small CoC makes a colour small, and dividing by it must restore it.
static void giants(const struct run *run)
{
    struct picture colour = picture_new(40, 24, 4), radii = picture_new(40, 24, 1);
    for (int k = 0; k < 4; k++)
        picture_fill(&colour, k, k == 2 ? -FLT_MAX : FLT_MAX);
    for (int i = 0; i < 12; i++) {
        struct hf_params p = hf_default_params();
        p.max_radius = 16;
        p.chapter.fill = (enum hf_fill)(i % 4);
        p.chapter.downsample = (enum hf_downsample)(i / 4);
        choose_fields(&p);
        for (float radius = -0x1p-7f; radius <= 0x1p-7f; radius += 0x1p-6f) {
            picture_fill(&radii, 0, radius);
            const struct hf_depth depth = picture_radii(&radii);
            struct picture out = render(run->c, &colour, &depth, &p);
            CHECK_MSG(all_finite(&out), "%s: fill %d, downsample %d, radius %g: not finite", run->isa, i % 4, i / 4,
                      (double)radius);
            picture_free(&out);
        }
    }
    picture_free(&colour);
    picture_free(&radii);
}

// The values that mean "no surface" and 0 in the other depth types.
static void special_depths(const struct run *run)
{
    static const struct {
        enum hf_depth_type type;
        float value, far_plane;
        int sign;  // of the CoC: -1 near, 0 sharp, 1 far
    } cases[] = {
        {HF_DEPTH_INVERSE, 0, 0, 1},
        {HF_DEPTH_INVERSE, -1, 0, 1},
        {HF_DEPTH_INVERSE, INFINITY, 0, -1},
        {HF_DEPTH_INVERSE, 1, 0, -1},
        {HF_DEPTH_NDC_D3D, 0, 100, -1},
        {HF_DEPTH_NDC_D3D, 1, 100, 1},
        {HF_DEPTH_NDC_D3D, 1, INFINITY, 1},
        {HF_DEPTH_NDC_GL, -1, 100, -1},
        {HF_DEPTH_NDC_GL, 0, 3, -1},
        {HF_DEPTH_NDC_GL, 1, INFINITY, 1},
        {HF_DEPTH_NDC_REVERSED, 0, 100, 1},
        {HF_DEPTH_NDC_REVERSED, 0, INFINITY, 1},
        {HF_DEPTH_NDC_REVERSED, 1, 100, -1},
        {HF_DEPTH_COC, 0, 0, 0},
        {HF_DEPTH_COC, -0.0f, 0, 0},
        {HF_DEPTH_COC, INFINITY, 0, 1},
        {HF_DEPTH_COC, -INFINITY, 0, -1},
        {HF_DEPTH_COC, -1e30f, 0, -1},
        {HF_DEPTH_RAY, 0, 0, 1},
        {HF_DEPTH_RAY, -2, 0, 1},
        {HF_DEPTH_RAY, 2, 0, -1},
        {HF_DEPTH_RAY, INFINITY, 0, 1},
    };
    struct picture colour = picture_new(8, 8, 3), depth = picture_new(8, 8, 1);
    const struct hf_params p = scene_params();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int k = 0; k < 64; k++)
            depth.plane[0][k] = cases[i].value;
        struct hf_depth d = picture_depth(&depth);
        d.type = cases[i].type;
        d.near_plane = 1;
        d.far_plane = cases[i].far_plane;
        d.focal_px = 8;
        struct picture out = render(run->c, &colour, &d, &p);
        struct tool_report s;
        tool_report_get(run->c, &s);
        const int sign = s.all.near_pixels == 64 ? -1 : s.all.far_pixels == 64 ? 1 : s.all.sharp_pixels == 64 ? 0 : 99;
        CHECK_MSG(sign == cases[i].sign, "%s: depth type %d, %g: CoC sign %d, expected %d", run->isa, cases[i].type,
                  cases[i].value, sign, cases[i].sign);
        picture_free(&out);
    }
    picture_free(&colour);
    picture_free(&depth);
}

// No blur at all: any input keeps its bits, in every storage.
static void copies(const struct run *run)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_NOISE, 83, 29, 4);
    static const float strange[] = {1e-40f, -0.0f, -3, 65504, 1e30f, FLT_MAX, -FLT_MAX};
    for (int i = 0; i < 100; i++)
        s.colour.plane[rng_below(&rng, 4)][rng_below(&rng, 83 * 29)] = strange[rng_below(&rng, 7)];
    const struct hf_depth depth = picture_depth(&s.depth);
    for (int i = 0; i < 60; i++) {
        struct hf_params p = scene_params();
        p.chapter.storage = (enum hf_storage)(i / 5 % 3);
        p.chapter.faithful = i / 15 % 2;
        p.chapter.fill = p.chapter.faithful ? HF_FILL_MAX : HF_FILL_MEAN;
        choose_fields(&p);
        p.run.no_skip = i / 30;
        struct hf_depth d = depth;
        switch (i % 5) {
        case 0:
            p.range.distance = INFINITY;
            break;
        case 1:
            p.range.strength = 0;
            break;
        case 2:
            p.max_radius = 0;
            break;
        case 3:
            p.model = HF_MODEL_LENS;
            p.lens.f_number = INFINITY;
            break;
        case 4:  // given distances that put everything in focus
            p.range.near_begin = p.range.near_end = 0;
            p.range.far_begin = p.range.far_end = 2e10f;
            break;
        }
        if (i % 5 == 4) {
            // No surface is behind any far_begin: only finite depths here.
            for (int k = 0; k < 83 * 29; k++)
                if (!(s.depth.plane[0][k] > 0 && s.depth.plane[0][k] < 1e10f))
                    s.depth.plane[0][k] = 20;
        }
        struct picture out = render(run->c, &s.colour, &d, &p);
        // The other storages round what they read; only a copy keeps the bits.
        if (i % 5 != 4 || p.chapter.storage == HF_STORAGE_FLOAT)
            CHECK_MSG(picture_same_bits(&out, &s.colour), "%s: case %d, storage %d: not the input's bits", run->isa,
                      i % 5, p.chapter.storage);
        picture_free(&out);
    }
    scene_free(&s);
}

// A constant picture stays constant at any depth. Returns the largest error in ulps.
static double constant(const struct run *run, const struct hf_params *p, float value, int w, int h, unsigned number)
{
    struct rng rng = rng_seed(seed + number);
    struct scene s = scene_new(&rng, (enum scene_kind)(number % SCENE_HIGHLIGHTS), w, h, 4);
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < w * h; i++)
            s.colour.plane[c][i] = value * (float)(1 + c);
    const struct hf_depth depth = picture_depth(&s.depth);
    struct picture out = render(run->c, &s.colour, &depth, p);
    double worst = 0;
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < w * h; i++)
            worst = worse(worst, fabs((double)out.plane[c][i] - s.colour.plane[c][i]) / (value * (1 + c)));
    picture_free(&out);
    scene_free(&s);
    return worst / FLT_EPSILON;
}

static void constants(const struct run *run)
{
    static const float values[] = {0.1f, 1.0f / 3, 7.77f, 1e-3f, 60000};
    double worst[2] = {0, 0};  // convolved; with the per-pixel kernel
    for (unsigned i = 0; i < 120; i++) {
        struct hf_params p = scene_params();
        p.chapter.karis = i % 5 == 1;
        p.chapter.bicubic = i % 3 == 1;
        p.chapter.per_pixel_kernel = i % 7 == 2;
        p.chapter.fill = (enum hf_fill)(i / 3 % 3);
        choose_fields(&p);
        p.aperture.blades = i % 4 == 3 ? 5 + (int)(i / 4 % 5) : 0;
        p.range.strength = i % 6 == 5 ? 0.2f : i % 6 == 4 ? 0.7f : 1;
        p.max_radius = i % 10 == 9 ? 40 : i % 10 == 8 ? 3 : 12;
        double *w = &worst[p.chapter.per_pixel_kernel];
        *w = worse(*w, constant(run, &p, values[i % 5], 70 - (int)(i % 9), 40 + (int)(i % 5), i));
        // CoC larger than the picture.
        p.max_radius = 100;
        *w = worse(*w, constant(run, &p, values[i % 5], 1 + (int)(i % 9), 1 + (int)(i % 5), i));
    }
    printf("%s: constant in, constant out: %.1f ulp, per-pixel kernel %.1f ulp\n", run->isa, worst[0], worst[1]);
    CHECK_MSG(worst[0] <= 16, "%s: a constant moves by %.1f ulp", run->isa, worst[0]);
    // Taps are added one by one, 2601 of them at a radius of 100: one rounding each (half an ulp), in numerator and
    // denominator.
    CHECK_MSG(worst[1] <= 2601, "%s: a constant moves by %.1f ulp with the per-pixel kernel", run->isa, worst[1]);
}

// The energy of one highlight, with everything equally far out of focus, far or near.
static void energy(const struct run *run)
{
    double max_fill = 0;
    for (int i = 0; i < 96; i++) {
        struct picture colour = picture_new(96, 90, 3), z = picture_new(96, 90, 1);
        for (int k = 0; k < 96 * 90; k++)
            z.plane[0][k] = i & 1 ? 1 : INFINITY;
        const int x = 46 + i / 2 % 2, y = 44 + i / 4 % 2;
        for (int c = 0; c < 3; c++)
            colour.plane[c][y * 96 + x] = 1e4f;
        struct hf_params p = scene_params();
        p.chapter.fill = (enum hf_fill)(i / 8 % 3);
        p.chapter.bicubic = i / 24 % 2;
        choose_fields(&p);
        p.aperture.blades = i / 48 ? 7 : 0;
        const struct hf_depth depth = picture_depth(&z);
        struct picture out = render(run->c, &colour, &depth, &p);
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < 96 * 90; k++)
                sum += out.plane[c][k];
            if (p.chapter.fill == HF_FILL_MAX)
                max_fill = worse(max_fill, sum / 1e4);
            else
                CHECK_MSG(fabs(sum / 1e4 - 1) <= 1e-5, "%s: case %d: energy of a highlight %.8f", run->isa, i,
                          sum / 1e4);
        }
        picture_free(&out);
        picture_free(&colour);
        picture_free(&z);
    }
    printf("%s: maximum fill: energy x %.3f\n", run->isa, max_fill);
    CHECK(max_fill > 1 && max_fill < 9);
}

// No sample leaves the range of its sources, up to rounding. 60 ulp: the roundings of all passes, see chapter.c.
static void ranges(const struct run *run)
{
    for (int i = 0; i < 24; i++) {
        struct rng rng = rng_seed(seed + (unsigned)i);
        struct scene s = scene_new(&rng, (enum scene_kind)(i % SCENE_KINDS), 65, 44, 3);
        const struct hf_depth depth = picture_depth(&s.depth);
        struct hf_params p = scene_params();
        p.chapter.fill = (enum hf_fill)(i % 3);
        p.chapter.bicubic = i / 3 % 2;
        p.chapter.karis = i / 6 % 2;
        p.chapter.per_pixel_kernel = i / 12;
        p.chapter.storage = i % 5 == 4 ? HF_STORAGE_PACKED : HF_STORAGE_FLOAT;
        choose_fields(&p);
        struct picture out = render(run->c, &s.colour, &depth, &p);
        for (int c = 0; c < 3; c++) {
            float low = INFINITY, high = 0;
            for (size_t k = 0; k < samples_of(&out); k++) {
                low = fminf(low, s.colour.plane[c][k]);
                high = fmaxf(high, s.colour.plane[c][k]);
            }
            if (p.chapter.storage == HF_STORAGE_PACKED)
                low *= 0.85f;  // five truncations of up to 1/32
            int outside = 0;
            for (size_t k = 0; k < samples_of(&out); k++)
                outside += !(out.plane[c][k] >= low - 60 * FLT_EPSILON * high &&
                             out.plane[c][k] <= high * (1 + 60 * FLT_EPSILON));
            CHECK_MSG(outside == 0, "%s: case %d: %d samples outside %g..%g", run->isa, i, outside, low, high);
        }
        picture_free(&out);
        scene_free(&s);
    }
}

// The longest possible rows and columns: their ends equal those of a short picture with the same content.
static void long_pictures(const struct run *run)
{
    for (int tall = 0; tall < 2; tall++) {
        const int n = 65536, w = tall ? 3 : n, h = tall ? n : 3;
        struct picture colour = picture_new(w, h, 3), z = picture_new(w, h, 1);
        struct picture end = picture_new(tall ? 3 : 200, tall ? 200 : 3, 3);
        struct picture end_z = picture_new(end.width, end.height, 1);
        struct rng rng = rng_seed(seed);
        for (int i = 0; i < w * h; i++) {
            for (int c = 0; c < 3; c++)
                colour.plane[c][i] = rng_float(&rng);
            z.plane[0][i] = 5 + (float)rng_below(&rng, 6) * 5;
        }
        const int dx = w - end.width, dy = h - end.height;
        for (int y = 0; y < end.height; y++) {
            for (int x = 0; x < end.width; x++) {
                for (int c = 0; c < 3; c++)
                    end.plane[c][y * end.width + x] = colour.plane[c][(y + dy) * w + x + dx];
                end_z.plane[0][y * end.width + x] = z.plane[0][(y + dy) * w + x + dx];
            }
        }
        const struct hf_depth depth = picture_depth(&z), end_depth = picture_depth(&end_z);
        const struct hf_params p = scene_params();
        struct picture a = render(run->c, &colour, &depth, &p), b = render(run->c, &end, &end_depth, &p);
        int wrong = 0;
        for (int y = tall ? 60 : 0; y < end.height; y++)
            for (int x = tall ? 0 : 60; x < end.width; x++)
                for (int c = 0; c < 3; c++)
                    wrong += memcmp(&a.plane[c][(y + dy) * w + x + dx], &b.plane[c][y * end.width + x], 4) != 0;
        CHECK_MSG(wrong == 0, "%s: %d samples at the end of a %d x %d picture differ", run->isa, wrong, w, h);
        picture_free(&a);
        picture_free(&b);
        picture_free(&colour);
        picture_free(&z);
        picture_free(&end);
        picture_free(&end_z);
    }
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa))
            continue;
        struct run run = {context_new((enum hf_isa)isa, 2, 0, 0), hf_isa_name((enum hf_isa)isa)};
        for (unsigned variant = 0; variant < 8; variant++)
            bad_colours(&run, variant);
        all_bad(&run);
        bad_depths(&run);
        giants(&run);
        special_depths(&run);
        copies(&run);
        constants(&run);
        energy(&run);
        ranges(&run);
        long_pictures(&run);
        hf_close(&run.c);
    }
    return check_report();
}
