// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine: against a reference in double precision; its shape and energy; and that instruction sets,
// threads, tiles and skipping change nothing.
//
//     hexagon [seed]
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"
#include "support/reference_hexagon.h"

static const double U = FLT_EPSILON / 2;

// ---- rendering ----

static struct hf_params hexagon_params(void)
{
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_HEXAGON;
    p.max_radius = 9;
    return p;
}

// A line of n taps, four per place, rounds its sums of weights n times, and 2 n more for the products; radii and
// colours carry about 30 more through loading, dividing and upsampling. The divisor is at least a quarter, in each of
// two passes.
static double bound(const struct hf_params *p, double reach)
{
    const double taps = 4 * (reach + 4) / fmin(p->view.pixel_aspect, 1);
    return 2 * 4 * (3 * taps + 30) * U;
}

// Shares of mixed pixels are whole 2^-20ths, and may be off by one because of 16 times 50 roundings (scatter.c). Within
// a 32nd, a sample's weight and radius go from the pixel's own to the back's. Where radii differ by less than 0.75
// nothing is mixed.
static double bound_shares(const struct hf_params *p, const struct picture *r)
{
    float low = r->plane[0][0], high = low;
    for (int i = 0; i < r->width * r->height; i++) {
        low = fminf(low, r->plane[0][i]);
        high = fmaxf(high, r->plane[0][i]);
    }
    return high - low > 0.75f && !p->hexagon.resolution ? 32 * (0x1p-20 + 16 * 50 * U) : 0;
}

static struct picture rendered_in(struct hf_context *c, const struct picture *in, const struct hf_depth *depth,
                                  const struct hf_params *p)
{
    struct picture out = render(c, in, depth, p);
    hf_close(&c);
    return out;
}

static struct picture rendered(const struct picture *in, const struct hf_depth *depth, const struct hf_params *p)
{
    return rendered_in(context_new(HF_ISA_AUTO, 2, 0, 0), in, depth, p);
}

static struct picture rendered_isa(enum hf_isa isa, const struct picture *in, const struct hf_depth *depth,
                                   const struct hf_params *p)
{
    return rendered_in(context_new(isa, 1, 0, 0), in, depth, p);
}

static void random_radii(struct rng *rng, const struct scene *s, struct picture *r, double most)
{
    for (int i = 0; i < r->width * r->height; i++) {
        const double t = (s->depth.plane[0][i] - 20) / 10;
        r->plane[0][i] = (float)(most * fmax(-1, fmin(1, t == 0 || !isfinite(t) ? 0 : t + 0 * rng_float(rng))));
    }
}

static void random_options(struct rng *rng, struct hf_params *p)
{
    p->hexagon.resolution = rng_below(rng, 2) ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
    p->aperture.rotation = rng_below(rng, 2) ? 0 : rng_range(rng, -180, 180);
    p->view.pixel_aspect = rng_below(rng, 3) ? 1 : rng_range(rng, 0.4f, 2.5f);
    p->max_radius = HF_DERIVE;
}

static void test_reference(struct rng *rng)
{
    for (int i = 0; i < 60; i++) {
        const int channels = 3 + rng_below(rng, 2);
        struct scene s = scene_new(rng, (enum scene_kind)(i % SCENE_KINDS), 1 + rng_below(rng, 70),
                                   1 + rng_below(rng, 50), channels);
        struct picture r = picture_new(s.colour.width, s.colour.height, 1);
        struct hf_params p = hexagon_params();
        random_options(rng, &p);
        const double reach = rng_range(rng, 0.2f, rng_below(rng, 4) ? 8 : 30);
        random_radii(rng, &s, &r, reach);
        const struct hf_depth depth = picture_radii(&r);
        struct picture want = hexagon_reference(&s.colour, &r, &p);
        for (p.run.deterministic = 0; p.run.deterministic < 2; p.run.deterministic++) {
            struct picture got = rendered(&s.colour, &depth, &p);
            const double d = largest_difference(&got, &want);
            const double most = (bound(&p, reach) + bound_shares(&p, &r)) * largest_sample(&s.colour);
            CHECK_MSG(d <= most, "frame %d, %s, %d x %d, %s, rotation %g, aspect %g, radius %g: off by %g of %g", i,
                      scene_name((enum scene_kind)(i % SCENE_KINDS)), s.colour.width, s.colour.height,
                      p.hexagon.resolution ? "half" : "full", p.aperture.rotation, p.view.pixel_aspect, reach, d, most);
            picture_free(&got);
        }
        picture_free(&want);
        picture_free(&r);
        scene_free(&s);
    }
}

// ---- equal bits ----

static void test_same_bits(struct rng *rng)
{
    static const enum hf_isa isas[] = {HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON};
    for (int i = 0; i < 40; i++) {
        struct scene s = scene_new(rng, (enum scene_kind)(i % SCENE_KINDS), 1 + rng_below(rng, 200),
                                   1 + rng_below(rng, 120), 3 + rng_below(rng, 2));
        struct hf_params p = hexagon_params();
        random_options(rng, &p);
        p.max_radius = rng_range(rng, 0.3f, 20);
        p.hexagon.uniform = rng_below(rng, 6) == 0;
        const struct hf_depth depth = picture_depth(&s.depth);
        struct picture fused = rendered_isa(HF_ISA_AUTO, &s.colour, &depth, &p);
        p.run.no_skip = 1;
        struct picture all = rendered_isa(HF_ISA_AUTO, &s.colour, &depth, &p);
        CHECK_MSG(picture_same_bits(&fused, &all), "frame %d: skipping shows", i);
        picture_free(&all);
        p.run.no_skip = 0;
        const int tile_width = 16 * (1 + rng_below(rng, 4)), tile_height = 16 + rng_below(rng, 30);
        struct hf_context *c = context_new(HF_ISA_AUTO, 3, tile_width, tile_height);
        all = render(c, &s.colour, &depth, &p);
        CHECK_MSG(picture_same_bits(&fused, &all), "frame %d: tiles of %d x %d show", i, tile_width, tile_height);
        picture_free(&all);
        all = picture_copy(&s.colour);
        CHECK_INT(try_render(c, &all, &all, &depth, &p), HF_OK);
        CHECK_MSG(picture_same_bits(&fused, &all), "frame %d: not the same in place", i);
        hf_close(&c);
        picture_free(&all);
        p.run.deterministic = 1;
        struct picture plain = rendered_isa(HF_ISA_SCALAR, &s.colour, &depth, &p);
        CHECK_MSG(largest_difference(&fused, &plain) <= bound(&p, p.max_radius) * largest_sample(&s.colour),
                  "frame %d: fused is off by %g", i, largest_difference(&fused, &plain));
        for (int k = 0; k < 4; k++) {
            if (!hf_isa_available(isas[k]))
                continue;
            all = rendered_isa(isas[k], &s.colour, &depth, &p);
            CHECK_MSG(picture_same_bits(&plain, &all), "frame %d: %s is not the C", i, hf_isa_name(isas[k]));
            picture_free(&all);
        }
        picture_free(&plain);
        picture_free(&fused);
        scene_free(&s);
    }
}

// ---- shape and energy ----

static struct picture filled(int width, int height, int channels, float value)
{
    struct picture p = picture_new(width, height, channels);
    for (int c = 0; c < channels; c++)
        for (int i = 0; i < width * height; i++)
            p.plane[c][i] = value;
    return p;
}

// Whether (x, y) is in the hexagon of side s with a corner up, turned by that many degrees.
static int in_hexagon(double x, double y, double s, double degrees)
{
    for (int i = 0; i < 6; i++) {
        const double angle = (degrees + 60 * i) * M_PI / 180;
        if (x * cos(angle) + y * sin(angle) > s * sqrt(3) / 2)
            return 0;
    }
    return 1;
}

// One highlight in a picture of one radius: check its energy, its area and its outline.
static void test_highlight(float radius, float degrees, enum hf_resolution resolution, int uniform)
{
    enum { N = 121 };
    struct picture in = filled(N, N, 3, 0), r = filled(N, N, 1, radius);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 4; k++)
            in.plane[c][(60 + k / 2) * N + 60 + k % 2] = 1e4f;
    struct hf_params p = hexagon_params();
    p.max_radius = fabsf(radius);
    p.aperture.rotation = degrees;
    p.hexagon.resolution = resolution;
    p.hexagon.uniform = uniform;
    const struct hf_depth depth = picture_radii(&r);
    struct picture out = rendered(&in, &depth, &p);
    double sum = 0, inside = 0, wrong = 0;
    // The last place of a line lies up to 0.6 beyond its end; the pixels around a place lie up to sqrt(2) beside it,
    // those of the square 0.7 beside its middle: 4.1. At half resolution all except the last count twice, and
    // upsampling adds 2.1.
    const double s = fabs(radius), soft = resolution == HF_RESOLUTION_HALF ? 9 : 4.1;
    const double flat = 4e4 / (1.5 * sqrt(3) * s * s);
    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++) {
            const double v = out.plane[0][y * N + x], dx = x - 60.5, dy = y - 60.5;
            sum += v;
            if (in_hexagon(dx, dy, s - soft, degrees)) {
                inside++;
                wrong = fmax(wrong, fabs(v / flat - 1));
            } else if (!in_hexagon(dx, dy, s + soft, degrees)) {
                CHECK_MSG(v == 0, "radius %g, %s: light %g at (%g, %g)", radius, resolution ? "half" : "full", v / flat,
                          dx, dy);
            }
        }
    // Each pixel rounds as often as bound() says, and their errors are independent.
    CHECK_MSG(fabs(sum / 4e4 - 1) <= 1e-5, "radius %g, %g degrees: energy %.8g of 1", radius, degrees, sum / 4e4);
    // The rhombi's seams and bilinear taps make a square of 2 x 2 somewhat uneven.
    CHECK_MSG(wrong < 0.4 && inside > 0, "radius %g, %g degrees, %s: uneven by %g", radius, degrees,
              resolution ? "half" : "full", wrong);
    picture_free(&out);
    picture_free(&in);
    picture_free(&r);
}

static void test_shape(void)
{
    static const float turns[] = {0, 30, 15, 90, -7.5f};
    for (int i = 0; i < 5; i++)
        for (int half = 0; half < 2; half++) {
            test_highlight(14, turns[i], (enum hf_resolution)half, 0);
            test_highlight(-14, turns[i], (enum hf_resolution)half, 0);
            test_highlight(20.4f, turns[i], (enum hf_resolution)half, 1);
        }
}

static void test_constant(struct rng *rng)
{
    for (int i = 0; i < 30; i++) {
        struct scene s =
            scene_new(rng, (enum scene_kind)(i % SCENE_KINDS), 1 + rng_below(rng, 90), 1 + rng_below(rng, 60), 4);
        struct picture in = filled(s.colour.width, s.colour.height, 4, rng_range(rng, 0.1f, 100));
        struct hf_params p = hexagon_params();
        random_options(rng, &p);
        p.max_radius = rng_range(rng, 0.5f, 12);
        const struct hf_depth depth = picture_depth(&s.depth);
        struct picture out = rendered(&in, &depth, &p);
        const double d = largest_difference(&in, &out), most = bound(&p, p.max_radius) * in.plane[0][0];
        CHECK_MSG(d <= most, "frame %d: a constant picture is off by %g of %g", i, d, most);
        picture_free(&out);
        picture_free(&in);
        scene_free(&s);
    }
}

// ---- invariances ----

static struct picture crop(const struct picture *p, int x0, int y0, int w, int h)
{
    struct picture out = picture_new(w, h, p->channels);
    for (int c = 0; c < p->channels; c++)
        for (int y = 0; y < h; y++)
            memcpy(out.plane[c] + y * w, p->plane[c] + (y + y0) * p->width + x0, sizeof(float) * (size_t)w);
    return out;
}

static void test_invariance(struct rng *rng)
{
    for (int i = 0; i < 8; i++) {
        struct scene s = scene_new(rng, (enum scene_kind)(i % SCENE_KINDS), 160, 140, 3);
        struct hf_params p = hexagon_params();
        p.max_radius = 6;
        p.hexagon.resolution = (enum hf_resolution)(i % 2);
        struct hf_depth depth = picture_depth(&s.depth);
        struct picture whole = rendered(&s.colour, &depth, &p);
        // A crop with a margin of the reach: two lines, their bilinear neighbours, and upsampling.
        const int margin = 24, x0 = 2 * rng_below(rng, 20), y0 = 2 * rng_below(rng, 20);
        struct picture part = crop(&s.colour, x0, y0, 110, 96), z = crop(&s.depth, x0, y0, 110, 96);
        depth = picture_depth(&z);
        struct picture out = rendered(&part, &depth, &p);
        struct picture a = crop(&whole, x0 + margin, y0 + margin, 110 - 2 * margin, 96 - 2 * margin);
        struct picture b = crop(&out, margin, margin, 110 - 2 * margin, 96 - 2 * margin);
        CHECK_MSG(picture_same_bits(&a, &b), "frame %d: the part at (%d, %d) differs", i, x0, y0);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 160 * 140; k++)
                s.colour.plane[c][k] *= 64;
        depth = picture_depth(&s.depth);
        struct picture bright = rendered(&s.colour, &depth, &p);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 160 * 140; k++)
                bright.plane[c][k] /= 64;
        CHECK_MSG(picture_same_bits(&bright, &whole), "frame %d: 64 times as bright is not 64 times the result", i);
        picture_free(&bright);
        picture_free(&a);
        picture_free(&b);
        picture_free(&out);
        picture_free(&part);
        picture_free(&z);
        picture_free(&whole);
        scene_free(&s);
    }
}

// If radii change by e, a sample's share changes by about e on each of two lines: by no more than a few e per pixel of
// radius.
static void test_no_popping(struct rng *rng)
{
    for (int i = 0; i < 24; i++) {
        struct scene s = scene_new(rng, i % 3 == 0 ? SCENE_RAMP : i % 3 == 1 ? SCENE_BLOCKS : SCENE_NOISE, 60, 44, 3);
        struct picture r = picture_new(60, 44, 1), moved = picture_new(60, 44, 1);
        const float e = 0x1p-10f;
        random_radii(rng, &s, &r, 6);
        // A focus pull moves all radii equally; every other time through the focus, down to where rounding starts.
        for (int k = 0; k < 60 * 44; k++) {
            r.plane[0][k] += i % 2 ? rng_range(rng, -2, 2) : -e / 2;
            moved.plane[0][k] = r.plane[0][k] + e;
        }
        struct hf_params p = hexagon_params();
        p.max_radius = HF_DERIVE;
        p.hexagon.resolution = (enum hf_resolution)(i / 2 % 2);
        struct hf_depth depth = picture_radii(&r);
        struct picture a = rendered(&s.colour, &depth, &p);
        depth = picture_radii(&moved);
        struct picture b = rendered(&s.colour, &depth, &p);
        const double rate = largest_difference(&a, &b) / e / largest_sample(&s.colour);
        CHECK_MSG(rate < 40, "frame %d, %s: the picture changes by %g per pixel of radius", i,
                  p.hexagon.resolution ? "half" : "full", rate);
        picture_free(&a);
        picture_free(&b);
        picture_free(&r);
        picture_free(&moved);
        scene_free(&s);
    }
}

// ---- parameters, hard cases ----

static void test_parameters(struct rng *rng)
{
    struct scene s = scene_new(rng, SCENE_HIGHLIGHTS, 90, 70, 3);
    const struct hf_depth depth = picture_depth(&s.depth);
    const struct hf_params plain = hexagon_params();
    struct picture base = rendered(&s.colour, &depth, &plain);
    struct hf_params changed[8];
    for (int i = 0; i < 8; i++)
        changed[i] = plain;
    changed[0].aperture.rotation = 20;
    changed[1].hexagon.resolution = HF_RESOLUTION_HALF;
    changed[2].hexagon.uniform = 1;
    changed[3].max_radius = 5;
    changed[4].view.pixel_aspect = 2;
    changed[5].range.strength = 0.5f;
    changed[6].focus = 15;
    changed[7].range.blend = HF_BLEND_SMOOTHSTEP;
    for (int i = 0; i < 8; i++) {
        struct picture out = rendered(&s.colour, &depth, &changed[i]);
        CHECK_MSG(!picture_same_bits(&out, &base), "parameter %d has no effect", i);
        picture_free(&out);
    }
    // The limit for a lens, whose radii have no limit of their own; a limit that no radius reaches changes nothing.
    struct hf_params lens = plain;
    lens.model = HF_MODEL_LENS;
    lens.lens.f_number = 0.02f;
    struct picture open[3];
    for (int i = 0; i < 3; i++) {
        lens.max_radius = i == 0 ? HF_DERIVE : i == 1 ? 250 : 2;
        open[i] = rendered(&s.colour, &depth, &lens);
    }
    CHECK(picture_same_bits(&open[0], &open[1]));
    CHECK(!picture_same_bits(&open[0], &open[2]));
    for (int i = 0; i < 3; i++)
        picture_free(&open[i]);
    // Default values, and options of other engines, change nothing.
    struct hf_params same[6];
    for (int i = 0; i < 6; i++)
        same[i] = plain;
    same[0].aperture.rotation = 0;
    same[1].view.pixel_aspect = 1;
    same[2].aperture.blades = 6;
    same[3].gaussian.iterations = 7;
    same[4].gaussian.sigma = 3;
    same[5].hexagon.resolution = HF_RESOLUTION_FULL;
    for (int i = 0; i < 6; i++) {
        struct picture out = rendered(&s.colour, &depth, &same[i]);
        CHECK_MSG(picture_same_bits(&out, &base), "parameter %d has an effect at its default", i);
        picture_free(&out);
    }
    // A sixth of a turn gives the same shape, but other bilinear taps; without a radius nothing changes.
    struct hf_params none = plain;
    none.range.strength = 0;
    struct picture out = rendered(&s.colour, &depth, &none);
    CHECK(picture_same_bits(&out, &s.colour));
    picture_free(&out);
    none = plain;
    none.max_radius = 0;
    out = rendered(&s.colour, &depth, &none);
    CHECK(picture_same_bits(&out, &s.colour));
    picture_free(&out);
    picture_free(&base);
    scene_free(&s);
}

// Where the radius is 0 and nothing reaches, the result has the input's bits, even -0.
static void test_sharp(void)
{
    struct picture in = filled(64, 48, 3, -0.0f), r = filled(64, 48, 1, 0);
    r.plane[0][20 * 64 + 10] = -3;
    r.plane[0][20 * 64 + 50] = 5;
    struct hf_params p = hexagon_params();
    for (int half = 0; half < 2; half++) {
        p.hexagon.resolution = (enum hf_resolution)half;
        p.run.no_skip = 1;
        const struct hf_depth depth = picture_radii(&r);
        struct picture out = rendered(&in, &depth, &p);
        for (int y = 0; y < 48; y++)
            for (int x = 0; x < 64; x++) {
                const int clear = abs(x - 10) > 12 || abs(y - 20) > 12;
                if (clear && !(x == 50 && y == 20))
                    CHECK_MSG(signbit(out.plane[0][y * 64 + x]), "(%d, %d) lost its sign", x, y);
            }
        picture_free(&out);
    }
    picture_free(&in);
    picture_free(&r);
}

// The largest numbers of both signs: no sum of them overflows, and a constant stays constant.
static void test_largest(struct rng *rng)
{
    static const enum hf_isa isas[] = {HF_ISA_SCALAR, HF_ISA_AUTO};
    for (int i = 0; i < 48; i++) {
        struct scene s =
            scene_new(rng, (enum scene_kind)(i % SCENE_KINDS), 40 + rng_below(rng, 60), 30 + rng_below(rng, 40), 3);
        const int same = i / 4 % 2;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < s.colour.width * s.colour.height; k++)
                s.colour.plane[c][k] = same || rng_below(rng, 2) ? FLT_MAX : rng_below(rng, 2) ? -3e38f : 3e38f;
        struct hf_params p = hexagon_params();
        random_options(rng, &p);
        p.max_radius = i % 3 ? 12 : 40;
        p.hexagon.uniform = i % 8 == 5;
        const struct hf_depth depth = picture_depth(&s.depth);
        struct picture out = rendered_isa(isas[i % 2], &s.colour, &depth, &p);
        int wrong = 0;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < out.width * out.height; k++)
                wrong += !isfinite(out.plane[c][k]) ||
                         (same && !(fabs(out.plane[c][k] / (double)FLT_MAX - 1) <= bound(&p, p.max_radius)));
        CHECK_MSG(wrong == 0, "frame %d: %d samples are infinite or not what all are", i, wrong);
        picture_free(&out);
        scene_free(&s);
    }
}

static void test_sizes(struct rng *rng)
{
    static const int sizes[][2] = {{1, 1}, {1, 40}, {40, 1}, {2, 2}, {3, 5}, {15, 17}, {16, 16}, {33, 7}};
    static const float reaches[] = {1, 12, 300, 2048};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 4; k++) {
            struct scene s = scene_new(rng, SCENE_NOISE, sizes[i][0], sizes[i][1], 3);
            struct picture r = picture_new(sizes[i][0], sizes[i][1], 1);
            random_radii(rng, &s, &r, reaches[k]);
            s.colour.plane[0][0] = NAN;
            s.colour.plane[1][sizes[i][0] * sizes[i][1] - 1] = -INFINITY;
            struct hf_params p = hexagon_params();
            p.max_radius = HF_DERIVE;
            p.hexagon.resolution = (enum hf_resolution)(k % 2);
            const struct hf_depth depth = picture_radii(&r);
            struct picture out = rendered(&s.colour, &depth, &p);
            double low = 0, high = 0;
            for (int c = 0; c < 3; c++)
                for (int at = 0; at < out.width * out.height; at++) {
                    CHECK(isfinite(out.plane[c][at]));
                    low = fmin(low, out.plane[c][at]);
                    high = fmax(high, out.plane[c][at]);
                }
            CHECK_MSG(low >= 0 && high <= 1.3 * 1.001, "%d x %d: values from %g to %g", out.width, out.height, low,
                      high);
            picture_free(&out);
            picture_free(&r);
            scene_free(&s);
        }
}

int main(int argc, char **argv)
{
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    printf("seed %llu\n", (unsigned long long)seed);
    struct rng rng = rng_seed(seed);
    test_reference(&rng);
    test_same_bits(&rng);
    test_shape();
    test_constant(&rng);
    test_invariance(&rng);
    test_no_popping(&rng);
    test_parameters(&rng);
    test_sharp();
    test_largest(&rng);
    test_sizes(&rng);
    return check_report();
}
