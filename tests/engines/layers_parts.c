// SPDX-License-Identifier: BSD-3-Clause
// The parts of layers one by one: how closely slices lie, which colour a side of an edge gets if none of its pixels is
// un-mixed, what shows beside an edge in one pixel alone, how hairs are un-mixed where no pixel is sure, how much a lamp
// counts among hidden samples, and where runs of tiles begin and end.
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/layers/hidden.h"
#include "engine/layers/kernels.h"
#include "engine/layers/parts.h"
#include "engine/layers/unmix.h"
#include "frame/resolve.h"
#include "pass/check.h"
#include "support/check.h"
#include "support/render.h"

// Every sample is shared between slices as a whole. Means of radii are rounded, so a few lie beyond the outermost slices.
static void shared(const struct hf_layers *l)
{
    enum { N = 4096, ANY = N / 16 };
    static float radius[N], out[N], sum[N];
    static uint8_t any[ANY];
    const float *in[6] = {[5] = radius};
    float *const to[5] = {[4] = out};
    const float low = l->slice[0].radius * (1 + 8 * FLT_EPSILON),
                high = l->slice[l->slices - 1].radius * (1 + 8 * FLT_EPSILON);
    for (int i = 0; i < N; i++)
        radius[i] = i < N - 1 ? low + (high - low) * (float)i / (N - 1) : high;
    memset(sum, 0, sizeof sum);
    for (int k = 0; k < l->slices; k++) {
        struct hf_slice s = l->slice[k];
        s.scale = 1;
        hf_layers_weigh_c(&s, in, NULL, 0, 1, 0, N, 0, to, any);
        for (int i = 0; i < N; i++)
            sum[i] += out[i];
    }
    // Two slices share a sample: one shows a product, the other 1 less the same product. That difference and the sum round.
    for (int i = 0; i < N; i++)
        CHECK_MSG(fabsf(sum[i] - 1) <= FLT_EPSILON, "%.9g of a sample of radius %.9g is shown", sum[i], radius[i]);
}

// Slices cover the radii in order. No two are farther apart than the spacing or a 32nd of their radius (in the finer
// qualities half of 1 or a 16th spacings), plus a rounding. There is none between 0 and 1.
static void slices(enum hf_layers_quality quality)
{
    struct picture colour = picture_new(64, 48, 3), radii = picture_new(64, 48, 1);
    struct hf_image image = picture_image(&colour);
    const struct hf_depth depth = picture_radii(&radii);
    const struct hf_counts found = {.radius_min = -150, .radius_max = 333};
    struct hf_params p = hf_default_params();
    struct hf_layers l = {.slices = 0};
    struct hf_settings r;
    struct hf_setup s;
    struct hf_message message;
    p.engine = HF_ENGINE_LAYERS;
    p.layers.quality = quality;
    CHECK_INT(hf_params_resolve(&r, 64, 48, &depth, &p, &message), HF_OK);
    hf_setup_make(&s, &image, &image, &depth, &r, &l);
    CHECK_INT(hf_layers_engine.own.prepare(&l, &s, &r.params, &hf_mem_default), HF_OK);
    CHECK_INT(hf_layers_engine.own.measure(&l, &s, &found, &hf_mem_default), HF_OK);
    CHECK(l.slices > 20 && l.slice[0].radius <= -150 && l.slice[l.slices - 1].radius >= 333);
    for (int i = 1; i < l.slices; i++) {
        const float a = l.slice[i - 1].radius, b = l.slice[i].radius, inner = fminf(fabsf(a), fabsf(b));
        const float widest = quality < HF_LAYERS_HIGH ? fmaxf(r.params.layers.spacing, inner / 32)
                                                      : fmaxf(1, inner / 16) * r.params.layers.spacing / 2;
        CHECK_MSG(b > a && b - a <= (inner < 1 ? 1 : widest) + FLT_EPSILON * fmaxf(fabsf(a), fabsf(b)),
                  "quality %d: slices at %g and %g", (int)quality, a, b);
    }
    shared(&l);
    hf_layers_engine.own.release(&l, &hf_mem_default);
    picture_free(&colour);
    picture_free(&radii);
}

// Before a grey wall of un-mixed pixels lies an edge whose pixels are all mixed with the wall, to different degrees.
// Those least like the wall give the edge's colour, weighted by the eighth power of the difference: one half as
// different counts a 256th.
static void farthest(void)
{
    enum { N = 7, AT = 3 };
    float radius[N][N], colour[N][N], sure[N][N] = {{0}}, middle[N], slope[N];
    struct hf_unmix_row row = {.channels = 1, .middle = middle, .slope = slope};
    for (int y = 0; y < N; y++) {
        middle[y] = 0;
        slope[y] = 1;
        row.radius[y] = radius[y];
        row.colour[y][0] = row.colour[y][1] = row.colour[y][2] = colour[y];
        row.sure[y] = sure[y];
        for (int x = 0; x < N; x++) {
            const int front = x == AT && y >= 2 && y <= 4;
            radius[y][x] = front ? -4.0f - (float)y : 5;
            colour[y][x] = front && y == 3 ? 1 : front ? 0.75f : 0.5f;
        }
    }
    float weight[2] = {0, 1}, mean[2][5] = {{0}, {0.5f, 0, 0, 0, 5}}, spread[2] = {0.25f, 0.5f};
    const double all = 1 + 2.0 / 256, want = (1 + 2 * 0.75 / 256) / all, r = (-7 - (6 + 8) / 256.0) / all;
    CHECK_INT(hf_unmix_complete(&row, AT, weight, mean, spread), 1);
    // Three products, sums and a quotient for each.
    CHECK_MSG(fabs(mean[0][0] - want) <= 7 * FLT_EPSILON && fabs(mean[0][4] - r) <= 7 * 8 * FLT_EPSILON,
              "colour %g of radius %g, not %g of %g", mean[0][0], mean[0][4], want, r);
    CHECK(mean[1][0] == 0.5f && mean[1][4] == 5);
    // A front without weight has an unknown spread, taken as 0; at half of the weight that counts as little, half of it
    // is known.
    CHECK(spread[0] == 0 && spread[1] == 0.5f);
    weight[0] = 1 / (2 / (double)HF_UNMIX_LEAN - 1);
    spread[0] = 0.25f;
    CHECK_INT(hf_unmix_complete(&row, AT, weight, mean, spread), 1);
    CHECK_MSG(fabs(spread[0] - 0.125) <= 4 * 0.125 * FLT_EPSILON, "a variance of %g, not 0.125", spread[0]);
    // A pixel of which a millionth belongs to the edge changes nothing, however different its colour is.
    radius[1][AT] = 0.5f - 0x1p-20f;
    colour[1][AT] = 5;
    weight[0] = 0;
    CHECK_INT(hf_unmix_complete(&row, AT, weight, mean, spread), 1);
    CHECK_MSG(fabs(mean[0][0] - want) <= 7 * FLT_EPSILON, "colour %g, not %g, beside a pixel of another surface",
              (double)mean[0][0], want);
    weight[1] = 0;
    CHECK_INT(hf_unmix_complete(&row, AT, weight, mean, spread), 0);
}

// The surroundings of the pixel in the middle, and both of its samples, as the kernel writes them.
enum { BLOCK = 9, CENTRE = 4, ROWS = 7 };
struct block {
    float radius[BLOCK], sure[BLOCK], middle[BLOCK], slope[BLOCK], colour[ROWS][3][BLOCK], out[2][6][BLOCK];
};

static void unmix_middle(struct block *b)
{
    uint8_t any[1] = {0};
    struct hf_unmix_row row = {.channels = 3, .middle = b->middle + CENTRE, .slope = b->slope + CENTRE, .any = any};
    for (int y = 0; y < ROWS; y++) {
        row.radius[y] = b->radius + CENTRE;
        row.sure[y] = b->sure + CENTRE;
        for (int c = 0; c < 3; c++)
            row.colour[y][c] = b->colour[y][c] + CENTRE;
    }
    for (int i = 0; i < 6; i++) {
        row.seen[i] = b->out[0][i] + CENTRE;
        row.mixed[i] = b->out[1][i] + CENTRE;
    }
    hf_layers_unmix_c(&row, 1);
}

// A bar covers two fifths of a pixel. The rest of the pixel is dark, and the wall beside it bright: there ends the dark part
// of a pattern. The pixel's middle, and so its depth, is the wall's, so the bar covers at most half of the pixel. With that
// share the means leave v - (bar + bright) / 2 = (6 dark - bar - 5 bright) / 10 unexplained, of which the back gets one and a
// half: it is dark + (bright - dark) / 4 + 3 (dark - bar) / 20.
static void sliver(void)
{
    static const float bar[3] = {0.4f, 0.12f, 0.08f}, dark[3] = {0.25f, 0.1f, 0.1f}, bright[3] = {0.9f, 0.85f, 0.3f};
    struct block b = {.radius = {0}};
    for (int x = 0; x < BLOCK; x++) {
        b.radius[x] = x < CENTRE ? -8 : 8;
        b.sure[x] = x < CENTRE - 1 || x > CENTRE;
        b.slope[x] = 2.0f / 16;
        for (int y = 0; y < ROWS; y++)
            for (int c = 0; c < 3; c++)
                b.colour[y][c][x] = x < CENTRE ? bar[c] : x > CENTRE ? bright[c] : 0.4f * bar[c] + 0.6f * dark[c];
    }
    unmix_middle(&b);
    CHECK_MSG(b.out[1][4][CENTRE] >= 0.5f, "the back covers %g of the pixel", (double)b.out[1][4][CENTRE]);
    for (int c = 0; c < 3; c++) {
        const double back = b.out[1][c][CENTRE], off = fabs(back - dark[c]),
                     most = fabs(bright[c] - dark[c]) / 4 + 3 * fabs(dark[c] - bar[c]) / 20;
        CHECK_MSG(off <= most + 8 * FLT_EPSILON, "channel %d of the back is %g, not %g", c, back, (double)dark[c]);
    }
}

// Hairs a pixel wide, of one colour, stand a pixel apart before a wall, and no pixel is sure. Either the middle pixel is the
// wall's, and a hair covers two fifths of it; or, lit, it is a hair's that covers half of a lamp of 60, which shines in the
// wall's pixel beside it.
static struct block hairs(int lit)
{
    struct block b = {.radius = {0}};
    for (int x = 0; x < BLOCK; x++) {
        const int hair = x % 2 != lit;
        b.radius[x] = hair ? -2 : 8;
        b.middle[x] = 3;
        b.slope[x] = 2.0f / 10;
        for (int y = 0; y < ROWS; y++)
            for (int c = 0; c < 3; c++)
                b.colour[y][c][x] = hair ? 0.1f : 0.9f;
    }
    for (int c = 0; c < 3; c++) {
        b.colour[3][c][CENTRE] = lit ? 30 : 0.4f * 0.1f + 0.6f * 0.9f;
        if (lit)
            b.colour[3][c][CENTRE + 1] = 60;
    }
    unmix_middle(&b);
    return b;
}

static void thicket(void)
{
    const struct block dark = hairs(0), lit = hairs(1);
    // Both means are exact. The share by depth, 0, counts a thousandth of the squares of both colours, 0.82, to the 0.64 of
    // their squared distance.
    const float hair = dark.out[0][4][CENTRE];
    CHECK_MSG(hair > 0.4f * (1 - 0.0014f) && hair < 0.4f + 8 * FLT_EPSILON, "a hair covers %g of a pixel, not 0.4",
              (double)hair);
    CHECK_MSG(dark.out[0][5][CENTRE] == -2 && dark.out[1][5][CENTRE] == 8, "radii %g and %g, not -2 and 8",
              (double)dark.out[0][5][CENTRE], (double)dark.out[1][5][CENTRE]);
    // The lamp's own pixel is 256 times as bright as the middle one to the eighth power, so all but a 257th of the means is
    // replaced. The hair's mean before was at most that of the pixels beside it, 0.1, so less than a 30th of the light stays.
    const float kept = lit.out[0][0][CENTRE] * lit.out[0][4][CENTRE];
    const float back = lit.out[1][0][CENTRE] * lit.out[1][4][CENTRE];
    CHECK_MSG(kept < 1, "%g of a lamp's light stay with a hair before it", (double)kept);
    CHECK_MSG(fabsf(kept + back - 30) < 1, "the pixel's light is %g, not 30", (double)(kept + back));
}

// A lamp of 4096 among hidden samples of 1 at the same depth. It counts by the fourth power of 16 / 64, a 256th; by a
// tenth of that for its other colour; and by its place at the end of the line, one of 49 parts.
static void lamp_in_line(void)
{
    float one[HF_LAYERS_TAPS][6], out[6];
    float *to[6];
    const float *in[HF_LAYERS_TAPS][6];
    for (int i = 0; i < HF_LAYERS_TAPS; i++)
        for (int c = 0; c < 6; c++) {
            one[i][c] = c == 5 ? 20 : c < 4 && i == 0 ? 64 : 1;
            in[i][c] = &one[i][c];
            to[c] = &out[c];
        }
    const double want = (48 + 64.0 / 2560) / (48 + 1.0 / 2560);
    hf_layers_smooth_c((const float *const(*)[6])in, NULL, 3, 1, to);
    // Thirteen products and sums, and a quotient, for each.
    CHECK_MSG(fabs(out[0] - want) <= 28 * FLT_EPSILON * want, "%g, not %g", (double)out[0], want);
    CHECK(out[4] == 1 && fabsf(out[5] - 20) <= 28 * 20 * FLT_EPSILON);
}

// Runs of tiles with one of some bits: rows of all lengths, from all places on, against a loop over tiles.
static void runs(void)
{
    enum { LONG = 40, BYTES = LONG + 7 };
    uint8_t row[BYTES];
    const struct hf_tile_map m = {.at = row, .stride = LONG};
    struct rng r = rng_seed(1);
    for (int i = 0; i < 20000; i++) {
        const int bits = i % 3 ? i % 3 : 255;
        // Half of the tiles are like the one before, so some runs are longer than eight; of the others half are empty.
        for (int x = 0; x < BYTES; x++)
            row[x] = x && rng_below(&r, 2) ? row[x - 1] : (uint8_t)(rng_below(&r, 2) * rng_below(&r, 4));
        const int end = i % (LONG + 1), from = (i / 7) % (end + 1);
        int first = from, last, tx = from;
        while (first < end && !(row[first] & bits))
            first++;
        for (last = first; last < end && row[last] & bits;)
            last++;
        const int found = hf_layers_next_run(&m, &tx, 0, end, bits);
        CHECK_MSG(tx == first && found == last, "tiles %d to %d of %d to %d, not %d to %d", tx, found, from, end, first,
                  last);
    }
}

int main(void)
{
    for (int quality = HF_LAYERS_DRAFT; quality <= HF_LAYERS_BEST; quality++)
        slices((enum hf_layers_quality)quality);
    farthest();
    sliver();
    thicket();
    lamp_in_line();
    runs();
    return check_report();
}
