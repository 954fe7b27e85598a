// SPDX-License-Identifier: BSD-3-Clause
// The scatter engine: samples of very different brightness. None changes a bit beyond its own reach, and samples that
// meet keep their own accuracy. On one instruction set: the others have the same bits (scatter.c).
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/check.h"
#include "support/render.h"

enum { WIDTH = 128, HEIGHT = 90, PIXELS = WIDTH * HEIGHT, X = 100, Y = 30, RADIUS = 9, HALVES = 2 };
// The sprite's last pixel, the neighbours of its mean at half resolution, and those of the upsampling.
enum { REACH = RADIUS + 7 };

static const double U = FLT_EPSILON / 2;
static const float values[] = {300, 65504, 1e9f, 1e12f, 1e20f, 1e30f, FLT_MAX};
enum { VALUES = sizeof values / sizeof *values };

// Colours of six decades, everything blurred, near and far beside each other.
static struct scene stage(int channels)
{
    struct rng rng = rng_seed(5);
    struct scene s = {picture_new(WIDTH, HEIGHT, channels), picture_new(WIDTH, HEIGHT, 1)};
    for (int k = 0; k < PIXELS; k++) {
        for (int c = 0; c < channels; c++)
            s.colour.plane[c][k] = powf(10, rng_range(&rng, -5, 1));
        s.depth.plane[0][k] = k % WIDTH < 40 ? -rng_range(&rng, 0.6f, RADIUS) : rng_range(&rng, 0.6f, RADIUS);
    }
    // Lights stand on surfaces: in a mixed pixel all channels have the same share.
    for (int i = 0; i < 4; i++) {
        const int x = i ? 20 + 30 * (i - 1) : X, y = i ? Y + 45 : Y, at = y * WIDTH + x;
        for (int k = 0; k < PIXELS; k++)
            if (abs(k % WIDTH - x) <= 4 && abs(k / WIDTH - y) <= 4)
                s.depth.plane[0][k] = s.depth.plane[0][at];
    }
    return s;
}

static int is_far_off(int k)
{
    const int dx = k % WIDTH - X, dy = k / WIDTH - Y;
    return dx < -REACH || dx > REACH || dy < -REACH || dy > REACH;
}

// Count the samples that differ away from (X, Y), in channels `from` to `to`.
static int changed(const struct picture *a, const struct picture *b, int from, int to)
{
    int n = 0;
    for (int c = from; c < to; c++)
        for (int k = 0; k < PIXELS; k++)
            n += is_far_off(k) && memcmp(&a->plane[c][k], &b->plane[c][k], sizeof(float));
    return n;
}

// One bright sample, in front of the focus or behind it.
static void far_off(struct hf_context *c, int half)
{
    struct scene s = stage(4);
    struct picture calm = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
    for (int i = 0; i < VALUES; i++)
        for (int ch = 0; ch < 4; ch++) {
            const int at = Y * WIDTH + X;
            const float old = s.colour.plane[ch][at];
            s.colour.plane[ch][at] = values[i];
            struct picture out = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
            CHECK_MSG(!changed(&calm, &out, 0, 4), "half %d, %g in channel %d: %d samples beyond its reach changed",
                      half, (double)values[i], ch, changed(&calm, &out, 0, 4));
            int bad = 0, other = 0;
            for (int k = 0; k < 4; k++)
                for (int j = 0; j < PIXELS; j++) {
                    bad += !isfinite(out.plane[k][j]);
                    // Alpha has sums of its own, and other channels have those of their brightness.
                    other += k != ch && memcmp(&out.plane[k][j], &calm.plane[k][j], sizeof(float));
                }
            CHECK_MSG(!bad, "half %d, %g: %d samples are not finite", half, (double)values[i], bad);
            CHECK_MSG(!other, "half %d, %g in channel %d: %d samples of other channels changed", half,
                      (double)values[i], ch, other);
            s.colour.plane[ch][at] = old;
            picture_free(&out);
        }
    picture_free(&calm);
    scene_free(&s);
}

// The faintest samples that are drawn: barely existing holes of rings, and barely blurred pixels.
static void faintest(struct hf_context *c, int half)
{
    static const float rings[] = {0, 0.05f, 0.3f}, values_beside[] = {1e-42f, 65504, 1e30f, FLT_MAX};
    for (int i = 0; i < 3; i++) {
        struct scene s = stage(4);
        for (int k = 0; k < PIXELS; k++) {
            const float r = s.depth.plane[0][k] / RADIUS, least = nextafterf(0.5f, 1);
            s.depth.plane[0][k] = copysignf(k % 3 ? least + 0.5f * r * r : least, r);
        }
        const struct hf_depth depth = picture_radii(&s.depth);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_SCATTER;
        p.scatter.resolution = half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
        p.aperture.ring = rings[i];
        struct picture calm = render(c, &s.colour, &depth, &p);
        for (int k = 0; k < 4; k++) {
            for (int ch = 0; ch < 4; ch++)
                s.colour.plane[ch][Y * WIDTH + X] = values_beside[k];
            struct picture out = render(c, &s.colour, &depth, &p);
            CHECK_MSG(!changed(&calm, &out, 0, 4), "half %d, ring %g, %g: %d samples beyond its reach changed", half,
                      (double)rings[i], (double)values_beside[k], changed(&calm, &out, 0, 4));
            picture_free(&out);
        }
        picture_free(&calm);
        scene_free(&s);
    }
}

// Lights of all kinds at once, far from each other: around each the result is as if it were alone.
static void many(struct hf_context *c, int half)
{
    struct scene s = stage(3);
    struct picture calm = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
    for (int i = 0; i < 3; i++)
        s.colour.plane[0][(Y + 45) * WIDTH + 20 + 30 * i] = values[i + 1];
    struct picture without = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
    s.colour.plane[0][Y * WIDTH + X] = 1e9f;
    struct picture with = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
    CHECK_MSG(!changed(&without, &with, 0, 3), "half %d: %d samples beyond a light's reach changed", half,
              changed(&without, &with, 0, 3));
    int other = 0;
    for (int k = 0; k < PIXELS; k++)
        other += k / WIDTH < Y + 45 - REACH && memcmp(&without.plane[1][k], &calm.plane[1][k], sizeof(float));
    CHECK_INT(other, 0);
    picture_free(&calm);
    picture_free(&without);
    picture_free(&with);
    scene_free(&s);
}

// A light beside a constant, one radius everywhere: beyond the light's reach the result is the constant within 16
// roundings, as in a frame without the light, and so is alpha everywhere.
static void beside_constant(struct hf_context *c, int half)
{
    for (int i = 0; i < VALUES; i++) {
        struct picture colour = picture_new(WIDTH, HEIGHT, 4), radius = picture_new(WIDTH, HEIGHT, 1);
        for (int ch = 0; ch < 4; ch++)
            picture_fill(&colour, ch, ch == 3 ? 0.6f : 0.35f);
        picture_fill(&radius, 0, RADIUS);
        for (int ch = 0; ch < 3; ch++)
            colour.plane[ch][Y * WIDTH + X] = values[i];
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radius, half);
        double worst = 0, alpha = 0;
        for (int k = 0; k < PIXELS; k++) {
            for (int ch = 0; ch < 3 && is_far_off(k); ch++)
                worst = worse(worst, fabs(out.plane[ch][k] / 0.35 - (double)(0.35f / 0.35)));
            alpha = worse(alpha, fabs(out.plane[3][k] / 0.6 - (double)(0.6f / 0.6)));
        }
        CHECK_MSG(worst <= 16 * U, "half %d, %g: a constant beside it is %g off", half, (double)values[i], worst);
        CHECK_MSG(alpha <= 16 * U, "half %d, %g: alpha is %g off", half, (double)values[i], alpha);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// A light that is barely blurred: the drawn part may have any brightness down to 0, and all of its energy is in the
// result.
static void faded(struct hf_context *c, int half)
{
    static const float radii[] = {0.5001f, 0.501f, 0.51f, 0.55f, 0.7f, 1, 1.4f, -0.51f, -0.7f};
    for (int i = 0; i < 9 * VALUES; i++) {
        struct picture colour = picture_new(WIDTH, HEIGHT, 3), radius = picture_new(WIDTH, HEIGHT, 1);
        const float v = fminf(values[i / 9], 1e30f);
        double sum = 0;
        for (int ch = 0; ch < 3; ch++)
            picture_fill(&colour, ch, 0.35f);
        picture_fill(&radius, 0, radii[i % 9]);
        colour.plane[0][Y * WIDTH + X] = v;
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &colour, &radius, half);
        for (int k = 0; k < PIXELS; k++)
            sum += (double)out.plane[0][k] - (double)0.35f;
        CHECK_MSG(fabs(sum / ((double)v - (double)0.35f) - 1) <= 1e-5, "half %d, %g at radius %g: %g of its energy",
                  half, (double)v, (double)radii[i % 9], sum / (double)v);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// A crop does not depend on a light outside it.
static void crops(struct hf_context *c, int half)
{
    struct scene s = stage(3);
    s.colour.plane[0][2 * WIDTH + WIDTH - 3] = 1e9f;
    const int x0 = 4, y0 = 8, w = 90, h = 80;
    struct scene part = {picture_cut(&s.colour, x0, y0, w, h), picture_cut(&s.depth, x0, y0, w, h)};
    struct picture whole = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half),
                   cut = render_radii(c, HF_ENGINE_SCATTER, &part.colour, &part.depth, half);
    int other = 0;
    for (int ch = 0; ch < 3; ch++)
        for (int y = 2 * REACH; y < h - 2 * REACH; y++)
            for (int x = 2 * REACH; x < w - 2 * REACH; x++)
                other += memcmp(&cut.plane[ch][y * w + x], &whole.plane[ch][(y + y0) * WIDTH + x + x0], sizeof(float));
    CHECK_MSG(!other, "half %d: %d samples of a crop are not the whole's", half, other);
    picture_free(&whole);
    picture_free(&cut);
    scene_free(&part);
    scene_free(&s);
}

// Samples as large as a float can be, of both signs.
static void largest(struct hf_context *c, int half)
{
    for (int signs = 0; signs < 2; signs++) {
        struct scene s = stage(4);
        for (int ch = 0; ch < 4; ch++)
            for (int k = 0; k < PIXELS; k++)
                s.colour.plane[ch][k] = signs && k % 3 ? -FLT_MAX : FLT_MAX;
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
        int bad = 0, off = 0;
        for (int ch = 0; ch < 4; ch++)
            for (int k = 0; k < PIXELS; k++) {
                bad += !isfinite(out.plane[ch][k]);
                off += !signs && !(out.plane[ch][k] >= FLT_MAX * (1 - 16 * U));
            }
        CHECK_MSG(!bad && !off, "half %d: %d samples are not finite, %d are another constant", half, bad, off);
        picture_free(&out);
        scene_free(&s);
    }
}

// An alpha that is 1 all around stays 1, bit for bit, whatever it is elsewhere in the frame.
static void opaque(struct hf_context *c, int half)
{
    static const float elsewhere[] = {1e-42f, 0, 0.3f, 1.7f, 5, 6e4f, 1e12f, FLT_MAX};
    for (int i = 0; i < 8; i++) {
        struct scene s = stage(4);
        picture_fill(&s.colour, 3, 1);
        s.colour.plane[3][Y * WIDTH + X] = elsewhere[i];
        struct picture out = render_radii(c, HF_ENGINE_SCATTER, &s.colour, &s.depth, half);
        int thin = 0;
        for (int k = 0; k < PIXELS; k++)
            thin += is_far_off(k) && out.plane[3][k] != 1;
        CHECK_MSG(!thin, "half %d, alpha of %g in one pixel: %d others are not 1", half, (double)elsewhere[i], thin);
        picture_free(&out);
        scene_free(&s);
    }
}

// As much as can lie in one place: all pixels up to a distance are blurred just so far that they reach it. The sums there are the
// largest that their fixed point must hold. Beyond that they wrap around, to another sign; 1e-4 is far more than what
// roundings of 22-bit shares leave, and far less than that.
static void piled_up(struct hf_context *c, int half)
{
    static const struct hf_aperture_params looks[] = {{.squeeze = 1},
                                                      {.squeeze = 0.5f},
                                                      {.squeeze = 2},
                                                      {.squeeze = 1, .blades = 3},
                                                      {.squeeze = 1, .ring = 0.95f},
                                                      {.squeeze = 1, .cat_eye = 1}};
    static const float reaches[] = {3.9f, 11.9f, 35.9f, 60};
    for (int i = 0; i < 6 * 4 * 4 * 2; i++) {
        const float reach = reaches[i / 8 % 4], beyond = 0.25f * (float)(i / 2 % 4), sign = i % 2 ? -1 : 1;
        const int size = 2 * (int)reach + 20, middle = size / 2;
        struct picture colour = picture_new(size, size, 4), radius = picture_new(size, size, 1);
        for (int ch = 0; ch < 4; ch++)
            picture_fill(&colour, ch, nextafterf(2, 0));
        for (int k = 0; k < size * size; k++) {
            const float distance = hypotf((float)(k % size - middle), (float)(k / size - middle));
            radius.plane[0][k] = sign * fminf(fmaxf(distance + beyond, 0.75f), reach);
        }
        const struct hf_depth depth = picture_radii(&radius);
        struct hf_params p = scene_params();
        p.engine = HF_ENGINE_SCATTER;
        p.max_radius = HF_DERIVE;
        p.scatter.resolution = half ? HF_RESOLUTION_HALF : HF_RESOLUTION_FULL;
        p.aperture = looks[i / 32];
        struct picture out = render(c, &colour, &depth, &p);
        double worst = 0;
        for (int ch = 0; ch < 4; ch++)
            for (int k = 0; k < size * size; k++)
                worst = worse(worst, fabs((double)out.plane[ch][k] / 2 - 1));
        CHECK_MSG(worst <= 1e-4, "half %d, look %d, %g pixels, %g beyond: a constant is %g off", half, i / 32,
                  (double)(sign * reach), (double)beyond, worst);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

int main(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int half = 0; half < HALVES; half++) {
        far_off(c, half);
        faintest(c, half);
        many(c, half);
        beside_constant(c, half);
        faded(c, half);
        crops(c, half);
        largest(c, half);
        opaque(c, half);
        piled_up(c, half);
    }
    hf_close(&c);
    return check_report();
}
