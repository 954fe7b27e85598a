// SPDX-License-Identifier: BSD-3-Clause
// Scatter: slices of the far field. Farther pixels have larger sprites, which reach over nearer pixels, but those
// occlude them. So radii are drawn in slices, each three times as far as the one before. A slice gets only the coverage
// that the nearer slices, and the visible part of a sharp pixel, leave of 1. Where weights add up to 1, the slices' sum
// does too.
#include <float.h>
#include <math.h>

#include "engine/scatter/known.h"
#include "engine/scatter/walk.h"

// Radius where the second slice begins; ratio of one slice's radius to the next; ratio over which a source fades in.
static const float first = 4, step = 3, soft = 1.25f;

int hf_scatter_slice_count(float largest)
{
    int count = 1;
    for (float from = first; from < largest && count < HF_SLICES; from *= step)
        count++;
    return count;
}

struct hf_scatter_slice hf_scatter_slice_make(const struct hf_scatter *t, int k)
{
    float from = first / step;
    for (int i = 0; i < k; i++)
        from *= step;
    const float to = from * step;
    struct hf_scatter_slice s = {.begin = {from, from * soft}, .end = {to, to * soft}};
    if (k == 0)
        s.begin[0] = -2, s.begin[1] = -1;
    if (k == t->slices - 1)
        s.end[0] = 0.5f * FLT_MAX, s.end[1] = FLT_MAX;
    return s;
}

void hf_scatter_slice_range(const struct hf_frame *f, struct hf_rect r, float *least, float *most)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int x0 = hf_max(2 * (r.x0 - t->around_x), 0), x1 = hf_min(2 * (r.x1 + t->around_x), f->s->width);
    const int y0 = hf_max(2 * (r.y0 - t->around_y), 0), y1 = hf_min(2 * (r.y1 + t->around_y), f->s->height);
    float low = FLT_MAX, high = 0;
    for (int y = y0; y < y1 && !hf_stopped(f->s->stop); y++) {
        const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y);
        // The bits of positive floats have their order, and the compiler compares whole numbers on vectors.
        int32_t from = (int32_t)hf_bits(low), to = (int32_t)hf_bits(high);
        for (int x = 0; x < x1 - x0; x++) {
            const int32_t own = (int32_t)hf_bits(radius[x]), far = own > 0 ? own : INT32_MAX;
            from = far < from ? far : from;
            to = own > to ? own : to;
        }
        low = hf_from_bits((uint32_t)from);
        high = hf_from_bits((uint32_t)to);
        for (int i = 0, n = x1 - x0; i < HF_BACKS; i++) {
            struct hf_backs b;
            if (!hf_scatter_backs(f, i, x0, y, &b))
                continue;
            for (int x = hf_edges_next(b.share, 0, n); x < n; x = hf_edges_next(b.share, x + 1, n)) {
                low = b.radius[x] > 0 && b.radius[x] < low ? b.radius[x] : low;
                high = b.radius[x] > high ? b.radius[x] : high;
            }
        }
    }
    *least = low;
    *most = high;
}

void hf_slice_row_c(const struct hf_scatter_slice *s, float sign, const float *radius, int channels, int n,
                    float *const row[4])
{
    for (int x = 0; x < n; x++) {
        const float part = hf_scatter_slice_part(s, sign * radius[x]);
        for (int c = 0; c < 4; c++)
            if (c == 3 || c < channels)
                row[c][x] *= part;
    }
}

// The part of a pixel in which far sprites can show, from its two sides by their shares.
static float room_at(const struct hf_scatter *t, const float *const at[3], int x)
{
    const float front = 1 - hf_own_part(t, fabsf(at[0][x])), share = at[1] ? at[1][x] : 0;
    return share > 0 ? hf_lerp(front, 1 - hf_own_part(t, fabsf(at[2][x])), share) : front;
}

void hf_slice_behind_c(const struct hf_scatter *t, const float *const at[3], float *const slice[4], int n,
                       float *const to[4])
{
    for (int x = 0; x < n; x++) {
        const float own = slice[3][x], left = fmaxf(room_at(t, at, x) - to[3][x], 0),
                    part = left < own ? left / own : 1;
        if (!(own > 0))
            continue;
        for (int c = 0; c < 4; c++)
            if (to[c])
                to[c][x] += slice[c][x] * part;
    }
}

void hf_scatter_slice_behind(const struct hf_frame *f, struct hf_rect r, const struct hf_target *to,
                             const struct hf_target *slice)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0, y0 = 2 * r.y0, y1 = hf_min(2 * r.y1, f->s->height);
    for (int y = y0; y < y1 && !hf_stopped(f->s->stop); y++) {
        const float *at[3] = {hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y), hf_back_shares(f, x0, y, n)};
        float *row[4], *out[4];
        if (at[1])
            at[2] = hf_at(&f->buf[HF_BUF_BACK_AT], 1, x0, y);
        for (int c = 0; c < 4; c++) {
            row[c] = to->ch[c] ? slice->ch[c] + (y - y0) * slice->stride : NULL;
            out[c] = to->ch[c] ? to->ch[c] + (y - y0) * to->stride : NULL;
        }
        hf_scatter_kernels(f)->slice_behind(t, at, row, n, out);
    }
}
