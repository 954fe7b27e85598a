// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/edges.h"

#include <float.h>
#include <string.h>

#include "pixel/pass_c.h"

// 5 x 5 pixels are read around each pixel, and 3 x 3 radii around each of those. RIM: columns of margin in scratch.
enum { AROUND = 2, RIM = 4 };
// Kinds of scratch rows; each kind is a ring of SLOTS rows.
enum { RADIUS, BEYOND, SURE, MIDDLE, SLOPE, KINDS, SLOTS = 8 };

static ptrdiff_t stride_of(int width)
{
    return ((2 * width + 15) & ~15) + 2 * RIM + HF_PAD;
}

size_t hf_edges_floats(int width, int channels)
{
    return (size_t)stride_of(width) * (size_t)(KINDS * SLOTS + 5 * channels);
}

void hf_edges_start(struct hf_edges *e, const struct hf_frame *f, struct hf_rect r, float *work)
{
    const struct hf_setup *s = f->s;
    *e = (struct hf_edges){.f = f, .x0 = 2 * r.x0, .x1 = hf_min(2 * r.x1, s->width), .ring = work};
    e->left = hf_max(e->x0 - RIM, 0);
    e->right = hf_min(e->x1 + RIM, s->width);
    e->stride = stride_of(r.x1 - r.x0);
    e->colour = e->ring + KINDS * SLOTS * e->stride;
    e->radii_done = 2 * r.y0 - AROUND - 1;
    e->sure_done = 2 * r.y0 - AROUND;
    for (int i = 0; i < 5; i++)
        e->colours[i] = -1;
}

// A scratch row, at column x0.
static float *row_at(const struct hf_edges *e, int kind, int y)
{
    return e->ring + (kind * SLOTS + (y & (SLOTS - 1))) * e->stride + RIM;
}

// Fill the columns beyond the frame with its edge's.
static void repeat(const struct hf_edges *e, float *row)
{
    for (int x = e->x0 - RIM; x < e->left; x++)
        row[x - e->x0] = row[e->left - e->x0];
    for (int x = e->right; x < e->x1 + RIM; x++)
        row[x - e->x0] = row[e->right - 1 - e->x0];
}

// Write a row's radii, and in BEYOND by how much each exceeds the sharp radius. Radii up to that one are written as 0,
// so they jump there; BEYOND does not, and tells the sides apart. Rows beyond the frame repeat its edge's.
static void radius_row(struct hf_edges *e, int y)
{
    const int inside = hf_min(hf_max(y, 0), e->f->s->height - 1);
    const float sharp = e->f->s->sharp_radius;
    float *radius = row_at(e, RADIUS, y) + e->left - e->x0, *beyond = row_at(e, BEYOND, y) + e->left - e->x0;
    e->f->k->radius_row(e->f, e->left, inside, e->right - e->left, radius, NULL);
    for (int x = 0; x < e->right - e->left; x++) {
        const float r = radius[x];
        beyond[x] = r > sharp ? r - sharp : r < -sharp ? r + sharp : 0;
    }
    repeat(e, row_at(e, BEYOND, y));
}

static void sure_row(struct hf_edges *e, int y)
{
    const float *beyond[3];
    for (int i = 0; i < 3; i++)
        beyond[i] = row_at(e, BEYOND, y + i - 1) - RIM;
    e->f->k->edges.sure(beyond, e->x1 - e->x0 + 2 * RIM, row_at(e, SURE, y) - RIM, row_at(e, MIDDLE, y) - RIM,
                        row_at(e, SLOPE, y) - RIM);
}

// Not 0 if any of n numbers differs from `what`; none is NaN. Without a branch, so that the compiler uses vectors.
static uint32_t others(const float *v, int n, float what)
{
    uint32_t any = 0;
    for (int i = 0; i < n; i++)
        any |= hf_bits(v[i]) ^ hf_bits(what);
    return any;
}

int hf_edges_skip(const float *share, int i, int n)
{
    while (i + 32 <= n && !others(share + i, 32, 0))
        i += 32;
    while (i + 8 <= n && !others(share + i, 8, 0))
        i += 8;
    if (i + 4 <= n && !others(share + i, 4, 0))
        i += 4;
    while (i < n && !(share[i] > 0))
        i++;
    return i;
}

// A channel's row of colour, read on demand: only rows near mixed pixels are.
static const float *colour_row(struct hf_edges *e, int c, int y)
{
    const struct hf_setup *s = e->f->s;
    const int inside = hf_min(hf_max(y, 0), s->height - 1), place = inside % 5;
    float *rows = e->colour + (ptrdiff_t)place * s->channels * e->stride + RIM;
    if (e->colours[place] != inside) {
        float *row[4] = {NULL};
        for (int i = 0; i < s->channels; i++)
            row[i] = rows + i * e->stride + e->left - e->x0;
        hf_read_pixels(e->f, e->left / 2, inside, (e->right + 1) / 2 - e->left / 2, row, e->f->seen);
        for (int i = 0; i < s->channels; i++)
            repeat(e, rows + i * e->stride);
        e->colours[place] = inside;
    }
    return rows + c * e->stride;
}

int hf_edges_row(struct hf_edges *e, int y, const struct hf_sides *out)
{
    const int n = e->x1 - e->x0, channels = e->f->s->channels;
    for (; e->radii_done <= y + AROUND + 1; e->radii_done++)
        radius_row(e, e->radii_done);
    for (; e->sure_done <= y + AROUND; e->sure_done++)
        sure_row(e, e->sure_done);
    if (!others(row_at(e, SURE, y), n, 1)) {
        hf_read_pixels(e->f, e->x0 / 2, y, (n + 1) / 2, out->colour[0], e->f->seen);
        memcpy(out->radius[0], row_at(e, RADIUS, y), sizeof(float) * (size_t)n);
        memset(out->share, 0, sizeof(float) * (size_t)n);
        return 0;
    }
    struct hf_edge_row row = {.channels = channels,
                              .sharp = e->f->s->sharp_radius,
                              .own = row_at(e, RADIUS, y),
                              .middle = row_at(e, MIDDLE, y),
                              .slope = row_at(e, SLOPE, y)};
    for (int j = 0; j < 5; j++) {
        row.radius[j] = row_at(e, BEYOND, y + j - 2);
        row.sure[j] = row_at(e, SURE, y + j - 2);
        for (int c = 0; c < channels; c++)
            row.colour[j][c] = colour_row(e, c, y + j - 2);
    }
    e->f->k->edges.take(&row, n, out);
    return 1;
}

void hf_edges_sure_c(const float *const radius[3], int n, float *sure, float *middle, float *slope)
{
    for (int x = 0; x < n; x++) {
        float low = radius[1][x], high = low;
        for (int y = 0; y < 3; y++)
            for (int i = x ? -1 : 0; i <= 1; i++) {
                const float r = radius[y][x + i];
                low = r < low ? r : low;
                high = r > high ? r : high;
            }
        const float apart = high - low, least = apart > HF_EDGES_FROM ? apart : HF_EDGES_FROM;
        sure[x] = 1 - hf_saturate((apart - HF_EDGES_FROM) * HF_EDGES_GROWS);
        middle[x] = (low + high) * 0.5f;
        slope[x] = HF_EDGES_SIDES / least;
    }
}

// clang-format off
#define W(v) (HF_EDGES_SCALE * (v))
const float hf_edges_weights[5][5] = {
    {W(1 / 64.0f), W(1 / 25.0f), W(1 / 16.0f), W(1 / 25.0f), W(1 / 64.0f)},
    {W(1 / 25.0f), W(1 / 4.0f), W(1), W(1 / 4.0f), W(1 / 25.0f)},
    {W(1 / 16.0f), W(1), W(1), W(1), W(1 / 16.0f)},
    {W(1 / 25.0f), W(1 / 4.0f), W(1), W(1 / 4.0f), W(1 / 25.0f)},
    {W(1 / 64.0f), W(1 / 25.0f), W(1 / 16.0f), W(1 / 25.0f), W(1 / 64.0f)}};
#undef W
// clang-format on

// Weights of the 5 x 5 pixels on the front's and the back's side. The middle pixel is mixed, so only FAINT of it counts.
static void weigh(const struct hf_edge_row *row, int x, float w[2][5][5])
{
    for (int j = 0; j < 5; j++)
        for (int i = 0; i < 5; i++) {
            const int at = x + i - 2;
            const float sure = i == 2 && j == 2 ? 0 : row->sure[j][at];
            const float all = (sure + HF_EDGES_FAINT) * hf_edges_weights[j][i];
            w[0][j][i] = all * hf_edges_front(row->middle[x], row->slope[x], row->radius[j][at]);
            w[1][j][i] = all - w[0][j][i];
        }
}

// Add mirrored pairs first. v NULL: all are 1.
static float sum_of(const float w[5][5], const float *const v[5], int x)
{
    float column[5];
    for (int i = 0; i < 5; i++) {
        float t[5];
        for (int j = 0; j < 5; j++)
            t[j] = v ? w[j][i] * v[j][x + i - 2] : w[j][i];
        column[i] = t[2] + ((t[1] + t[3]) + (t[0] + t[4]));
    }
    return column[2] + ((column[1] + column[3]) + (column[0] + column[4]));
}

static float size_of(float v)
{
    return __builtin_fabsf(v);
}

// The front's share of the pixel: how far its colour lies from the back's towards the front's. Where no mixture of the
// two makes that colour, it is the share by depth, a0. Alpha is left out: it cannot be compared with colours, which
// have no unit.
static float share_of(const float own[4], float mean[2][4], float a0)
{
    float along = 0, apart = 0, largest = 0, off = 0;
    for (int c = 0; c < 3; c++) {
        const float f = mean[0][c], b = mean[1][c], d = size_of(hf_edges_between(own[c] - b, 0, f - b)),
                    whole = size_of(f - b);
        const float most = size_of(f) > size_of(b) ? size_of(f) : size_of(b);
        along = d > along ? d : along;
        apart = whole > apart ? whole : apart;
        largest = most > largest ? most : largest;
    }
    const float least = HF_EDGES_ALIKE * largest;
    if (!(apart > 0))
        return a0;
    const float a = (along + least * a0) / (apart + least);
    for (int c = 0; c < 3; c++) {
        const float rest = size_of(own[c] - (mean[1][c] + a * (mean[0][c] - mean[1][c])));
        off = rest > off ? rest : off;
    }
    return a0 + (a - a0) * (apart / (apart + off));
}

// The means of the two sides, of colours times SCALE and of radii.
static void side_means(const struct hf_edge_row *row, int x, float mean[2][4], float radius[2])
{
    float w[2][5][5];
    const float *v[5];
    weigh(row, x, w);
    for (int k = 0; k < 2; k++) {
        const float sum = sum_of(w[k], NULL, x), whole = sum * (1 / HF_EDGES_SCALE);
        radius[k] = sum_of(w[k], row->radius, x) / sum;
        for (int c = 0; c < row->channels; c++) {
            for (int j = 0; j < 5; j++)
                v[j] = row->colour[j][c];
            // A division, so that a mean of ones is exactly 1.
            mean[k][c] =
                hf_edges_between(sum_of(w[k], v, x) / whole, -FLT_MAX * HF_EDGES_SCALE, FLT_MAX * HF_EDGES_SCALE);
        }
    }
}

static float with_sharp(float r, float sharp)
{
    return r > 0 ? r + sharp : r < 0 ? r - sharp : 0;
}

static void take_pixel(const struct hf_edge_row *row, int x, const struct hf_sides *out)
{
    const float own = row->radius[2][x], a0 = hf_edges_front(row->middle[x], row->slope[x], own);
    float mean[2][4], radius[2], v[4];
    side_means(row, x, mean, radius);
    for (int c = 0; c < row->channels; c++)
        v[c] = row->colour[2][c][x] * HF_EDGES_SCALE;
    const float mixed = 1 - row->sure[2][x], given = share_of(v, mean, a0);
    const float of_front = hf_saturate((given - HF_EDGES_NOISE) * (1 / (1 - 2 * HF_EDGES_NOISE)));
    const float share = (float)(int32_t)(mixed * (1 - of_front) * HF_EDGES_PARTS) * (1.0f / HF_EDGES_PARTS);
    // The front's share of what is taken apart, from the rounded share. The rest of the pixel goes with the front. Its part
    // of what is seen is not rounded: near 0 that would give the pixel the front's light at once.
    const float a = 1 - share / mixed, seen = row->sure[2][x] + mixed * of_front;
    const float whole = seen > 0 ? row->sure[2][x] / seen : 0;
    for (int c = 0; c < row->channels; c++) {
        const float f = mean[0][c], b = mean[1][c], rest = v[c] - (b + a * (f - b));
        const float front = hf_edges_between(f + rest, f, v[c]), back = hf_edges_between(b + rest, b, v[c]);
        // Between the two: where both are the largest float, a rounding error more is Inf.
        const float both = hf_edges_between(front + whole * (v[c] - front), front, v[c]);
        out->colour[0][c][x] = both * (1 / HF_EDGES_SCALE);
        out->colour[1][c][x] = back * (1 / HF_EDGES_SCALE);
    }
    const float front = radius[0] + a0 * (own - radius[0]);
    out->share[x] = share;
    out->radius[0][x] = with_sharp(front + whole * (own - front), row->sharp);
    out->radius[1][x] = with_sharp(own + a0 * (radius[1] - own), row->sharp);
}

void hf_edges_take_c(const struct hf_edge_row *row, int n, const struct hf_sides *out)
{
    for (int x = 0; x < n; x++) {
        if (row->sure[2][x] < 1) {
            take_pixel(row, x, out);
            continue;
        }
        for (int c = 0; c < row->channels; c++)
            out->colour[0][c][x] = row->colour[2][c][x];
        out->radius[0][x] = row->own[x];
        out->share[x] = 0;
    }
}
