// SPDX-License-Identifier: BSD-3-Clause
// Hard cases of gather and chapter, as pairs of pictures: shifts and crops, flips, transposes, exposure, threads, widths
// around a vector's length, a focus pull.
//
//     invariance [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"

static unsigned seed = 1;

// Any valid options except the lens, whose blur depends on the picture's width.
static struct hf_params random_params(struct rng *rng)
{
    struct hf_params p = scene_params();
    static const float radii[] = {1, 3, 4, 8, 12, 12, 17.5f, 40};
    static const float strengths[] = {1, 1, 1, 0.7f, 0.3f, 0.1f};
    p.max_radius = radii[rng_below(rng, 8)];
    p.range.strength = strengths[rng_below(rng, 6)];
    p.chapter.faithful = rng_below(rng, 3) == 0;
    p.chapter.karis = rng_below(rng, 3) == 0;
    p.chapter.per_pixel_kernel = rng_below(rng, 3) == 0;
    p.chapter.bicubic = rng_below(rng, 3) == 0;
    p.chapter.fill = (enum hf_fill)rng_below(rng, 3);
    p.range.blend = (enum hf_blend)rng_below(rng, 2);
    p.chapter.storage = (enum hf_storage)(rng_below(rng, 5) % 3);
    p.aperture.blades = rng_below(rng, 3) ? 0 : 5 + rng_below(rng, 5);
    p.aperture.rotation = (float)rng_below(rng, 90);
    p.view.pixel_aspect = rng_below(rng, 4) ? 1 : rng_range(rng, 0.6f, 2);
    p.range.distance = rng_below(rng, 5) ? 10 : rng_range(rng, 0, 30);
    choose_fields(&p);
    return p;
}

// A crop of whole half-resolution pixels gives the crop of the result, except for a margin: twice the reach for the
// near CoC, and one pixel more each for fill and for upsampling (two for the cubic).
static void crops(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 40; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_HIGHLIGHTS, 200 + rng_below(&rng, 60), 160 + rng_below(&rng, 20), 3);
        struct hf_params p = random_params(&rng);
        p.max_radius = fminf(p.max_radius, 17.5f);
        const int x0 = 2 * rng_below(&rng, 20), y0 = 2 * rng_below(&rng, 20);
        const int w = 140 + rng_below(&rng, 20), h = 110 + rng_below(&rng, 10);
        struct scene part = {picture_cut(&s.colour, x0, y0, w, h), picture_cut(&s.depth, x0, y0, w, h)};
        struct picture whole = render_scene(c, &s, &p), a = render_scene(c, &part, &p);
        const int mx = 2 * (2 * (int)ceilf(p.max_radius / 2 / p.view.pixel_aspect) + 4);
        const int my = 2 * (2 * (int)ceilf(p.max_radius / 2) + 4);
        struct picture b = picture_cut(&whole, x0 + mx, y0 + my, w - 2 * mx, h - 2 * my);
        struct picture inner = picture_cut(&a, mx, my, w - 2 * mx, h - 2 * my);
        CHECK_MSG(picture_same_bits(&b, &inner), "%s: seed %u, crop at (%d, %d): other bits", isa, seed + i, x0, y0);
        picture_free(&whole);
        picture_free(&a);
        picture_free(&b);
        picture_free(&inner);
        scene_free(&part);
        scene_free(&s);
    }
}

// Depth constant per quad, even size, default composite, taps that mirror, no per-pixel kernel (it adds its taps in the
// order of their angles).
static struct scene quad_scene(struct rng *rng, int w, int h)
{
    struct scene s = scene_new(rng, SCENE_BLOCKS, w, h, 4);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            s.depth.plane[0][y * w + x] = s.depth.plane[0][(y & ~1) * w + (x & ~1)];
    return s;
}

static void flips(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 40; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = quad_scene(&rng, 2 * (20 + rng_below(&rng, 50)), 2 * (10 + rng_below(&rng, 30)));
        struct hf_params p = random_params(&rng);
        p.chapter.faithful = p.chapter.per_pixel_kernel = p.aperture.blades = 0;
        choose_fields(&p);
        struct scene mirror = {picture_flipped(&s.colour), picture_flipped(&s.depth)};
        struct picture a = render_scene(c, &s, &p), b = render_scene(c, &mirror, &p), back = picture_flipped(&b);
        CHECK_MSG(picture_same_bits(&a, &back),
                  "%s: seed %u: flipping gives other bits (storage %d, fill %d, karis %d,"
                  " bicubic %d)",
                  isa, seed + i, p.chapter.storage, p.chapter.fill, p.chapter.karis, p.chapter.bicubic);
        picture_free(&a);
        picture_free(&b);
        picture_free(&back);
        scene_free(&mirror);
        scene_free(&s);
    }
}

// Transposing changes only the order of sums: twice the roundings of all passes (chapter.c) in units of the largest
// sample, 2 * (2 * 129 lattice weights + 12 + 32 + 11 + 102) * FLT_EPSILON / 2.
static void transposes(struct hf_context *c, const char *isa)
{
    const double bound = (2 * 129 + 12 + 32 + 11 + 102) * (double)FLT_EPSILON;
    double worst = 0;
    for (unsigned i = 0; i < 30; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_BLOCKS, 40 + rng_below(&rng, 60), 30 + rng_below(&rng, 50), 3);
        struct hf_params p = random_params(&rng);
        p.view.pixel_aspect = 1;
        p.aperture.blades = 0;
        p.max_radius = 12;
        p.chapter.storage = p.gather.storage = HF_STORAGE_FLOAT;
        p.gather.per_pixel_kernel = 0;
        p.chapter.per_pixel_kernel = 0;  // its threshold on CoC differences apart, it is in chapter.c
        struct scene turned = {picture_transposed(&s.colour), picture_transposed(&s.depth)};
        struct picture a = render_scene(c, &s, &p), b = render_scene(c, &turned, &p), back = picture_transposed(&b);
        worst = worse(worst, largest_difference(&a, &back) / largest_sample(&s.colour));
        picture_free(&a);
        picture_free(&b);
        picture_free(&back);
        scene_free(&turned);
        scene_free(&s);
    }
    printf("%s: transpose: %.2g of the largest sample, bound %.2g\n", isa, worst, bound);
    CHECK_MSG(worst <= bound, "%s: transposing changes %g of the largest sample, bound %g", isa, worst, bound);
}

static void exposures(struct hf_context *c, const char *isa)
{
    static const int exponents[] = {-20, -3, 1, 12, 30};
    for (unsigned i = 0; i < 40; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, SCENE_HIGHLIGHTS, 60 + rng_below(&rng, 60), 40 + rng_below(&rng, 40), 4);
        struct hf_params p = random_params(&rng);
        p.chapter.karis = p.gather.karis = 0;
        p.chapter.storage = p.gather.storage = HF_STORAGE_FLOAT;
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

// 1 to 7 threads, tiles of as many sizes, and repetition.
static void threads(enum hf_isa isa)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_HIGHLIGHTS, 401, 307, 3);
    for (int look = 0; look < 6; look++) {
        const int storage = look % 3;
        struct picture first = {0};
        for (int n = 1; n <= 7; n++) {
            struct hf_context *c = context_new(isa, n, 16 * (n - 1), n > 1 ? 14 + 3 * n : 0);
            struct hf_params p = scene_params();
            p.chapter.storage = (enum hf_storage)storage;
            p.chapter.karis = storage == 1;
            p.chapter.fill = look / 3 ? HF_FILL_MAX : HF_FILL_MEAN;
            choose_fields(&p);
            for (int i = 0; i < 2; i++) {
                struct picture out = render_scene(c, &s, &p);
                if (!first.width)
                    first = picture_copy(&out);
                CHECK_MSG(picture_same_bits(&first, &out), "%s: %d threads, frame %d: other bits", hf_isa_name(isa), n,
                          i);
                picture_free(&out);
            }
            hf_close(&c);
        }
        picture_free(&first);
    }
    scene_free(&s);
}

// Every width around the length of vectors, against plain C.
static void widths(struct hf_context *c, struct hf_context *plain, const char *isa)
{
    for (int w = 1; w <= 70; w++) {
        for (int h = 1; h <= 5; h += 2) {
            struct rng rng = rng_seed(seed + (unsigned)(8 * w + h));
            struct scene s = scene_new(&rng, SCENE_NOISE, w, h, 3 + w % 2);
            struct hf_params p = random_params(&rng);
            p.run.deterministic = 1;
            struct picture a = render_scene(c, &s, &p), b = render_scene(plain, &s, &p);
            CHECK_MSG(picture_same_bits(&a, &b), "%s: %d x %d: not the bits of plain C", isa, w, h);
            picture_free(&a);
            picture_free(&b);
            scene_free(&s);
        }
    }
}

// Pull the focus in tiny steps through a floor of random colours: the picture follows in tiny steps. The measured value
// is the largest change of a sample (of colours up to 1) per change of CoC.
static void focus_pull(struct hf_context *c, const char *isa)
{
    struct rng rng = rng_seed(seed);
    struct scene s = scene_new(&rng, SCENE_RAMP, 160, 90, 3);
    for (int i = 0; i < 160 * 90; i++)  // at an angle, without steps
        s.depth.plane[0][i] = 10 + 25 * (float)(i % 160 + 2 * (i / 160)) / 340;
    struct hf_params p = scene_params();
    const float step = 1.0f / 512;  // a tenth of it in CoC
    struct picture before = render_scene(c, &s, &p);
    double worst = 0;
    for (int i = 1; i <= 60; i++) {
        p.focus = 20 + (float)i * step;
        struct picture now = render_scene(c, &s, &p);
        worst = worse(worst, largest_difference(&now, &before));
        picture_free(&before);
        before = now;
    }
    picture_free(&before);
    const double lipschitz = worst / (step / p.range.distance);
    printf("%s: focus pull: largest step %.3g, Lipschitz constant %.2f\n", isa, worst, lipschitz);
    CHECK_MSG(lipschitz <= 20, "%s: Lipschitz constant %.2f", isa, lipschitz);
    scene_free(&s);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 1;
    printf("seed %u\n", seed);
    struct hf_context *plain = context_new(HF_ISA_SCALAR, 2, 0, 0);
    for (int isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        if (!hf_isa_available((enum hf_isa)isa))
            continue;
        const char *name = hf_isa_name((enum hf_isa)isa);
        struct hf_context *c = context_new((enum hf_isa)isa, 2, 0, 0);
        crops(c, name);
        flips(c, name);
        transposes(c, name);
        exposures(c, name);
        threads((enum hf_isa)isa);
        widths(c, plain, name);
        focus_pull(c, name);
        hf_close(&c);
    }
    hf_close(&plain);
    return check_report();
}
