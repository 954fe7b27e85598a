// SPDX-License-Identifier: BSD-3-Clause
// Scatter: what lies behind near pixels. Nobody has seen it; the best that a flat picture tells is what is seen around
// them. Far pixels reach there with their own pictures, sharp ones do not: so both are averaged over ever wider
// neighbourhoods, of which the nearest that holds anything counts most, up to about the near pixel's own radius: farther
// in its picture hides all.
//
// Half resolution, every other quad kept (no decimation): so that a shift by a quad moves the result and no more.
#include "scatter/behind.h"

#include <string.h>

#include "pixel/pass_c.h"
#include "scatter/kernels.h"

enum { WIDE = 7 };

// Planes: sharp colours x weight, far colours x weight, weights of both.
static int plane_count(int channels)
{
    return 2 * channels + 2;
}

// Is there anything in plane p of the block at hand?
static int has(const struct hf_behind *h, int p)
{
    return h->seen[p < 2 * h->channels ? p >= h->channels : p - 2 * h->channels];
}

int hf_behind_levels(float largest)
{
    int levels = 1;
    while (levels < HF_BEHIND_LEVELS && (float)(1 << levels) < 2 * hf_behind_span(largest))
        levels++;
    return largest > 0 ? levels : 0;
}

static int reach_of(int levels)
{
    return levels ? 1 << (levels - 1) : 0;  // and one more, for the upsampling
}

int hf_behind_halo(int levels)
{
    return levels ? reach_of(levels) + WIDE : 0;
}

// And room for a vector that begins within a row.
static int stride_of(int reach)
{
    return ((HF_BEHIND_BLOCK + 2 * reach + 15) & ~15) + HF_PAD;
}

size_t hf_behind_floats(int levels, int channels)
{
    const int reach = reach_of(levels), rows = HF_BEHIND_BLOCK + 2 * reach;
    const size_t plane = (size_t)(stride_of(reach) * rows), line = (size_t)(2 * stride_of(reach));
    const size_t wide = (size_t)((stride_of(reach) + 2 * WIDE) * (rows + 2 * WIDE));
    return levels ? (size_t)(2 * plane_count(channels) + 2) * plane + 3 * wide + 4 * line : 0;
}

// Is some pixel of the block, or of the quads around it, a near one?
static int has_near(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = hf_max(2 * r.x0 - 2, 0), x1 = hf_min(2 * r.x1 + 2, f->s->width);
    int near = 0;
    for (int y = hf_max(2 * r.y0 - 2, 0); y < hf_min(2 * r.y1 + 2, f->s->height); y++) {
        const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, 0, y);
        for (int x = x0; x < x1; x++)
            near += radius[x] < 0;
    }
    return near > 0;
}

// The largest near radius of each quad, of the planes and WIDE around; 0 beyond the frame.
static void load_near(const struct hf_behind *h, const struct hf_frame *f, float *near)
{
    const struct hf_setup *s = f->s;
    const int rows = h->rows + 2 * WIDE, x0 = h->x0 - WIDE, y0 = h->y0 - WIDE;
    const int from = hf_max(x0, 0), to = hf_min(x0 + h->columns + 2 * WIDE, s->half_width);
    memset(near, 0, sizeof(float) * (size_t)(h->near_stride * rows));
    for (int y = hf_max(2 * y0, 0); y < hf_min(2 * (y0 + rows), s->height); y++) {
        const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, 0, y);
        float *out = near + (ptrdiff_t)((y >> 1) - y0) * h->near_stride - x0;
        const int even = hf_min(to, s->width / 2);
        hf_scatter_kernels(f)->near_row(radius + 2 * from, even - from, out + from);
        // The odd width's last pixel is half a quad.
        if (even < to)
            out[even] = -radius[2 * even] > out[even] ? -radius[2 * even] : out[even];
    }
}

// The largest of each quad's neighbours up to WIDE = 1 + 2 + 4 away, each way. work: as large.
static void spread_near(const struct hf_behind *h, const struct hf_frame *f, const float *near, float *work, float *out)
{
    const ptrdiff_t stride = h->near_stride, all = stride * (h->rows + 2 * WIDE);
    const ptrdiff_t steps[] = {1, 2, 4, stride, 2 * stride, 4 * stride};
    for (int k = 0; k < 6; k++) {
        const float *in = k == 0 ? near : k & 1 ? work : out;
        float *to = k & 1 ? out : work;
        const ptrdiff_t step = steps[k];
        memcpy(to, in, sizeof(float) * (size_t)step);
        memcpy(to + all - step, in + all - step, sizeof(float) * (size_t)step);
        hf_scatter_kernels(f)->most_row(in, in + 2 * step, in + step, (int)(all - 2 * step), to + step);
    }
}

// Add a row of pixels, times its weights, to the sums of its quads.
static void add_row(const struct hf_frame *f, const float *v, const float *weight, float scale, int n, float *out)
{
    hf_scatter_kernels(f)->seen_row(v, weight, scale, n / 2, out);
    if (n & 1)
        out[n / 2] += v[n - 1] * (weight[n - 1] * scale);
}

// What of full-resolution row y is seen, added to its quads. line: three of two planes' rows, the last all 1.
static void load_row(struct hf_behind *h, const struct hf_frame *f, int y, float *line)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int x0 = hf_max(2 * h->x0, 0), n = hf_min(2 * (h->x0 + h->columns), f->s->width) - x0;
    const ptrdiff_t at = (ptrdiff_t)((y >> 1) - h->y0) * h->stride + x0 / 2 - h->x0;
    const float *widest = h->widest + (ptrdiff_t)((y >> 1) - h->y0) * h->near_stride - h->x0 + x0 / 2;
    float *const weight[2] = {line, line + 2 * h->stride}, *one = line + 4 * h->stride;
    const int some =
        hf_scatter_kernels(f)->seen_weights(t, hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y), widest, 0, n, weight);
    for (int k = 0; k < 2; k++) {
        if (!(some >> k & 1))
            continue;
        h->seen[k] = 1;
        for (int c = 0; c < h->channels; c++)
            add_row(f, hf_at(&f->buf[HF_BUF_SOURCE], c, x0, y), weight[k], t->dim, n,
                    h->level[k * h->channels + c] + at);
        add_row(f, one, weight[k], 1, n, h->level[2 * h->channels + k] + at);
    }
}

// Quads of the block and all around it that is read; 0 beyond the frame.
static void load(struct hf_behind *h, const struct hf_frame *f, float *line)
{
    h->seen[0] = h->seen[1] = 0;
    for (int x = 0; x < 2 * h->stride; x++)
        line[4 * h->stride + x] = 1;
    for (int p = 0; p < plane_count(h->channels); p++)
        memset(h->level[p], 0, sizeof(float) * (size_t)(h->stride * h->rows));
    for (int y = hf_max(2 * h->y0, 0); y < hf_min(2 * (h->y0 + h->rows), f->s->height); y++)
        load_row(h, f, y, line);
}

// The mean of three by three, `step` apart, of what lies `rim` or more inside the planes.
static void widen(const struct hf_behind *h, const struct hf_frame *f, float *level, float *line, int step, int rim)
{
    const ptrdiff_t stride = h->stride, down = step * stride;
    const int n = h->columns - 2 * rim;
    for (int y = rim - step; y < h->rows - rim + step; y++) {
        const float *in = level + y * stride + rim;
        hf_scatter_kernels(f)->third_row(in - step, in + step, in, n, line + y * stride + rim);
    }
    for (int y = rim; y < h->rows - rim; y++) {
        const float *in = line + y * stride + rim;
        hf_scatter_kernels(f)->third_row(in - down, in + down, in, n, level + y * stride + rim);
    }
}

// Add a level to the result, where a quad's largest near radius asks for it.
static void add_level(const struct hf_behind *h, const struct hf_frame *f, int j, const float *part)
{
    const int rim = h->reach - 1, n = h->columns - 2 * rim;
    for (int p = 0; p < plane_count(h->channels); p++)
        for (int y = rim; y < h->rows - rim && has(h, p); y++) {
            const ptrdiff_t at = (ptrdiff_t)y * h->stride + rim;
            if (j)
                hf_scatter_kernels(f)->add_part(h->level[p] + at, part + at, n, h->sum[p] + at);
            else
                memcpy(h->sum[p] + at, h->level[p] + at, sizeof(float) * (size_t)n);
        }
}

static void set_part(const struct hf_behind *h, const struct hf_frame *f, int j, float *part)
{
    const float share = 1 / (float)(1 << 2 * j), size = (float)(1 << j);
    for (int y = 0; y < h->rows; y++)
        hf_scatter_kernels(f)->part_row(h->near + (ptrdiff_t)y * h->near_stride, share, size, h->columns,
                                        part + (ptrdiff_t)y * h->stride);
}

int hf_behind_make(struct hf_behind *h, const struct hf_frame *f, struct hf_rect r, int levels, float *memory)
{
    if (!has_near(f, r))
        return 0;
    h->channels = hf_scatter(f->s)->opaque ? 3 : f->s->channels;
    h->reach = reach_of(levels);
    h->stride = stride_of(h->reach);
    h->x0 = r.x0 - h->reach;
    h->y0 = r.y0 - h->reach;
    h->columns = r.x1 - r.x0 + 2 * h->reach;
    h->rows = r.y1 - r.y0 + 2 * h->reach;
    const size_t plane = (size_t)(h->stride * (HF_BEHIND_BLOCK + 2 * h->reach));
    const int planes = plane_count(h->channels);
    for (int p = 0; p < planes; p++) {
        h->level[p] = memory + plane * (size_t)p;
        h->sum[p] = memory + plane * (size_t)(planes + p);
    }
    float *line = memory + plane * (size_t)(2 * planes), *part = line + plane, *near = part + plane;
    h->near_stride = h->stride + 2 * WIDE;
    const size_t wide = (size_t)(h->near_stride * (HF_BEHIND_BLOCK + 2 * h->reach + 2 * WIDE));
    load_near(h, f, near);
    spread_near(h, f, near, near + wide, near + 2 * wide);
    h->near = near + WIDE * h->near_stride + WIDE;
    h->widest = h->near + 2 * wide;
    load(h, f, near + 3 * wide);
    if (!h->seen[0] && !h->seen[1])
        return 0;
    add_level(h, f, 0, part);
    for (int j = 1; j < levels; j++) {
        for (int p = 0; p < planes; p++)
            if (has(h, p))
                widen(h, f, h->level[p], line, 1 << (j - 1), (1 << j) - 1);
        set_part(h, f, j, part);
        add_level(h, f, j, part);
    }
    return 1;
}

// Plane p at the pixels of a row, bilinearly; 0 where there is nothing in it.
static void sample(const struct hf_behind *h, const struct hf_behind_line *l, int p, float *out)
{
    const float *own = h->sum[p] + (ptrdiff_t)((l->y >> 1) - h->y0) * h->stride + (l->x >> 1) - h->x0;
    if (has(h, p))
        hf_scatter_kernels(l->f)->up_row(own, own + (l->y & 1 ? h->stride : -h->stride), (l->n + 1) / 2, out);
    else
        memset(out, 0, sizeof *out * (size_t)l->n);
}

int hf_behind_begin(const struct hf_behind *h, struct hf_behind_line *l, const float *radius)
{
    int near = 0;
    for (int i = 0; i < l->n; i++)
        near += radius[i] < 0;
    for (int k = 0; k < 2 && near; k++)
        sample(h, l, 2 * h->channels + k, l->weight[k]);
    return near > 0;
}

void hf_behind_row(const struct hf_behind *h, const struct hf_behind_line *l, const struct hf_scatter_row *row,
                   int channel, const float *own, float *out)
{
    for (int k = 0; k < 2; k++)
        sample(h, l, k * h->channels + channel, l->colour[k]);
    hf_scatter_kernels(l->f)->behind_blend(row, (const float *const *)l->weight, (const float *const *)l->colour, own,
                                           out);
}
