// SPDX-License-Identifier: BSD-3-Clause
// The layers engine against itself in double precision.
//
//     layers_exact [seed]
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "support/check.h"
#include "support/layers_reference.h"
#include "support/render.h"

enum { MOST = 4, PLAIN = 20, PICTURES = 24, CATS_EYES = 30, CASES = 35, PICTURE_WIDTH = 7, PICTURE_HEIGHT = 5 };

// Surfaces whose radii do not differ by about 1, are not midway between two others, and are too far apart to be merged
// in the search for hidden samples: so no decision that compares radii depends on a rounding. The colours of two
// surfaces are as far apart as possible, with a pattern on each. So the shares of a mixed pixel are known to a few
// roundings, and are seldom 0 or 1.
static const struct {
    int count;
    float radius[MOST];
} stages[] = {{2, {-9.3f, 0}},
              {2, {0, 11.7f}},
              {2, {-21.3f, 20.4f}},
              {3, {-22.9f, 0, 21.6f}},
              {1, {13.1f}},
              {1, {-5.2f}},
              {3, {-2.3f, 0.4f, 7.9f}},
              {2, {3.4f, 38.2f}},
              {3, {-17, 2.2f, 26}},
              {4, {-23, 0, 22, 45.5f}},
              {3, {-15.6f, 5.3f, 23}},
              {3, {-16, -5.4f, 9}}};
enum { STAGES = sizeof stages / sizeof *stages };

static struct scene stage_new(struct rng *rng, int n, int width, int height, int channels, int lamps)
{
    struct scene s = {picture_new(width, height, channels), picture_new(width, height, 1)};
    float base[MOST][4];
    for (int k = 0; k < MOST; k++)
        for (int c = 0; c < 4; c++)
            base[k][c] = (k + c) % 2 ? 0.75f : 0.15f;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const int i = y * width + x, count = stages[n].count;
            // Blocks of 7 x 6, each of one surface.
            const int k = (int)((unsigned)(x / 7 * 5 + y / 6 * 3 + x / 21) % (unsigned)count);
            s.depth.plane[0][i] = stages[n].radius[k];
            for (int c = 0; c < channels; c++)
                s.colour.plane[c][i] = c < 3 ? base[k][c] + rng_range(rng, -0.12f, 0.12f) : 1;
        }
    for (int k = 0; k < lamps; k++) {
        const int i = rng_below(rng, width * height);
        for (int c = 0; c < 3; c++)
            s.colour.plane[c][i] = rng_range(rng, 20, 50);
    }
    return s;
}

// Roundings, half a unit each, in units of the largest sample around.
// Un-mixing: 48 products and sums for each mean (96); the weight of each sample, the fourth power of a quotient of sums
// of three (4 * (3 + 3 + 1) + 2); and a share whose numerator and denominator are products of such means, 6 times as
// large as their difference where colours differ by 0.3 or more, of 0.3 to 0.9: 6 * (96 + 30 + 20).
// Highlights: 18 + 18 sums of roots and their squares, 60.
// Hidden samples: the back of a mixed pixel, 8; three products and sums a level, twice (8 * 2 * 5); nine taps of each
// (9 * 5 * 3); means of 13, twice (2 * (13 + 3)), and squares: 280. Their weights in these means, twice 4 * (3 + 3 + 1)
// + 2: 60. Their distance from the middle's colour, twice a quotient of sums of three: 2 * 2 * (5 + 2 + 2) = 36.
// Patterns: the error of a choice and the variance that it is compared with, 61 products and sums each (4 * 61), to the
// fourth power, and twice as much for the trust in the best one: (4 + 2) * 4 * 61.
// Slices: a share and its sums over 4 x 4 pixels: 24. Rows of runs: 10 a row and the sum of rows, 2 * 46 + 2; of a
// disc, twice as many columns as rows: at most 140. A cover is such a sum too, and the far stack is divided by what it
// leaves open, at least a sixteenth: 16 * (24 + 140). Upsampling: 6 a level, 3 levels. A stack: 7 a slice, of which a
// sample is in two, and all that lies before affects what is open: 7 * 40. The result: 12. The table's weights are
// floats: 4 more.
static const double ROUNDINGS =
    6 * (96 + 30 + 20) + 60 + 280 + 60 + 36 + 6 * 4 * 61 + 24 + 140 + 16 * (24 + 140) + 18 + 7 * 40 + 12 + 4;

static void against_double(struct hf_context *c, struct rng *rng, int n)
{
    const int width = 40 + rng_below(rng, 20), height = 30 + rng_below(rng, 16), lamps = n % 3 == 2 ? 3 : 0;
    // Cat's eyes have small radii, because the reference makes one for every pixel.
    const int cats_eye = n >= CATS_EYES, stage = cats_eye ? 5 + n % 2 : n % STAGES;
    const int shaped = cats_eye ? n % 2 : n % 4 == 1, drawn = n >= PICTURES && !cats_eye;
    struct scene s = stage_new(rng, stage, width, height, 3 + rng_below(rng, 2), lamps);
    struct hf_params p = scene_params();
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = HF_DERIVE;
    p.layers.quality = (enum hf_layers_quality)rng_below(rng, 4);
    p.layers.no_unmix = n % 5 == 1;
    p.layers.no_hidden = n % 7 == 3;
    p.layers.no_highlights = !lamps;
    p.layers.no_patterns = n % 8 == 7;
    p.layers.lens_points = 1;  // test-layers_rays has them
    p.aperture.blades = shaped && !drawn ? 3 + rng_below(rng, 6) : 0;
    p.aperture.rotation = p.aperture.blades ? rng_range(rng, -90, 90) : 0;
    p.aperture.roundness = p.aperture.blades && n % 8 >= 4 ? rng_range(rng, 0.1f, 1) : 0;
    p.aperture.ring = n % 4 >= 2 || drawn ? 0 : rng_range(rng, 0, 0.8f);
    p.aperture.cat_eye = cats_eye ? rng_range(rng, 0.2f, 1) : 0;
    p.aperture.squeeze = n % 6 == 5 ? 1.5f : 1;
    p.aperture.chromatic = n >= PLAIN ? rng_range(rng, -0.3f, 0.3f) : 0;
    float texel[3 * PICTURE_WIDTH * PICTURE_HEIGHT];
    for (int i = 0; i < 3 * PICTURE_HEIGHT * PICTURE_WIDTH; i++)
        texel[i] = i % 3 && n % 2 ? texel[i - 1] : 0.25f * (float)(rng_below(rng, 4) + (i / 3 == PICTURE_WIDTH));
    const struct hf_image picture = {.size = sizeof picture,
                                     .width = PICTURE_WIDTH,
                                     .height = PICTURE_HEIGHT,
                                     .format = HF_FORMAT_RGB32F,
                                     .data = {texel},
                                     .stride = {3 * PICTURE_WIDTH * sizeof(float)}};
    p.aperture.picture = drawn ? &picture : NULL;
    const struct hf_depth depth = picture_radii(&s.depth);
    struct hf_params filled = {.size = sizeof filled};
    CHECK_INT(hf_resolve(width, height, &depth, &p, &filled, NULL, NULL), HF_OK);
    struct picture got = render(c, &s.colour, &depth, &p);
    struct picture want = layers_reference(&s.colour, s.depth.plane[0], &filled);
    const double largest = largest_sample(&s.colour), bound = ROUNDINGS * FLT_EPSILON / 2 * largest;
    const double off = largest_difference(&got, &want);
    printf("case %d, stage %d, %d x %d, quality %d, blades %d, ring %.2f: %.3g of %.3g\n", n, stage, width, height,
           (int)p.layers.quality, p.aperture.blades, p.aperture.ring, off, bound);
    CHECK_MSG(off <= bound, "case %d, stage %d: %g off, bound %g", n, stage, off, bound);
    picture_free(&got);
    picture_free(&want);
    scene_free(&s);
}

int main(int argc, char **argv)
{
    struct rng rng = rng_seed(argc > 1 ? (unsigned)atoi(argv[1]) : 1);
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 0, 0);
    for (int n = 0; n < CASES; n++)
        against_double(c, &rng, n);
    hf_close(&c);
    return check_report();
}
