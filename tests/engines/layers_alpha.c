// SPDX-License-Identifier: BSD-3-Clause
// Alpha of the layers engine: opaque stays opaque to the bit, holes melt as colours do, and no rim appears.
//
//     layers_alpha [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/render.h"

static unsigned seed = 1;

static struct hf_params random_params(struct rng *rng)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = rng_range(rng, 1, 45);
    p.layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    p.run.deterministic = rng_below(rng, 2);
    p.aperture.blades = rng_below(rng, 3) ? 0 : 3 + rng_below(rng, 7);
    p.aperture.ring = rng_below(rng, 4) ? 0 : rng_float(rng);
    p.aperture.ring = fminf(p.aperture.ring, 0.95f);
    p.aperture.cat_eye = rng_below(rng, 4) ? 0 : rng_float(rng);
    p.aperture.chromatic = rng_below(rng, 4) ? 0 : rng_range(rng, -0.3f, 0.3f);
    return p;
}

// An alpha of 1 everywhere is exactly 1 everywhere in the result.
static void opaque(struct hf_context *c)
{
    struct rng rng = rng_seed(seed);
    for (int n = 0; n < 24; n++) {
        const int width = 1 + rng_below(&rng, 200), height = 1 + rng_below(&rng, 120);
        const enum scene_kind kind = (enum scene_kind)(n % SCENE_KINDS);
        struct scene s = scene_new(&rng, kind, width, height, 4);
        const struct hf_params p = random_params(&rng);
        picture_fill(&s.colour, 3, 1);
        struct picture out = render_scene(c, &s, &p);
        int other = 0;
        for (int i = 0; i < width * height; i++)
            other += out.plane[3][i] != 1;
        CHECK_MSG(!other, "%s, %d x %d: %d pixels have another alpha than 1", scene_name(kind), width, height, other);
        picture_free(&out);
        scene_free(&s);
    }
}

// An alpha that is 1 everywhere is not drawn, and colours do not depend on it. So one hole in a corner changes nothing
// beyond the reach of the engine. For radii up to 8 that is 8 and 24 of upsampling, 28 of hidden samples of three
// levels, 26 of highlights, 6 of un-mixing, and whole tiles of 16.
static void not_drawn(struct hf_context *c)
{
    const int width = 320, height = 64, far = 128;
    struct rng rng = rng_seed(seed + 2);
    for (int n = 0; n < 6; n++) {
        struct scene s = scene_new(&rng, n % 2 ? SCENE_BLOCKS : SCENE_NOISE, width, height, 4);
        struct hf_params p = random_params(&rng);
        p.max_radius = rng_range(&rng, 2, 8);
        picture_fill(&s.colour, 3, 1);
        struct picture without = render_scene(c, &s, &p);
        s.colour.plane[3][0] = 0.5f;
        struct picture with = render_scene(c, &s, &p);
        int other = 0;
        for (int i = 0; i < 4 * width * height; i++) {
            const int k = i / (width * height), at = i % (width * height);
            other += at % width >= far && without.plane[k][at] != with.plane[k][at];
        }
        CHECK_MSG(!other, "case %d: %d samples far from a hole are others", n, other);
        CHECK(with.plane[3][0] < 1);
        picture_free(&without);
        picture_free(&with);
        scene_free(&s);
    }
}

// An alpha above 1: vectors make the pictures of plain C. They leave out what cannot be beside a lamp, and of such an alpha less
// than nothing would be open.
static void above_one(struct hf_context *c)
{
    struct hf_context *plain = context_new(HF_ISA_SCALAR, 1, 0, 0);
    struct rng rng = rng_seed(seed + 3);
    for (int n = 0; n < 12; n++) {
        const int width = 16 + rng_below(&rng, 60), height = 16 + rng_below(&rng, 40);
        struct scene s = scene_new(&rng, (enum scene_kind)(n % SCENE_FAR), width, height, 4);
        struct hf_params p = random_params(&rng);
        p.run.deterministic = 1;
        for (int i = 0; i < width * height; i++)
            s.colour.plane[3][i] = n % 2 ? 2 : rng_range(&rng, 0, 2);
        struct picture want = render_scene(plain, &s, &p), got = render_scene(c, &s, &p);
        const int other = samples_other(&want, &got);
        CHECK_MSG(!other, "case %d: %d samples are not those of plain C", n, other);
        picture_free(&got);
        picture_free(&want);
        scene_free(&s);
    }
    hf_close(&plain);
}

// If colours are alpha times one colour, so is the result: no pixel is brighter or darker than its alpha says. Both are
// sums with the same weights, of samples whose roundings differ by 2^-24 each, and of roundings of the sums, pairwise
// or of at most a hundred rows of similar size: 34 half units of the last place of the largest, as for constant
// pictures. A highlight is detected by colour, but its share is taken from both.
static void one_colour(struct hf_context *c)
{
    struct rng rng = rng_seed(seed + 1);
    for (int n = 0; n < 16; n++) {
        const int width = 160, height = 110;
        struct scene s = scene_new(&rng, n % 3 ? SCENE_BLOCKS : SCENE_NOISE, width, height, 4);
        struct hf_params p = random_params(&rng);
        p.aperture.chromatic = 0;
        p.layers.no_highlights = 1;
        for (int i = 0; i < width * height; i++) {
            const float hole = i / width / 20 % 2 && i % width / 17 % 2 ? 0 : 1;
            const float a = n % 2 ? hole : rng_below(&rng, 3) ? hole : rng_float(&rng);
            for (int k = 0; k < 4; k++)
                s.colour.plane[k][i] = k < 3 ? 0.25f * (float)(1 << k) * a : a;
        }
        struct picture out = render_scene(c, &s, &p);
        double worst = 0, least = 1, most = 0;
        for (int i = 0; i < width * height; i++)
            for (int k = 0; k < 3; k++) {
                const double a = out.plane[3][i];
                worst = worse(worst, fabs(out.plane[k][i] - 0.25 * (1 << k) * a));
                least = fmin(least, a);
                most = fmax(most, a);
            }
        CHECK_MSG(worst <= 4e-6, "case %d: a colour is %g off its alpha", n, worst);
        CHECK_MSG(least >= 0 && most <= 1, "case %d: alpha is %g to %g", n, least, most);
        picture_free(&out);
        scene_free(&s);
    }
}

// Half the picture is a hole. Alpha across its edge is the part of the disc's area on that side. A row of the disc
// counts as a run of its mean length, exact in area. So at most half of the chord's change over a pixel's height goes
// to the wrong side of a column, at either end: together at most the column's height, 2 sqrt(r^2 - x^2), times that,
// which is below 1 / r of the area. The edge lies on pixels of half and a quarter of the resolution, whose tents spread
// it by one such pixel: size / r more, because a disc's columns hold at most 2 / (pi r) of its area.
static void holes(struct hf_context *c)
{
    static const float radii[] = {4, -6, 12, -20, 40};
    const int width = 256, height = 192;
    for (size_t n = 0; n < sizeof radii / sizeof *radii; n++) {
        struct picture colour = picture_new(width, height, 4), radius = picture_new(width, height, 1);
        const double r = fabsf(radii[n]);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_LAYERS;
        p.max_radius = HF_DERIVE;
        picture_fill(&radius, 0, radii[n]);
        for (int i = 0; i < width * height; i++)
            for (int k = 0; k < 4; k++)
                colour.plane[k][i] = i % width < width / 2 ? 1 : 0;
        const struct hf_depth depth = picture_radii(&radius);
        struct picture out = render(c, &colour, &depth, &p);
        double worst = 0;
        for (int x = 0; x < width; x++) {
            const double t = fmin(fmax((x + 0.5 - width / 2) / r, -1), 1);
            const double want = 0.5 - (asin(t) + t * sqrt(1 - t * t)) / 3.14159265358979;
            worst = worse(worst, fabs(out.plane[3][height / 2 * width + x] - want));
        }
        const double size = r < 8 ? 1 : r < 32 ? 2 : 4, bound = (1 + (size > 1 ? size : 0)) / r;
        printf("radius %g: alpha is %.4f off, bound %.4f\n", radii[n], worst, bound);
        CHECK_MSG(worst <= bound, "radius %g: alpha is %g off, bound %g", radii[n], worst, bound);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// Leaves with soft edges before nothing at all, as film alpha has them. Put over grey, the result lies between leaf and
// grey.
static void over_grey(struct hf_context *c)
{
    const int width = 220, height = 160;
    static const float radii[][2] = {{0, 30}, {-14, 30}, {-30, 3}, {6, 25}, {-5, 5}};
    for (size_t k = 0; k < 2 * sizeof radii / sizeof *radii; k++) {
        const size_t n = k / 2;
        struct picture colour = picture_new(width, height, 4), radius = picture_new(width, height, 1);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_LAYERS;
        p.max_radius = HF_DERIVE;
        p.layers.no_highlights = (int)k % 2;
        const double bound = 4e-6;
        for (int i = 0; i < width * height; i++) {
            const int x = i % width, y = i / width;
            const float d = 40 + 18 * sinf((float)x * 0.07f) - hypotf((float)x - 110.3f, (float)y - 79.6f);
            const float a = fminf(fmaxf(d + 0.5f, 0), 1);
            for (int j = 0; j < 4; j++)
                colour.plane[j][i] = j < 3 ? 0.9f * a : a;
            radius.plane[0][i] = d > 0 ? radii[n][0] : radii[n][1];
        }
        const struct hf_depth depth = picture_radii(&radius);
        struct picture out = render(c, &colour, &depth, &p);
        double least = 1, most = 0;
        for (int i = 0; i < width * height; i++) {
            const double v = out.plane[1][i] + 0.5 * (1 - (double)out.plane[3][i]);
            least = fmin(least, v);
            most = fmax(most, v);
        }
        CHECK_MSG(least >= 0.5 - bound && most <= 0.9 + bound, "case %d: over grey, pixels are %g to %g", (int)n, least,
                  most);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)atoi(argv[1]) : 1;
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    opaque(c);
    not_drawn(c);
    above_one(c);
    one_colour(c);
    holes(c);
    over_grey(c);
    hf_close(&c);
    return check_report();
}
