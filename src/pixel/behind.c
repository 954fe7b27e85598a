// SPDX-License-Identifier: BSD-3-Clause
// Disocclusion fill: what lies behind near pixels. One flat picture does not show that; the best guess is what is
// visible around them. Averages are taken over ever wider neighbourhoods, and the smallest that holds anything counts
// most. They extend to about the near pixel's own radius, because beyond it the pixel's sprite covers everything.
//
// The planes have half resolution. Wider levels keep all quads (no decimation), so a shift by a quad shifts the result
// and changes nothing else.
#include "pixel/behind.h"

#include <string.h>

#include "pixel/kernels.h"

enum { WIDE = 7 };

int hf_behind_levels(float largest)
{
    int levels = 1;
    while (levels < HF_BEHIND_LEVELS && (float)(1 << levels) < 2 * hf_behind_span(largest))
        levels++;
    return largest > 0 ? levels : 0;
}

static int reach_of(int levels)
{
    return levels ? 1 << (levels - 1) : 0;  // one more for upsampling
}

int hf_behind_halo(int levels)
{
    return levels ? reach_of(levels) + WIDE : 0;
}

// With room for a vector that begins inside a row.
static int stride_of(int reach)
{
    return ((HF_BEHIND_BLOCK + 2 * reach + 15) & ~15) + HF_PAD;
}

size_t hf_behind_floats(int levels, int planes)
{
    const int reach = reach_of(levels), rows = HF_BEHIND_BLOCK + 2 * reach;
    const size_t plane = (size_t)(stride_of(reach) * rows), line = (size_t)(2 * stride_of(reach));
    const size_t wide = (size_t)((stride_of(reach) + 2 * WIDE) * (rows + 2 * WIDE));
    return levels ? (size_t)(2 * planes + 2) * plane + 3 * wide + 3 * line : 0;
}

// Whether a quad of the block, or one next to it, is near. line: scratch.
static int has_near(const struct hf_behind_source *source, const struct hf_frame *f, struct hf_rect r, float *line)
{
    const int from = hf_max(r.x0 - 1, 0), to = hf_min(r.x1 + 1, f->s->half_width);
    memset(line, 0, sizeof *line * (size_t)(to - from));
    for (int y = hf_max(r.y0 - 1, 0); y < hf_min(r.y1 + 1, f->s->half_height); y++)
        source->near(f, y, from, to, line);
    for (int i = 0; i < to - from; i++)
        if (line[i] > 0)
            return 1;
    return 0;
}

// Load the largest near radius of each quad of the planes and WIDE quads around; 0 beyond the frame.
static void load_near(const struct hf_behind *h, const struct hf_behind_source *source, const struct hf_frame *f,
                      float *near)
{
    const struct hf_setup *s = f->s;
    const int rows = h->rows + 2 * WIDE, x0 = h->x0 - WIDE, y0 = h->y0 - WIDE;
    const int from = hf_max(x0, 0), to = hf_min(x0 + h->columns + 2 * WIDE, s->half_width);
    memset(near, 0, sizeof(float) * (size_t)(h->near_stride * rows));
    for (int y = hf_max(y0, 0); y < hf_min(y0 + rows, s->half_height) && !hf_stopped(s->stop); y++)
        source->near(f, y, from, to, near + (ptrdiff_t)(y - y0) * h->near_stride + from - x0);
}

// The largest near radius within WIDE = 1 + 2 + 4 quads in each direction. work is as large as near.
static void spread_near(const struct hf_behind *h, const struct hf_frame *f, const float *near, float *work, float *out)
{
    const ptrdiff_t stride = h->near_stride, all = stride * (h->rows + 2 * WIDE);
    const ptrdiff_t steps[] = {1, 2, 4, stride, 2 * stride, 4 * stride};
    for (int k = 0; k < 6 && !hf_stopped(f->s->stop); k++) {
        const float *in = k == 0 ? near : k & 1 ? work : out;
        float *to = k & 1 ? out : work;
        const ptrdiff_t step = steps[k];
        memcpy(to, in, sizeof(float) * (size_t)step);
        memcpy(to + all - step, in + all - step, sizeof(float) * (size_t)step);
        f->k->behind.most_row(in, in + 2 * step, in + step, (int)(all - 2 * step), to + step);
    }
}

void hf_behind_near(const struct hf_frame *f, const struct hf_buf *radii, int c, int q, int from, int to, float *out)
{
    const int even = hf_min(to, f->s->width / 2);
    for (int y = 2 * q; y < hf_min(2 * q + 2, f->s->height); y++) {
        const float *radius = hf_at(radii, c, 0, y);
        f->k->behind.near_row(radius + 2 * from, even - from, out);
        // At an odd width the last quad has one column.
        if (even < to && -radius[2 * even] > out[even - from])
            out[even - from] = -radius[2 * even];
    }
}

void hf_behind_add(const struct hf_frame *f, const float *v, const float *weight, float scale, int n, float *out)
{
    f->k->behind.seen_row(v, weight, scale, n / 2, out);
    if (n & 1)
        out[n / 2] += v[n - 1] * (weight[n - 1] * scale);
}

// Load the quads of the block and all around it that is read; 0 beyond the frame.
static void load(struct hf_behind *h, const struct hf_behind_source *source, const struct hf_frame *f, float *line)
{
    const int from = hf_max(h->x0, 0), to = hf_min(h->x0 + h->columns, f->s->half_width);
    h->seen = 0;
    for (int p = 0; p < h->planes; p++)
        memset(h->level[p], 0, sizeof(float) * (size_t)(h->stride * h->rows));
    for (int y = hf_max(h->y0, 0); y < hf_min(h->y0 + h->rows, f->s->half_height) && !hf_stopped(f->s->stop); y++) {
        float *plane[HF_BEHIND_PLANES];
        for (int p = 0; p < h->planes; p++)
            plane[p] = h->level[p] + (ptrdiff_t)(y - h->y0) * h->stride + from - h->x0;
        const float *widest = h->widest + (ptrdiff_t)(y - h->y0) * h->near_stride + from - h->x0;
        h->seen |= source->seen(f, y, from, to, widest, line, plane);
    }
}

// Replace each quad by the mean of 3 x 3 quads, `step` apart, at least `rim` inside the planes.
static void widen(const struct hf_behind *h, const struct hf_frame *f, float *level, float *line, int step, int rim)
{
    const ptrdiff_t stride = h->stride, down = step * stride;
    const int n = h->columns - 2 * rim;
    for (int y = rim - step; y < h->rows - rim + step && !hf_stopped(f->s->stop); y++) {
        const float *in = level + y * stride + rim;
        f->k->behind.third_row(in - step, in + step, in, n, line + y * stride + rim);
    }
    for (int y = rim; y < h->rows - rim && !hf_stopped(f->s->stop); y++) {
        const float *in = line + y * stride + rim;
        f->k->behind.third_row(in - down, in + down, in, n, level + y * stride + rim);
    }
}

// Add a level to the result, by the part that each quad's largest near radius gives it.
static void add_level(const struct hf_behind *h, const struct hf_frame *f, int j, const float *part)
{
    const int rim = h->reach - 1, n = h->columns - 2 * rim;
    for (int p = 0; p < h->planes && !hf_stopped(f->s->stop); p++)
        for (int y = rim; y < h->rows - rim && (h->seen >> p & 1); y++) {
            const ptrdiff_t at = (ptrdiff_t)y * h->stride + rim;
            if (j)
                f->k->behind.add_part(h->level[p] + at, part + at, n, h->sum[p] + at);
            else
                memcpy(h->sum[p] + at, h->level[p] + at, sizeof(float) * (size_t)n);
        }
}

static void set_part(const struct hf_behind *h, const struct hf_frame *f, int j, float *part)
{
    const float share = 1 / (float)(1 << 2 * j), size = (float)(1 << j);
    for (int y = 0; y < h->rows; y++)
        f->k->behind.part_row(h->near + (ptrdiff_t)y * h->near_stride, share, size, h->columns,
                              part + (ptrdiff_t)y * h->stride);
}

int hf_behind_make(struct hf_behind *h, const struct hf_behind_source *source, const struct hf_frame *f,
                   struct hf_rect r, int levels, float *memory)
{
    h->reach = reach_of(levels);
    h->stride = stride_of(h->reach);
    h->x0 = r.x0 - h->reach;
    h->y0 = r.y0 - h->reach;
    h->columns = r.x1 - r.x0 + 2 * h->reach;
    h->rows = r.y1 - r.y0 + 2 * h->reach;
    const size_t plane = (size_t)(h->stride * (HF_BEHIND_BLOCK + 2 * h->reach));
    const int planes = h->planes;
    for (int p = 0; p < planes; p++) {
        h->level[p] = memory + plane * (size_t)p;
        h->sum[p] = memory + plane * (size_t)(planes + p);
    }
    float *line = memory + plane * (size_t)(2 * planes), *part = line + plane, *near = part + plane;
    h->near_stride = h->stride + 2 * WIDE;
    const size_t wide = (size_t)(h->near_stride * (HF_BEHIND_BLOCK + 2 * h->reach + 2 * WIDE));
    if (!has_near(source, f, r, near))
        return 0;
    load_near(h, source, f, near);
    spread_near(h, f, near, near + wide, near + 2 * wide);
    h->near = near + WIDE * h->near_stride + WIDE;
    h->widest = h->near + 2 * wide;
    load(h, source, f, near + 3 * wide);
    if (!h->seen)
        return 0;
    add_level(h, f, 0, part);
    for (int j = 1; j < levels && !hf_stopped(f->s->stop); j++) {
        for (int p = 0; p < planes; p++)
            if (h->seen >> p & 1)
                widen(h, f, h->level[p], line, 1 << (j - 1), (1 << j) - 1);
        set_part(h, f, j, part);
        add_level(h, f, j, part);
    }
    return 1;
}

void hf_behind_sample(const struct hf_behind *h, const struct hf_frame *f, int p, int x, int y, int n, float *out)
{
    const float *own = h->sum[p] + (ptrdiff_t)((y >> 1) - h->y0) * h->stride + (x >> 1) - h->x0;
    if (h->seen >> p & 1)
        f->k->behind.up_row(own, own + (y & 1 ? h->stride : -h->stride), (n + 1) / 2, out);
    else
        memset(out, 0, sizeof *out * (size_t)n);
}
