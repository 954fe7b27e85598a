// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine where radii differ: a light before another surface keeps its shape, and a pixel that covers almost
// nothing changes almost nothing. On one instruction set, and in C.
#include <math.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/render.h"

enum { SIZE = 120, PIXELS = SIZE * SIZE, MIDDLE = SIZE / 2 };

// Count the dark pixels between two bright ones of their line; lines are `down` apart.
static int gaps(const float *plane, int step, int down, float shine)
{
    int dark = 0;
    for (int y = 0; y < SIZE; y++) {
        int first = SIZE, last = -1;
        for (int x = 0; x < SIZE; x++)
            if (plane[y * down + x * step] >= shine) {
                first = x < first ? x : first;
                last = x;
            }
        for (int x = first; x <= last; x++)
            dark += plane[y * down + x * step] < shine;
    }
    return dark;
}

// A bright light of seven pixels in front of a farther wall: its hexagon has no notches, which once were as large as
// the light. Along rows and columns, every pixel between two that reach a tenth of the disc's brightness reaches it
// too, except in a row of the light's own seven pixels, where the wall behind has another radius.
static void lights(struct hf_context *c, int half)
{
    static const float radii[][2] = {{15.6f, 22}, {12, 20}, {18, 21}, {10, 19}};
    for (int i = 0; i < 4; i++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radius = picture_new(SIZE, SIZE, 1);
        const float r = radii[i][0];
        for (int k = 0; k < PIXELS; k++) {
            const double d = hypot(k % SIZE - MIDDLE, k / SIZE - MIDDLE);
            radius.plane[0][k] = d <= 3.5 ? r : radii[i][1];
            for (int ch = 0; ch < 3; ch++)
                colour.plane[ch][k] = d <= 3.5 ? 200 : 0.02f;
        }
        struct picture out = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        const float shine = 0.1f * (200 * 3.5f * 3.5f / (r * r));
        const int dark = gaps(out.plane[1], 1, SIZE, shine) + gaps(out.plane[1], SIZE, 1, shine);
        CHECK_MSG(dark <= 7, "half %d, a light of radius %g before %g: %d dark pixels", half, (double)r,
                  (double)radii[i][1], dark);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// How far inside the nearest edge of a hexagon around the middle a pixel lies.
static double inside_hexagon(int k, double side)
{
    double least = side;
    for (int i = 0; i < 6; i++) {
        const double angle = i * M_PI / 3, along = (k % SIZE - MIDDLE) * cos(angle) + (k / SIZE - MIDDLE) * sin(angle);
        least = fmin(least, side * sqrt(3) / 2 - along);
    }
    return least;
}

// A light of five pixels before a dark wall of a larger radius becomes a hexagon of its own radius r, corners included.
// Inside, all of it arrives in every direction, except within the light's own 2.5 pixels, half a place (0.6) and a
// pixel's diagonal (1.4) of the edge. Each blur divides what it finds by the total weight: by 1, plus the light's
// excess over the wall that it replaces, its width (and a place) times the difference of 1 / radius; twice. 0.1 is for
// a disc made of pixels.
// Outside, softened by 4.1 (hexagon.c), the result is as dark as the wall W: a mean radius exceeds the light's by e
// where the wall has e / r of the light or more. At half resolution quads and their sampling blur more: hexagon.c's 9,
// and a light is wider by a quad and a place on either side.
static void full(struct hf_context *c, int half)
{
    static const float radii[][2] = {{15.6f, 22}, {12, 20}, {18, 21}, {10, 19}, {14, 14}, {17, 24}};
    const double wall = 1e-3, rim = 2.5, soft = rim + (half ? 9 : 4.1), inner = half ? soft : rim + 0.6 + 1.4;
    for (int i = 0; i < 6; i++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radius = picture_new(SIZE, SIZE, 1);
        const double r = radii[i][0], R = radii[i][1], width = 2 * rim + (half ? 2 * (2 + 2.3) : 1.2);
        double light = 0, least = INFINITY, most = 0;
        for (int k = 0; k < PIXELS; k++) {
            const int is = hypot(k % SIZE - MIDDLE, k / SIZE - MIDDLE) <= rim;
            radius.plane[0][k] = radii[i][!is];
            for (int ch = 0; ch < 3; ch++)
                colour.plane[ch][k] = is ? 200 : (float)wall;
            light += is * 200;
        }
        struct picture out = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        for (int k = 0; k < PIXELS; k++) {
            const double inside = inside_hexagon(k, r), e = -inside - soft;
            if (inside >= inner)
                least = fmin(least, out.plane[1][k]);
            if (e > 0)
                most = fmax(most, out.plane[1][k] / (wall * (1 + r / e)));
        }
        const double want = 0.9 * light / (1.5 * sqrt(3) * r * r) / pow(1 + width * (1 / r - 1 / R), 2);
        CHECK_MSG(least >= want, "half %d, a light of radius %g before %g: %g inside, at least %g", half, r, R, least,
                  want);
        CHECK_MSG(most <= 1, "half %d, a light of radius %g before %g: %g of what may be outside", half, r, R, most);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// Pixels before a sharp wall have one radius; one of them has a radius that reaches across the picture. It covers 1 / R
// of a line, so the root of the mean radius r moves by at most (sqrt(R) - sqrt(r)) / R, the radius by twice that share
// of itself, and a line's mean by as much of the difference at its end, 0.8: in two of three rhombi. Close to that
// pixel, others are less near than half of its radius, and so are visible behind near ones: up to 7 half-resolution
// pixels away, from where neighbourhoods of radius 4 spread them by 3, and bilinear samples by 1.
static void one_far_reaching(struct hf_context *c, int half)
{
    static const float reach[] = {1000, 2000};
    for (int i = 0; i < 2; i++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radius = picture_new(SIZE, SIZE, 1);
        const float r = 4;
        for (int k = 0; k < PIXELS; k++) {
            radius.plane[0][k] = abs(k % SIZE - MIDDLE) < 30 ? -r : 0;
            for (int ch = 0; ch < 3; ch++)
                colour.plane[ch][k] =
                    abs(k % SIZE - MIDDLE) < 30 ? 0.2f + 0.6f * ((k % SIZE / 6 + k / SIZE / 6) & 1) : 1;
        }
        struct picture before = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        radius.plane[0][(SIZE - 20) * SIZE + MIDDLE] = -reach[i];
        struct picture after = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        const double R = half ? reach[i] / 2 : reach[i], q = half ? r / 2 : r, share = (half ? 0.25 : 1) / R;
        const double most = 0.8 * 2 / 3 * (2 * share * (sqrt(R / q) - 1) + share);
        double worst = 0;
        for (int k = 0; k < PIXELS; k++)
            if (abs(k / SIZE - (SIZE - 20)) > 2 * (7 + 3 + 1) + 1)
                worst = worse(worst, fabs((double)before.plane[0][k] - after.plane[0][k]));
        printf("half %d: one pixel of radius %g changes others by %.3g, bound %.3g\n", half, (double)reach[i], worst,
               most);
        CHECK_MSG(worst <= most, "half %d: one pixel of radius %g changes others by %g, bound %g", half,
                  (double)reach[i], worst, most);
        picture_free(&before);
        picture_free(&after);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// A light that leaves the picture takes its light with it: none of its positions makes more light than the middle one,
// apart from what pixels add that find nothing beyond the edge, in each of two passes: less than half as much again.
static void leaving(struct hf_context *c, int half, float r, int corner)
{
    double middle = 0, most = 0;
    for (int x = MIDDLE; x < SIZE; x++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radius = picture_new(SIZE, SIZE, 1);
        picture_fill(&radius, 0, r);
        colour.plane[1][(corner ? x : MIDDLE) * SIZE + x] = 100;
        struct picture out = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        double sum = 0;
        for (int k = 0; k < PIXELS; k++)
            sum += out.plane[1][k];
        middle = x == MIDDLE ? sum : middle;
        most = fmax(most, sum);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
    printf("half %d, radius %g, corner %d: a light leaving the picture shines by up to %.3g of what it does in the "
           "middle\n",
           half, (double)r, corner, most / middle);
    CHECK_MSG(most <= 1.5 * middle, "half %d: a light that leaves shines by %g of its own", half, most / middle);
}

// A bright near bar before a dark, sharp wall shows its light once: what its coverage leaves open shows the wall, also
// on the bar. Behind the bar the bar's own light makes up 1 / (1 + (w / 6e-5)^2), and the dark wall, of which a weight w is
// visible, the rest. w is at least that of a neighbourhood of 16 pixels in which 1 of 33 columns is visible, 1e-4, so the bar's
// makes up hardly more than a quarter. The widest bar reaches as far as its radius. So its middle third leaves hardly a hundredth
// open, and elsewhere more of the wall is visible: that comes to 0.09 %.
static void drawn_once(struct hf_context *c, int half)
{
    static const int widths[] = {2, 6, 12};
    for (int i = 0; i < 6; i++) {
        struct picture colour = picture_new(SIZE, SIZE, 3), radius = picture_new(SIZE, SIZE, 1);
        const int width = widths[i % 3], top = i < 3 ? 36 : MIDDLE - width / 2;
        double before = 0, after = 0;
        for (int k = 0; k < PIXELS; k++) {
            const int is = abs(k % SIZE - MIDDLE) < width && k / SIZE >= top && k / SIZE < SIZE - top;
            radius.plane[0][k] = is ? -12 : 0;
            colour.plane[1][k] = (float)is;
            before += is;
        }
        struct picture out = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        for (int k = 0; k < PIXELS; k++)
            after += out.plane[1][k];
        CHECK_MSG(fabs(after / before - 1) < 1e-3, "half %d, a bar %d wide from %d: shown %g times", half,
                  2 * width - 1, top, after / before);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

// Opaque input gives opaque output, bit for bit, for any radii.
static void opaque(struct hf_context *c, int half)
{
    for (unsigned i = 0; i < 12; i++) {
        struct rng rng = rng_seed(40 + i);
        const int w = 40 + rng_below(&rng, 50), h = 30 + rng_below(&rng, 40);
        struct picture colour = picture_new(w, h, 4), radius = picture_new(w, h, 1);
        for (int k = 0; k < w * h; k++) {
            for (int ch = 0; ch < 4; ch++)
                colour.plane[ch][k] = ch < 3 ? rng_float(&rng) : 1;
            radius.plane[0][k] = rng_below(&rng, 3) && k ? radius.plane[0][k - 1] : rng_range(&rng, -14, 14);
        }
        struct picture out = render_radii(c, HF_ENGINE_HEXAGON, &colour, &radius, half);
        int thin = 0;
        for (int k = 0; k < w * h; k++)
            thin += out.plane[3][k] != 1;
        CHECK_MSG(!thin, "half %d, scene %u: %d pixels are not opaque", half, i, thin);
        picture_free(&out);
        picture_free(&colour);
        picture_free(&radius);
    }
}

int main(void)
{
    static const enum hf_isa isas[] = {HF_ISA_SCALAR, HF_ISA_AUTO};
    for (int i = 0; i < 2; i++) {
        struct hf_context *c = context_new(isas[i], 2, 0, 0);
        for (int half = 0; half < 2; half++) {
            lights(c, half);
            full(c, half);
            one_far_reaching(c, half);
            drawn_once(c, half);
            for (int k = 0; k < 4; k++)
                leaving(c, half, k & 1 ? 12 : -12, k >> 1);
            opaque(c, half);
        }
        hf_close(&c);
    }
    return check_report();
}
