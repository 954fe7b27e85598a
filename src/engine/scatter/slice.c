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
        for (int x = 0; x < x1 - x0; x++) {
            const float v = radius[x] > 0 ? radius[x] : FLT_MAX;
            low = v < low ? v : low;
            high = radius[x] > high ? radius[x] : high;
        }
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

void hf_scatter_slice_row(const struct hf_scatter_slice *s, float sign, const float *radius, int n, float *row)
{
    for (int x = 0; x < n; x++)
        row[x] *= hf_scatter_slice_part(s, sign * radius[x]);
}

// The part of a pixel in which far sprites can show, from its two sides by their shares.
static float room_at(const struct hf_frame *f, int x, int y)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const float front = 1 - hf_own_part(t, fabsf(*hf_at(&f->buf[HF_BUF_RADIUS], 0, x, y)));
    const float share = t->mixed ? *hf_at(&f->buf[HF_BUF_BACK_AT], 0, x, y) : 0;
    if (!(share > 0))
        return front;
    return hf_lerp(front, 1 - hf_own_part(t, fabsf(*hf_at(&f->buf[HF_BUF_BACK_AT], 1, x, y))), share);
}

void hf_scatter_slice_behind(const struct hf_frame *f, struct hf_rect r, const struct hf_target *to,
                             const struct hf_target *slice)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0, y0 = 2 * r.y0, y1 = hf_min(2 * r.y1, f->s->height);
    for (int y = y0; y < y1 && !hf_stopped(f->s->stop); y++) {
        const ptrdiff_t at = (y - y0) * to->stride, from = (y - y0) * slice->stride;
        for (int x = 0; x < n; x++) {
            float *weight = &to->ch[3][at + x];
            const float own = slice->ch[3][from + x], left = fmaxf(room_at(f, x0 + x, y) - *weight, 0);
            if (!(own > 0))
                continue;
            const float part = left < own ? left / own : 1;
            for (int c = 0; c < 3; c++)
                if (to->ch[c])
                    to->ch[c][at + x] += slice->ch[c][from + x] * part;
            *weight += own * part;
        }
    }
}
