// SPDX-License-Identifier: BSD-3-Clause
// Highlights: the part of a sample that is so bright against its surroundings that its disc's rim would show a coarser
// resolution's pixels. What stays in the slice is below BRIGHT_LEAST of the surroundings, at any exposure. A sample less than
// BRIGHT_PLAIN times as bright as they are has no highlight, or every pattern would be full of them. The surroundings are the
// darkest of five means: around the sample, and next to it on four sides. A disc's rim lies before those, and a lamp of
// several pixels must not hide itself in its own mean. Where a mean's pixels are transparent they count as bright as
// the sample: alpha has no shares, so it could not follow the colour there.
//
// A pixel has one share, its visible sample's. Behind a thin hair a lamp is the back of a mixed pixel; where that has more light
// above its cap, the pixel's two samples change places. Slices treat both alike. What asks later which of them is in front looks
// at their radii.
#include "engine/layers/highlights.h"

#include <math.h>
#include <string.h>

#include "pixel/pass_c.h"

// In half-resolution pixels: a mean's reach on either side of its middle, the distance of two means, the rows and columns that
// are made around a cell, the padding of a row. Columns are made from a cache line's beginning on.
enum { MEAN = 4, APART = 2 * MEAN + 1, REACH = HF_LAYERS_BRIGHT_REACH, WIDE = HF_LAYERS_BRIGHT_COLUMNS, PAD = 32 };
_Static_assert(MEAN + APART <= REACH && REACH <= WIDE && WIDE + 16 <= PAD, "what means read and vectors write");

static float root(float v)
{
    return v > 0 ? sqrtf(v) : 0;
}

void hf_layers_roots_c(const float *const above[3], const float *const below[3], int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float v[4];
        for (int i = 0; i < 2; i++) {
            v[i] = root(above[0][2 * x + i] + above[1][2 * x + i] + above[2][2 * x + i]);
            v[2 + i] = root(below[0][2 * x + i] + below[1][2 * x + i] + below[2][2 * x + i]);
        }
        out[x] = ((v[0] + v[2]) + (v[1] + v[3])) * 0.25f;
    }
}

void hf_layers_nine_c(const float *const in[9], int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float sum = in[4][x];
        for (int i = 1; i <= 4; i++)
            sum = sum + (in[4 - i][x] + in[4 + i][x]);
        out[x] = sum * (1.0f / 9);
    }
}

// How much of a sample's light lies below its cap; 1 if it is no highlight.
static float below_cap(const float *const in[6], const float *const around[5], const float *const covered[5], int x)
{
    const float r = in[5][x], light = in[0][x] + in[1][x] + in[2][x];
    float m = HUGE_VALF;
    for (int i = 0; i < 5; i++) {
        const float at = i ? around[i][x / 2] * HF_LAYERS_BESIDE : around[i][x / 2];
        const float v = covered ? at + hf_larger(1 - covered[i][x / 2], 0) * root(light) : at;
        m = v < m ? v : m;
    }
    const float cap = (m * m) * (HF_LAYERS_BRIGHT_PLAIN + (r * r) * (HF_LAYERS_BRIGHT_LEAST * 3.14159265f));
    return fabsf(r) > HF_LAYERS_FINE && light > cap ? cap / light : 1;
}

static void change_places(float *const seen[6], float *const mixed[6], int x)
{
    for (int i = 0; i < 6; i++)
        if (seen[i]) {
            const float of = seen[i][x];
            seen[i][x] = mixed[i][x];
            mixed[i][x] = of;
        }
}

// The light above the cap of a sample with that share. Samples are at most 2^125 (slices.c), so it is finite.
static float above_cap(const float *const in[6], int x, float share)
{
    return share * (in[0][x] + in[1][x] + in[2][x]);
}

// What changes places has no share at that moment, or there would be a jump: the share loses what the other sample has above its
// cap.
void hf_layers_shares_c(float *const seen[6], float *const mixed[6], const uint8_t *mixes, const float *const around[5],
                        const float *const covered[5], int n, float *out, uint8_t *any)
{
    for (int x = 0; x < n; x++) {
        float share = seen[4][x] * (1 - below_cap((const float *const *)seen, around, covered, x));
        if (mixes[x / 16] && mixed[4][x] > 0) {
            const float part = below_cap((const float *const *)mixed, around, covered, x) * HF_LAYERS_BEHIND;
            const float other = part < 1 ? mixed[4][x] * (1 - part) : 0;
            const float own_light = above_cap((const float *const *)seen, x, share),
                        other_light = above_cap((const float *const *)mixed, x, other);
            if (other_light > own_light) {
                change_places(seen, mixed, x);
                share = other - other * (own_light / other_light);
            } else if (other_light > 0)
                share = share - share * (other_light / own_light);
        }
        out[x] = share;
        any[x / 16] |= (uint8_t)(share > 0);
    }
}

static float nearest_of(const float *const row[2], int x)
{
    return fminf(fminf(row[0][2 * x], row[1][2 * x]), fminf(row[0][2 * x + 1], row[1][2 * x + 1]));
}

static float mean_of(const float *const row[2], int x)
{
    return ((row[0][2 * x] + row[1][2 * x]) + (row[0][2 * x + 1] + row[1][2 * x + 1])) * 0.25f;
}

void hf_layers_lamps_c(const float *const in[6], const struct hf_lamp_tap tap[HF_LAYERS_LAMP_TAPS], int n,
                       float *weight)
{
    for (int x = 0; x < n; x++) {
        const float light = (in[0][x] * fabsf(in[0][x]) + in[1][x] * fabsf(in[1][x])) + in[2][x] * fabsf(in[2][x]);
        const float own = root(light);
        float most = own, whole = own, seen = 0, sum = 0;
        for (int i = 0; i < HF_LAYERS_LAMP_TAPS; i++) {
            const float w = hf_saturate(nearest_of(tap[i].radius, x) - in[5][x] + 2);
            const float open = tap[i].alpha[0] ? hf_larger(1 - mean_of(tap[i].alpha, x), 0) : 0;
            const float v = open > 0 ? tap[i].root[x] + open * own : tap[i].root[x];
            if (i < HF_LAYERS_LAMP_NEXT) {
                most = most > w * v ? most : w * v;
                whole = whole > v ? whole : v;
                continue;
            }
            seen = seen + w;
            sum = sum + w * v;
        }
        const float mean = hf_larger(seen > 0 ? sum / seen : 0, whole * HF_LAYERS_LAMP_DARK);
        const float cap = mean * mean * HF_LAYERS_LAMP, brightest = most * most;
        if (in[4][x] > 0 && brightest > cap) {
            const float lamp = 1 - hf_saturate(2 * cap / brightest - 1);
            weight[x] = in[4][x] * (1 - hf_saturate(seen) * lamp);
        }
    }
}

// The floats of a row of a cell's means.
static ptrdiff_t stride_of(struct hf_rect cell)
{
    return ((cell.x1 - cell.x0 + 15) & ~15) + 2 * PAD;
}

// Rows of the scratch: means of colour and means of alpha, each with APART rows above and below; one row of means
// along columns; two rows of zeros; roots, with REACH rows above and below.
size_t hf_layers_highlight_floats(int width, int height)
{
    return (size_t)stride_of((struct hf_rect){0, 0, width, height}) *
           (2 * ((size_t)height + 2 * APART) + (size_t)height + 2 * REACH + 3);
}

// Where the roots of a cell's first quad are, behind the means.
static ptrdiff_t roots_from(ptrdiff_t stride)
{
    return (3 + REACH) * stride + PAD;
}

// Means around a cell of the square roots of three channels' sums. A channel below 0 is taken as zeros.
static void make_means(const struct hf_frame *f, struct hf_rect r, const int channel[3], float *scratch, float *mean)
{
    const struct hf_layers_kernels *k = hf_layers_kernels(f);
    const int width = r.x1 - r.x0, height = r.y1 - r.y0;
    const ptrdiff_t stride = stride_of(r);
    float *down = scratch + PAD, *none = scratch + stride, *roots = scratch + roots_from(stride);
    const float *in[9];
    memset(none, 0, sizeof(float) * 2 * (size_t)stride);
    for (int y = -REACH; y < height + REACH && !hf_stopped(f->s->stop); y++) {
        const float *row[2][3];
        for (int i = 0; i < 6; i++)
            row[i / 3][i % 3] = channel[i % 3] < 0 ? none
                                                   : hf_at(&f->buf[HF_LAYERS_BUF_COLOUR], channel[i % 3],
                                                           2 * (r.x0 - WIDE), 2 * (r.y0 + y) + i / 3);
        k->roots(row[0], row[1], width + 2 * WIDE, roots + y * stride - WIDE);
    }
    for (int y = -APART; y < height + APART && !hf_stopped(f->s->stop); y++) {
        for (int i = 0; i < 9; i++)
            in[i] = roots + (y + i - MEAN) * stride - WIDE;
        k->nine(in, width + 2 * WIDE, down - WIDE);
        // The outermost means, which nobody reads, are partly of what lies beside.
        for (int i = 0; i < 9; i++)
            in[i] = down + i - MEAN - WIDE;
        k->nine(in, width + 2 * WIDE, mean + y * stride - WIDE);
    }
}

// Scratch holds means of colours, then means of alphas. mean and cover point to the cell's first pixel in each.
static ptrdiff_t cover_from(struct hf_rect cell)
{
    return (cell.y1 - cell.y0 + 2 * APART) * stride_of(cell);
}

// What follows the means. It keeps the roots of colours, which are made last.
static ptrdiff_t rest_from(struct hf_rect cell)
{
    return cover_from(cell) + (cell.y1 - cell.y0 + 2 * APART) * stride_of(cell);
}

void hf_layers_highlight_means(const struct hf_frame *f, struct hf_rect cell, float *scratch)
{
    float *mean = scratch + APART * stride_of(cell) + PAD, *cover = mean + cover_from(cell);
    scratch += rest_from(cell);
    if (hf_layers(f->s)->channels == 4)
        make_means(f, cell, (const int[]){3, -1, -1}, scratch, cover);
    make_means(f, cell, (const int[]){0, 1, 2}, scratch, mean);
}

void hf_layers_leave_lamps(const struct hf_frame *f, struct hf_rect cell, struct hf_rect rows, const float *scratch)
{
    static const int8_t away[HF_LAYERS_LAMP_TAPS / 4] = {1, 5, 8};  // quads
    const float *roots = scratch + rest_from(cell) + roots_from(stride_of(cell));
    const int alpha = hf_layers(f->s)->channels == 4;
    for (int y = rows.y0; y < rows.y1 && !hf_stopped(f->s->stop); y++) {
        struct hf_lamp_tap tap[HF_LAYERS_LAMP_TAPS];
        float *in[6];
        for (int i = 0; i < HF_LAYERS_LAMP_TAPS; i++) {
            const int d = i % 2 ? away[i / 4] : -away[i / 4], dx = i & 2 ? 0 : d, dy = i & 2 ? d : 0;
            const int u = cell.x0 + dx, v = y + dy;
            tap[i].root = roots + (v - cell.y0) * stride_of(cell) + dx;
            for (int k = 0; k < 2; k++) {
                tap[i].radius[k] = hf_at(&f->buf[HF_LAYERS_BUF_RADIUS], 0, 2 * u, 2 * v + k);
                tap[i].alpha[k] = alpha ? hf_at(&f->buf[HF_LAYERS_BUF_COLOUR], 3, 2 * u, 2 * v + k) : NULL;
            }
        }
        hf_row(&f->buf[HF_LAYERS_BUF_QUADS], 3, cell.x0, y, in);
        for (int i = 0; i < 2; i++)
            in[4 + i] = hf_at(&f->buf[HF_LAYERS_BUF_QUADS_AT], i, cell.x0, y);
        hf_layers_kernels(f)->lamps((const float *const *)in, tap, cell.x1 - cell.x0, in[4]);
    }
}

// Reduce the shares of a row of samples behind the last slice of full resolution. Such a sample lies partly in that slice, and its
// part there must not cover the rest of it: the far stack is divided by what a cover leaves open (make_covers in slices.c). But
// nearest to the slice a cover is less than the sample's part, or it would cover at once. There a lamp's share would lose up to a
// ninth of its light to the lamp itself, so it is drawn as an ordinary sample, which loses none. From the cover's radius on shares
// grow to the whole, over as much of the squared radius as the cover took to grow.
static void begin_shares(const struct hf_layers *l, const float *radius, const uint8_t *bright, int n, float *share)
{
    for (int tile = 0; l->last >= 0 && tile * HF_LAYERS_TILE < n; tile++)
        for (int x = tile * HF_LAYERS_TILE; bright[tile] && x < hf_min(n, (tile + 1) * HF_LAYERS_TILE); x++) {
            const float r = radius[x], part = hf_saturate((r * r - l->cover->square) * l->cover->before_scale);
            share[x] = share[x] > 0 && r > 0 ? share[x] * part : share[x];
        }
}

void hf_layers_highlights(const struct hf_frame *f, struct hf_rect cell, struct hf_rect rows, const float *scratch,
                          const struct hf_layers_any *any)
{
    const int x0 = 2 * cell.x0, n = hf_min(2 * cell.x1, f->s->width) - x0, channels = hf_layers(f->s)->channels;
    const ptrdiff_t stride = stride_of(cell), apart[5] = {0, -APART, APART, -APART * stride, APART * stride};
    const float *mean = scratch + APART * stride + PAD, *cover = mean + cover_from(cell);
    for (int py = 2 * rows.y0; py < hf_min(2 * rows.y1, f->s->height) && !hf_stopped(f->s->stop); py++) {
        const float *around[5], *covered[5];
        float *seen[6] = {NULL}, *mixed[6] = {NULL};
        for (int i = 0; i < 5; i++) {
            around[i] = mean + (py / 2 - cell.y0) * stride + apart[i];
            covered[i] = cover + (py / 2 - cell.y0) * stride + apart[i];
        }
        hf_row(&f->buf[HF_LAYERS_BUF_SEEN], channels, x0, py, seen);
        hf_row(&f->buf[HF_LAYERS_BUF_MIXED], channels, x0, py, mixed);
        for (int i = 0; i < 2; i++) {
            seen[4 + i] = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], i, x0, py);
            mixed[4 + i] = hf_at(&f->buf[HF_LAYERS_BUF_MIXED_AT], i, x0, py);
        }
        hf_layers_kernels(f)->shares(seen, mixed, any->mixed, around, channels == 4 ? covered : NULL, n,
                                     hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 2, x0, py), any->bright);
        begin_shares(hf_layers(f->s), seen[5], any->bright, n, hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 2, x0, py));
    }
}
