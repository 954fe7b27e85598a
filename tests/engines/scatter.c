// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: against a reference in double precision, single highlights, its options, and what may change
// no bit.
//
//     scatter [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"
#include "support/scatter_reference.h"

static unsigned seed = 1;
static const double PI = 3.14159265358979323846, U = FLT_EPSILON / 2;

static struct hf_params params_new(void)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_SCATTER;
    return p;
}

// ---- reference: discs at full resolution, radii up to 24

// Roundings, in units of the largest sample: two for a share and two for its weight, one each for settling, division
// (2), and twice two for a lerp, three times over as a base; 12 for the visible part of a sprite. For a mixed pixel's
// shares: 30 for a mean of 25 taps, 20 for what is made of two, and each counts up to 16 times where the two sides
// hardly differ. Shares are truncated to whole 2^-20ths.
static void against_reference(struct hf_context *c, const char *isa)
{
    const double bound = (40 + 16 * 50) * U + 0x1p-20;
    double worst = 0;
    for (unsigned i = 0; i < 14; i++) {
        struct rng rng = rng_seed(seed + i);
        struct scene s = scene_new(&rng, (enum scene_kind)(i % SCENE_KINDS), 30 + rng_below(&rng, 40),
                                   20 + rng_below(&rng, 30), 3 + (int)(i & 1));
        const int n = s.colour.width * s.colour.height;
        const float largest = rng_range(&rng, 1, 23);
        for (int k = 0; k < n; k++)
            s.depth.plane[0][k] = rng_below(&rng, 4) ? largest * (i % 3 ? s.depth.plane[0][k] > 20 ? 1 : -1 : 0.7f)
                                                     : rng_range(&rng, -largest, largest);
        struct hf_depth depth = picture_depth(&s.depth);
        depth.type = HF_DEPTH_COC;
        struct hf_params p = params_new();
        p.max_radius = HF_DERIVE;
        struct picture a = render(c, &s.colour, &depth, &p), b = scatter_reference(&s.colour, s.depth.plane[0]);
        worst = worse(worst, largest_difference(&a, &b) / largest_sample(&s.colour));
        picture_free(&a);
        picture_free(&b);
        scene_free(&s);
    }
    printf("%s: reference: %.3g of the largest sample, bound %.3g\n", isa, worst, bound);
    CHECK_MSG(worst <= bound, "%s: %g off the reference, bound %g", isa, worst, bound);
}

// ---- one highlight before black, the whole picture at one radius

struct spot {
    double energy[3], area[3], width, height;  // of the channels; area: energy over the value in the middle
    struct picture out;
};

static struct spot spot_at(struct hf_context *c, float radius, const struct hf_params *p, int size_x, int size_y, int x,
                           int y)
{
    struct picture colour = picture_new(size_x, size_y, 3), coc = picture_new(size_x, size_y, 1);
    for (int i = 0; i < size_x * size_y; i++)
        coc.plane[0][i] = radius;
    for (int k = 0; k < 3; k++)
        colour.plane[k][y * size_x + x] = 1e4f;
    struct hf_depth depth = picture_depth(&coc);
    depth.type = HF_DEPTH_COC;
    struct spot s = {.out = render(c, &colour, &depth, p)};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < size_x * size_y; i++)
            s.energy[k] += s.out.plane[k][i];
        s.area[k] = s.energy[k] / s.out.plane[k][y * size_x + x];
    }
    const float half = s.out.plane[1][y * size_x + x] / 2;
    for (int i = 0; i < size_x; i++)
        s.width += s.out.plane[1][y * size_x + i] > half;
    for (int i = 0; i < size_y; i++)
        s.height += s.out.plane[1][i * size_x + x] > half;
    picture_free(&colour);
    picture_free(&coc);
    return s;
}

static struct spot spot(struct hf_context *c, float radius, const struct hf_params *p)
{
    const int size = 2 * (int)(2.6f * fabsf(radius) + 8);  // the sprites of its neighbours lie inside as well
    return spot_at(c, radius, p, size, size, size / 2, size / 2);
}

static void highlights(struct hf_context *c, const char *isa)
{
    static const float radii[] = {0.25f, 0.5f,  0.7f, 1,  1.5f, 2.3f, 4,  7.5f, 12, 16,
                                  20,    23.9f, 25,   27, 28,   33,   64, 100,  200};
    struct hf_params p = params_new();
    p.max_radius = HF_DERIVE;
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        const double r = radii[i];
        struct spot s = spot(c, radii[i], &p);
        const int size = s.out.width, x = size / 2;
        CHECK_MSG(fabs(s.energy[0] - 1e4) <= 0.1, "%s: radius %g: energy %.8g", isa, r, s.energy[0]);
        // Smaller radii leave one pixel.
        if (r >= 0.56)
            CHECK_MSG(fabs(sqrt(s.area[0] / PI) - r) <= 0.5, "%s: radius %g: area %g", isa, r, s.area[0]);
        const float middle = s.out.plane[0][x * size + x];
        int wrong = 0;
        for (int j = 0; j < size * size; j++) {
            const double d = hypot(j % size - x, j / size - x);
            // Beyond radius 64 a flat cap may be off by another row of the half-resolution sums.
            const double off = r > 64 ? 0.75 : 0.5;
            wrong += d <= r - off && s.out.plane[0][j] < middle / 2;
            wrong += d >= r + off && d > 0 && s.out.plane[0][j] > middle / 2;
        }
        CHECK_MSG(!wrong, "%s: radius %g: %d pixels are more than half a pixel off the disc", isa, r, wrong);
        picture_free(&s.out);
    }
}

// ---- options

// A triangle, with the middle of one side turned by 20 degrees from +x towards +y. At 80 degrees there is a corner, so
// 0.8 of the radius is still inside. -80 degrees is 20 degrees beside the middle of another side, where the triangle
// ends at 0.53.
static void rotation(struct hf_context *c, const char *isa)
{
    struct hf_params p = params_new();
    const float r = 20;
    const double a = 80 * PI / 180;
    p.max_radius = HF_DERIVE;
    p.aperture.blades = 3;
    p.aperture.rotation = 20;
    struct spot s = spot(c, r, &p);
    const int size = s.out.width, x = size / 2 + (int)lround(0.8 * r * cos(a)), y = (int)lround(0.8 * r * sin(a));
    const float middle = s.out.plane[1][size / 2 * size + size / 2];
    const float there = s.out.plane[1][(size / 2 + y) * size + x], not = s.out.plane[1][(size / 2 - y) * size + x];
    CHECK_MSG(there > middle / 2 && not < middle / 2, "%s: a triangle turned by 20 degrees: %g and %g of %g", isa,
              there, not, middle);
    picture_free(&s.out);
}

static struct picture aperture_picture(int size, int coloured)
{
    struct picture a = picture_new(size, size, 3);
    for (int i = 0; i < size * size; i++)
        for (int k = 0; k < 3; k++)
            a.plane[k][i] = coloured && k == 0 && i % size < size / 2 ? 0 : 0.5f;
    return a;
}

static void options(struct hf_context *c, const char *isa)
{
    struct hf_params p = params_new();
    p.max_radius = HF_DERIVE;
    const float r = 20;
    struct spot plain = spot(c, r, &p);
    const int x = plain.out.width / 2;
    struct {
        const char *name;
        struct hf_params p;
        double area[3], ratio;  // expected: over the disc's, height over width; 0: any
    } cases[9];
    int n = 0;
    const double ring = 1 - 0.5 * 0.5, hexagon = 6 * sin(2 * PI / 6) / 2 / PI;
#define CASE(title, field, value, a0, a1, a2, hw)                                                                      \
    cases[n].name = title, cases[n].p = p, cases[n].p.field = value, cases[n].area[0] = a0, cases[n].area[1] = a1,     \
    cases[n].area[2] = a2, cases[n++].ratio = hw
    CASE("chromatic", aperture.chromatic, 0.1f, 1.21, 1, 0.81, 1);
    CASE("squeeze", aperture.squeeze, 2, 0.5, 0.5, 0.5, 2);
    CASE("pixel_aspect", view.pixel_aspect, 2, 0.5, 0.5, 0.5, 2);
    CASE("blades", aperture.blades, 6, hexagon, hexagon, hexagon, 0);
    CASE("roundness", aperture.blades, 6, 1, 1, 1, 1);
    cases[n - 1].p.aperture.roundness = 1;
    CASE("rotation", aperture.blades, 4, 2 / PI, 2 / PI, 2 / PI, 1);
    cases[n - 1].p.aperture.rotation = 30;
    CASE("half resolution", scatter.resolution, HF_RESOLUTION_HALF, 1, 1, 1, 1);
    CASE("cat_eye in the middle", aperture.cat_eye, 1, 1, 1, 1, 1);
    for (int i = 0; i < n; i++) {
        // A shape that varies with its place keeps energy only as far as its area is the same. A source at q from the
        // middle draws the part of the disc around q that lies within the disc around q (1 + k), k = 2 r over the
        // diagonal. So the sources that cover a pixel p lie within r / (1 + k) of p / (1 + k). Each weighs 1 over its
        // area, which is the disc's less 2 / PI of the second disc's shift in radii, at most 2 k, because they lie
        // within 2 r.
        const int eye = cases[i].p.aperture.cat_eye > 0, size = eye ? 400 : 2 * x;
        const double k_eye = eye ? 2 * r / hypot(size, size) : 0, most = (1 + k_eye) * (1 + k_eye) * 1e4;
        const double least = most * (1 - 2 / PI * 2 * k_eye);
        struct spot s = spot_at(c, r, &cases[i].p, size, size, size / 2, size / 2);
        for (int k = 0; k < 3; k++) {
            CHECK_MSG(s.energy[k] >= least - 0.1 && s.energy[k] <= most + 0.1, "%s: %s: energy %.8g, not %g to %g", isa,
                      cases[i].name, s.energy[k], least, most);
            CHECK_MSG(eye || fabs(s.area[k] / plain.area[k] - cases[i].area[k]) < 0.02,
                      "%s: %s: channel %d has %g of the area,"
                      " expected %g",
                      isa, cases[i].name, k, s.area[k] / plain.area[k], cases[i].area[k]);
        }
        CHECK_MSG(cases[i].ratio == 0 || fabs(s.height / s.width - cases[i].ratio) < 0.2, "%s: %s: %g x %g", isa,
                  cases[i].name, s.width, s.height);
        struct spot same = spot_at(c, r, &p, size, size, size / 2, size / 2);
        CHECK_MSG(!picture_same_bits(&s.out, &same.out), "%s: %s: no effect", isa, cases[i].name);
        picture_free(&same.out);
        picture_free(&s.out);
    }
    p.aperture.ring = 0.5f;
    struct spot hole = spot(c, r, &p);
    const double share = hole.out.plane[0][x * hole.out.width + x + 15];
    CHECK_MSG(fabs(hole.energy[0] - 1e4) <= 0.1, "%s: ring: energy %.8g", isa, hole.energy[0]);
    CHECK_MSG(hole.out.plane[0][x * hole.out.width + x] < 1e-3 * share, "%s: the ring has no hole", isa);
    CHECK_MSG(fabs(1e4 / share / plain.area[0] - ring) < 0.02, "%s: ring: area %g", isa, 1e4 / share);
    p.aperture.ring = 0;
    picture_free(&hole.out);

    // The lens of two circles one radius apart has 0.39 of a circle's area. A place that is not the very corner has a
    // bit more.
    p.aperture.cat_eye = 1;
    struct spot corner = spot_at(c, r, &p, 600, 600, 60, 60);
    CHECK_MSG(corner.area[0] / plain.area[0] < 0.6 && corner.area[0] / plain.area[0] > 0.3,
              "%s: cat's eye: %g of the area", isa, corner.area[0] / plain.area[0]);
    picture_free(&corner.out);
    p.aperture.cat_eye = 0;

    for (int coloured = 0; coloured < 2; coloured++) {
        struct picture image = aperture_picture(32, coloured);
        const struct hf_image aperture = picture_image(&image);
        p.aperture.picture = &aperture;
        struct spot s = spot(c, r, &p);
        for (int k = 0; k < 3; k++)
            CHECK_MSG(fabs(s.energy[k] - 1e4) <= 0.1, "%s: image: energy %.8g", isa, s.energy[k]);
        CHECK_MSG(fabs(s.area[1] - 4 * r * r) < 0.02 * 4 * r * r, "%s: square image: area %g", isa, s.area[1]);
        const float left = s.out.plane[0][x * s.out.width + x - 10], right = s.out.plane[0][x * s.out.width + x + 10];
        CHECK_MSG(coloured ? left < 1e-3f * right : left == right, "%s: image %d: red %g and %g", isa, coloured, left,
                  right);
        picture_free(&s.out);
        picture_free(&image);
    }
    picture_free(&plain.out);
}

// An aperture's picture of which only red lies in the lens: the rest of its light is farther from the middle than twice its
// shorter side, and cut off. Differences of its sums leave rounding errors, which are no light. Of a noise no mean leaves the
// range of its samples, by more than the 2^-24 that shares are rounded by, twice.
static void cut_off(struct hf_context *c, const char *isa)
{
    struct rng rng = rng_seed(seed);
    struct hf_params p = params_new();
    p.max_radius = 20;
    for (int n = 0; n < 12; n++) {
        struct picture image = picture_new(1, 9, 3), noise = picture_new(40, 40, 3), radius = picture_new(40, 40, 1);
        const struct hf_image aperture = picture_image(&image);
        const struct hf_depth depth = picture_radii(&radius);
        const float r = rng_range(&rng, 4, 20);
        p.aperture.picture = &aperture;
        image.plane[0][4] = 1;
        for (int k = 2; k < 6; k++)
            image.plane[k / 2][k % 2 ? 7 : 0] = rng_range(&rng, 0.1f, 1);
        picture_fill(&radius, 0, n % 2 ? r : -r);
        for (int i = 0; i < 3 * 1600; i++)
            noise.plane[i / 1600][i % 1600] = rng_float(&rng);
        struct picture out = render(c, &noise, &depth, &p);
        double beyond = 0;
        for (int i = 0; i < 3 * 1600; i++)
            beyond = worse(beyond, fabs(out.plane[i / 1600][i % 1600] - 0.5) - 0.5);
        CHECK_MSG(beyond <= 0x1p-23, "%s: picture %d: noise leaves its range by %g", isa, n, beyond);
        picture_free(&out);
        picture_free(&radius);
        picture_free(&noise);
        picture_free(&image);
    }
}

// ---- what may change no bit

static struct picture shape_image;

static struct hf_params random_params(struct rng *rng, struct hf_image *aperture)
{
    struct hf_params p = params_new();
    static const float radii[] = {1, 3, 8, 12, 17, 26, 40, 70};
    p.max_radius = radii[rng_below(rng, 8)];
    p.range.strength = rng_below(rng, 3) ? 1 : rng_range(rng, 0, 1);
    p.scatter.resolution = (enum hf_resolution)(rng_below(rng, 4) == 0);
    p.aperture.blades = rng_below(rng, 3) ? 0 : 3 + rng_below(rng, 14);
    p.aperture.rotation = (float)rng_below(rng, 90);
    p.aperture.roundness = rng_below(rng, 2) ? 0 : rng_float(rng);
    p.aperture.ring = rng_below(rng, 4) ? 0 : rng_range(rng, 0, 0.95f);
    p.aperture.chromatic = rng_below(rng, 4) ? 0 : rng_range(rng, -0.5f, 0.5f);
    p.aperture.cat_eye = rng_below(rng, 5) ? 0 : rng_float(rng);
    p.aperture.squeeze = rng_below(rng, 4) ? 1 : rng_range(rng, 0.5f, 2);
    p.view.pixel_aspect = rng_below(rng, 4) ? 1 : rng_range(rng, 0.6f, 2);
    if (aperture && rng_below(rng, 6) == 0) {
        *aperture = picture_image(&shape_image);
        p.aperture = (struct hf_aperture_params){
            .squeeze = p.aperture.squeeze, .chromatic = p.aperture.chromatic, .picture = aperture};
        p.max_radius = fminf(p.max_radius, 17);
    }
    return p;
}

// Skipping, threads, tiles, reused memory, fused or not.
static void same_bits(enum hf_isa isa, struct hf_context *scalar)
{
    static const int tiles[][2] = {{16, 16}, {16, 33}, {48, 17}, {0, 0}};
    struct hf_context *tiled[4];
    for (int i = 0; i < 4; i++)
        tiled[i] = context_new(isa, i + 1, tiles[i][0], tiles[i][1]);
    for (unsigned i = 0; i < (check_long() ? 100u : 40u); i++) {
        struct rng rng = rng_seed(seed + 1000 + i);
        const enum scene_kind kind = (enum scene_kind)rng_below(&rng, SCENE_KINDS);
        const int w = 1 + rng_below(&rng, i % 4 ? 60 : 210), h = 1 + rng_below(&rng, i % 4 ? 50 : 130);
        struct scene s = scene_new(&rng, kind, w, h, 3 + rng_below(&rng, 2));
        struct hf_image aperture;
        struct hf_params p = random_params(&rng, &aperture);
        for (int k = 0; k < w * h / 20; k++)
            s.colour.plane[rng_below(&rng, 3)][rng_below(&rng, w * h)] = rng_below(&rng, 2) ? -0.0f : -1e-3f;
        for (int k = 0; s.colour.channels == 4 && rng_below(&rng, 2) && k < w * h; k++)
            s.colour.plane[3][k] = 1;
        struct picture a = render_scene(tiled[i % 4], &s, &p);
        p.run.no_skip = 1;
        p.run.deterministic = 1;
        struct picture b = render_scene(scalar, &s, &p);
        CHECK_MSG(picture_same_bits(&a, &b),
                  "%s: seed %u, %s %d x %d, tiles %d: other bits (radius %g, half %d, blades %d, "
                  "ring %g, chromatic %g, cat's eye %g, image %d)",
                  hf_isa_name(isa), seed + 1000 + i, scene_name(kind), w, h, i % 4, p.max_radius, p.scatter.resolution,
                  p.aperture.blades, p.aperture.ring, p.aperture.chromatic, p.aperture.cat_eye,
                  p.aperture.picture != NULL);
        picture_free(&a);
        picture_free(&b);
        scene_free(&s);
    }
    for (int i = 0; i < 4; i++)
        hf_close(&tiled[i]);
}

static void moved(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 24; i++) {
        struct rng rng = rng_seed(seed + 2000 + i);
        const enum scene_kind kind = i % 2 ? SCENE_BLOCKS : SCENE_HIGHLIGHTS;
        struct scene s = scene_new(&rng, kind, 2 * (70 + rng_below(&rng, 30)), 2 * (60 + rng_below(&rng, 10)), 3);
        struct hf_params p = random_params(&rng, NULL);
        p.max_radius = fminf(p.max_radius, 30);
        p.view.pixel_aspect = fmaxf(p.view.pixel_aspect, 1);
        p.aperture.squeeze = fmaxf(p.aperture.squeeze, 1);
        p.aperture.blades = 0;
        struct scene mirror = {picture_flipped(&s.colour), picture_flipped(&s.depth)};
        struct picture a = render_scene(c, &s, &p), b = render_scene(c, &mirror, &p), back = picture_flipped(&b);
        CHECK_MSG(picture_same_bits(&a, &back),
                  "%s: seed %u: flipping gives other bits (radius %g, half %d, cat's eye %g)", isa, seed + 2000 + i,
                  p.max_radius, p.scatter.resolution, p.aperture.cat_eye);
        picture_free(&b);
        picture_free(&back);
        scene_free(&mirror);
        picture_free(&a);

        // A crop, inside by the reach of sources, their means and mixed pixels. The cat's eye depends on a pixel's
        // place.
        p.aperture.cat_eye = 0;
        a = render_scene(c, &s, &p);
        const int x0 = 2 * rng_below(&rng, 10), y0 = 2 * rng_below(&rng, 10);
        const int w = 118 + rng_below(&rng, 2), h = 98 + rng_below(&rng, 2),
                  m = 2 * ((int)ceilf(p.max_radius * 0.75f) + 3 + 2);
        struct scene part = {picture_cut(&s.colour, x0, y0, w, h), picture_cut(&s.depth, x0, y0, w, h)};
        b = render_scene(c, &part, &p);
        if (w > 2 * m && h > 2 * m) {
            struct picture want = picture_cut(&a, x0 + m, y0 + m, w - 2 * m, h - 2 * m),
                           got = picture_cut(&b, m, m, w - 2 * m, h - 2 * m);
            CHECK_MSG(picture_same_bits(&want, &got), "%s: seed %u: a crop has other bits (radius %g, half %d)", isa,
                      seed + 2000 + i, p.max_radius, p.scatter.resolution);
            picture_free(&want);
            picture_free(&got);
        }
        picture_free(&b);

        const float scale = ldexpf(1, (int)(i % 5) * 12 - 24);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < a.width * a.height; j++) {
                s.colour.plane[k][j] *= scale;
                a.plane[k][j] *= scale;
            }
        b = render_scene(c, &s, &p);
        CHECK_MSG(picture_same_bits(&a, &b), "%s: seed %u: exposure x %g gives other bits", isa, seed + 2000 + i,
                  scale);
        picture_free(&a);
        picture_free(&b);
        scene_free(&part);
        scene_free(&s);
    }
}

// ---- hard cases

// A constant stays constant, within 16 roundings, and no result leaves the input's range.
static void constants(struct hf_context *c, const char *isa)
{
    for (unsigned i = 0; i < 30; i++) {
        struct rng rng = rng_seed(seed + 3000 + i);
        struct hf_image aperture;
        struct hf_params p = random_params(&rng, &aperture);
        struct scene s =
            scene_new(&rng, (enum scene_kind)(i % SCENE_KINDS), 40 + rng_below(&rng, 60), 30 + rng_below(&rng, 40), 4);
        float low[4], high[4];
        double worst = 0;
        for (int round = 0; round < 2; round++) {
            for (int k = 0; k < 4; k++) {
                low[k] = FLT_MAX;
                high[k] = -FLT_MAX;
                const float v = rng_range(&rng, 0.1f, 3);
                for (int j = 0; j < s.colour.width * s.colour.height; j++) {
                    if (round)
                        s.colour.plane[k][j] = v;
                    low[k] = fminf(low[k], s.colour.plane[k][j]);
                    high[k] = fmaxf(high[k], s.colour.plane[k][j]);
                }
            }
            struct picture a = render_scene(c, &s, &p);
            for (int k = 0; k < 4; k++)
                for (int j = 0; j < a.width * a.height; j++) {
                    const double v = a.plane[k][j], span = fmax(fabs((double)low[k]), fabs((double)high[k]));
                    worst = worse(worst, fmax(low[k] - v, v - high[k]) / span);
                }
            picture_free(&a);
        }
        CHECK_MSG(worst <= 16 * U, "%s: seed %u: %g U outside the range of the input", isa, seed + 3000 + i, worst / U);
        scene_free(&s);
    }
}

static void extremes(struct hf_context *c, const char *isa)
{
    static const int sizes[][2] = {{1, 1}, {1, 40}, {40, 1}, {2, 2}, {3, 5}, {16, 16}, {17, 15}, {33, 31}, {4001, 2}};
    static const float strange[] = {NAN, INFINITY, -INFINITY, 1e-40f, -3, 65504, 1e30f, -0.0f};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int half = 0; half < 2; half++) {
            struct rng rng = rng_seed(seed + 4000 + (unsigned)i);
            const int w = sizes[i][0], h = sizes[i][1];
            struct scene s = scene_new(&rng, SCENE_NOISE, w, h, 4);
            for (int k = 0; k < w * h; k++) {
                s.colour.plane[rng_below(&rng, 4)][rng_below(&rng, w * h)] = strange[rng_below(&rng, 8)];
                s.depth.plane[0][k] = rng_range(&rng, -1, 1) * (k % 3 ? 30 : 3000);
                if (rng_below(&rng, 9) == 0)
                    s.depth.plane[0][k] = NAN;
            }
            struct hf_depth depth = picture_depth(&s.depth);
            depth.type = HF_DEPTH_COC;
            struct hf_params p = params_new();
            p.max_radius = HF_DERIVE;
            p.scatter.resolution = (enum hf_resolution)half;
            struct picture a = render(c, &s.colour, &depth, &p);
            int bad = 0;
            for (int k = 0; k < 4; k++)
                for (int j = 0; j < w * h; j++)
                    bad += !isfinite(a.plane[k][j]);
            CHECK_MSG(!bad, "%s: %d x %d: %d samples are not finite", isa, w, h, bad);
            // In place gives the same.
            CHECK_INT(try_render(c, &s.colour, &s.colour, &depth, &p), HF_OK);
            CHECK_MSG(picture_same_bits(&a, &s.colour), "%s: %d x %d: in place gives other bits", isa, w, h);
            picture_free(&a);
            scene_free(&s);
        }
}

// A near wall before a sharp floor melts: half covered at its silhouette, less and less outside, nothing beyond its
// reach.
static void melting(struct hf_context *c, const char *isa)
{
    static const float radii[] = {3, 10, 20, 40};
    for (int i = 0; i < 4; i++) {
        const int w = 260, h = 260, edge = 130;
        struct picture colour = picture_new(w, h, 3), coc = picture_new(w, h, 1);
        for (int j = 0; j < w * h; j++) {
            coc.plane[0][j] = j % w < edge ? -radii[i] : 0;
            for (int k = 0; k < 3; k++)
                colour.plane[k][j] = j % w < edge ? 1 : 0;
        }
        struct hf_depth depth = picture_depth(&coc);
        depth.type = HF_DEPTH_COC;
        struct hf_params p = params_new();
        p.max_radius = HF_DERIVE;
        struct picture a = render(c, &colour, &depth, &p);
        const float *row = a.plane[0] + h / 2 * w;
        CHECK_MSG(fabsf(row[edge] - 0.5f) < 0.6f / radii[i], "%s: radius %g: %g at the silhouette", isa, radii[i],
                  row[edge]);
        for (int x = edge; x + 1 < w; x++)
            CHECK(row[x + 1] <= row[x]);
        CHECK(row[edge + (int)radii[i] + 3] == 0);
        // Its other sides are the picture's edges, where it stays fully covered.
        for (int x = 0; x < edge - (int)radii[i] - 2; x++)
            CHECK_MSG(a.plane[0][x] > 0.999f, "%s: radius %g: %g at the picture's edge", isa, radii[i], a.plane[0][x]);
        picture_free(&a);
        picture_free(&colour);
        picture_free(&coc);
    }
}

// An anti-aliased silhouette of a sharp object stays anti-aliased before a blurred background: each pixel shows of both
// sides what they cover. With the radius of only one side it would be off by up to half of their difference: stairs,
// 0.35 here. The error is what a side's mean takes from mixed neighbours: along a diagonal these weigh 2.45 sixteenths
// (two at 1, the rest at 1 / 4 and less), and the three un-mixed ones, 1.06 of 2 / 25 + 1 / 64, 0.10. So 0.6 of the
// mean is off, by less than half of 0.7.
static void silhouette(struct hf_context *c, const char *isa)
{
    const int w = 64, h = 64;
    const float front = 0.1f, back = 0.8f;
    struct picture colour = picture_new(w, h, 3), coc = picture_new(w, h, 1);
    for (int j = 0; j < w * h; j++) {
        const float x = (float)(j % w) - 31.3f, y = (float)(j / w) - 32.6f, off = 18.4f - sqrtf(x * x + y * y) + 0.5f;
        const float cover = fminf(fmaxf(off, 0), 1);
        for (int k = 0; k < 3; k++)
            colour.plane[k][j] = cover * front + (1 - cover) * back;
        coc.plane[0][j] = cover >= 0.5f ? 0 : 9;
    }
    struct hf_depth depth = picture_depth(&coc);
    depth.type = HF_DEPTH_COC;
    struct hf_params p = params_new();
    p.max_radius = HF_DERIVE;
    struct picture a = render(c, &colour, &depth, &p);
    const double worst = largest_difference(&a, &colour);
    printf("%s: a sharp silhouette is off by %.3f\n", isa, worst);
    CHECK_MSG(worst < 0.6 * 0.35, "%s: a sharp silhouette is off by %g", isa, worst);
    picture_free(&a);
    picture_free(&colour);
    picture_free(&coc);
}

// A focus pull: per pixel of radius no sample moves by more than a steady share of the largest one: all of it while a
// pixel goes from sharp to blurred, 0.034 a step, and twice a size's 0.4 %. Where surfaces meet, the mixed part changes
// by twice the change of its neighbours' radii, and that part of the pixel moves to another radius: 0.068 more.
static void focus_pull(struct hf_context *c, const char *isa)
{
    const int w = 96, h = 80, steps = 200;
    struct rng rng = rng_seed(seed);
    struct picture colour = picture_new(w, h, 3), coc = picture_new(w, h, 1), last = {0};
    for (int j = 0; j < w * h; j++)
        for (int k = 0; k < 3; k++)
            colour.plane[k][j] = rng_float(&rng);
    double worst = 0, mixed = 0;
    for (int i = 0; i < steps; i++) {
        const float offset = 0.02f * (float)i;
        for (int j = 0; j < w * h; j++)
            coc.plane[0][j] = (j % w < 40 ? -2 : j % w < 70 ? 0.1f : 24) + offset * (j / w < 40 ? 1 : 1.7f);
        struct hf_depth depth = picture_depth(&coc);
        depth.type = HF_DEPTH_COC;
        struct hf_params p = params_new();
        p.max_radius = HF_DERIVE;
        struct picture a = render(c, &colour, &depth, &p);
        for (int j = 0; j < w * h && i; j++) {
            const int x = j % w, y = j / w;
            double *most = abs(x - 40) < 3 || abs(x - 70) < 3 || abs(y - 40) < 3 ? &mixed : &worst;
            for (int k = 0; k < 3; k++)
                *most = worse(*most, fabs((double)a.plane[k][j] - last.plane[k][j]));
        }
        picture_free(&last);
        last = a;
    }
    printf("%s: focus pull: a step of 0.034 pixels changes no sample by more than %.3f, mixed ones %.3f\n", isa, worst,
           mixed);
    CHECK_MSG(worst < 0.042, "%s: a step of 0.034 pixels changes a sample by %g", isa, worst);
    CHECK_MSG(mixed < 0.11, "%s: a step of 0.034 pixels changes a mixed sample by %g", isa, mixed);
    picture_free(&last);
    picture_free(&colour);
    picture_free(&coc);
}

int main(int argc, char **argv)
{
    static const enum hf_isa isas[] = {HF_ISA_SCALAR, HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON};
    seed = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 0) : 1;
    printf("seed %u\n", seed);
    struct rng rng = rng_seed(seed);
    shape_image = picture_new(9, 7, 3);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 63; i++)
            shape_image.plane[k][i] = rng_float(&rng);
    struct hf_context *scalar = context_new(HF_ISA_SCALAR, 1, 0, 0);
    for (size_t i = 0; i < sizeof isas / sizeof *isas; i++) {
        if (!hf_isa_available(isas[i]))
            continue;
        same_bits(isas[i], scalar);
        // The remaining tests give the same bits everywhere: they run once in C, once on the best instruction set.
        if (isas[i] != HF_ISA_SCALAR && i + 1 < sizeof isas / sizeof *isas && hf_isa_available(isas[i + 1]))
            continue;
        struct hf_context *c = context_new(isas[i], 2, 0, 0);
        const char *name = hf_isa_name(isas[i]);
        against_reference(c, name);
        highlights(c, name);
        options(c, name);
        cut_off(c, name);
        rotation(c, name);
        moved(c, name);
        constants(c, name);
        extremes(c, name);
        melting(c, name);
        silhouette(c, name);
        focus_pull(c, name);
        hf_close(&c);
    }
    hf_close(&scalar);
    picture_free(&shape_image);
    return check_report();
}
