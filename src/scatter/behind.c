// SPDX-License-Identifier: BSD-3-Clause
// Scatter: what lies behind near pixels. Nobody has seen it; the best that a flat picture tells is what is seen around
// them. Far pixels reach there with their own pictures, sharp ones do not: so both are averaged over ever wider
// neighbourhoods, of which the nearest that holds anything counts most, up to about the near pixel's own radius: farther
// in its picture hides all.
//
// Half resolution, every other quad kept (no decimation): so that a shift by a quad moves the result and no more. All in
// C, in the same order everywhere.
#include "scatter/behind.h"

#include <string.h>

#include "pixel/pass_c.h"

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

// Half-resolution pixels across neighbourhood j are 2^(j+1) - 1; q: radius of the near pixel, or the largest of a quad.
static float span(float q)
{
    return 0.5f * q + 1;
}

int hf_behind_levels(float largest)
{
    int levels = 1;
    while (levels < HF_BEHIND_LEVELS && (float)(1 << levels) < 2 * span(largest))
        levels++;
    return largest > 0 ? levels : 0;
}

int hf_behind_reach(int levels)
{
    return levels ? 1 << (levels - 1) : 0;  // and one more, for the upsampling
}

int hf_behind_halo(int levels)
{
    return levels ? hf_behind_reach(levels) + WIDE : 0;
}

static int stride_of(int reach)
{
    return (HF_BEHIND_BLOCK + 2 * reach + 15) & ~15;
}

size_t hf_behind_floats(int levels, int channels)
{
    const int reach = hf_behind_reach(levels), rows = HF_BEHIND_BLOCK + 2 * reach;
    const size_t plane = (size_t)(stride_of(reach) * rows), line = (size_t)(2 * stride_of(reach));
    const size_t wide = (size_t)((stride_of(reach) + 2 * WIDE) * (rows + 2 * WIDE));
    return levels ? (size_t)(2 * plane_count(channels) + 2) * plane + 3 * wide + 3 * line : 0;
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

// Add n pixels of a row, v each times its weight, to the sums of their quads; the first is a quad's first.
static void add_row(const float *v, const float *weight, float scale, int n, float *out)
{
    for (int i = 0; i < n / 2; i++)
        out[i] += v[2 * i] * (weight[2 * i] * scale) + v[2 * i + 1] * (weight[2 * i + 1] * scale);
    if (n & 1)
        out[n / 2] += v[n - 1] * (weight[n - 1] * scale);
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
        for (int x = from; x < to; x++) {
            const float r = radius[2 * x], o = radius[hf_min(2 * x + 1, s->width - 1)], least = r < o ? r : o;
            out[x] = -least > out[x] ? -least : out[x];
        }
    }
}

// The largest of each quad's neighbours up to WIDE = 1 + 2 + 4 away, each way. work: as large.
static void spread_near(const struct hf_behind *h, const float *near, float *work, float *out)
{
    const ptrdiff_t stride = h->near_stride, all = stride * (h->rows + 2 * WIDE);
    const ptrdiff_t steps[] = {1, 2, 4, stride, 2 * stride, 4 * stride};
    for (int k = 0; k < 6; k++) {
        const float *in = k == 0 ? near : k & 1 ? work : out;
        float *to = k & 1 ? out : work;
        const ptrdiff_t step = steps[k];
        memcpy(to, in, sizeof(float) * (size_t)step);
        memcpy(to + all - step, in + all - step, sizeof(float) * (size_t)step);
        for (ptrdiff_t i = step; i < all - step; i++) {
            const float m = in[i - step] > in[i + step] ? in[i - step] : in[i + step];
            to[i] = m > in[i] ? m : in[i];
        }
    }
}

// What of full-resolution row y is seen, added to its quads.
static void load_row(struct hf_behind *h, const struct hf_frame *f, int y, float *line)
{
    const struct hf_scatter *t = hf_scatter(f->s);
    const int x0 = hf_max(2 * h->x0, 0), n = hf_min(2 * (h->x0 + h->columns), f->s->width) - x0;
    const ptrdiff_t at = (ptrdiff_t)((y >> 1) - h->y0) * h->stride + x0 / 2 - h->x0;
    const float *radius = hf_at(&f->buf[HF_BUF_RADIUS], 0, x0, y);
    float *sharp = line, *far = sharp + 2 * h->stride, *one = far + 2 * h->stride;
    int some[2] = {0};
    const float *widest = h->widest + (ptrdiff_t)((y >> 1) - h->y0) * h->near_stride - h->x0;
    for (int x = 0; x < n; x++) {
        // What is near itself is seen behind what is nearer, by twice its radius: not a slope behind itself.
        const float r = radius[x], nearer = hf_saturate(0.5f * widest[(x0 + x) >> 1] + r),
                    hardly = hf_saturate(1.5f + r);
        const float own = r > 0 ? hf_own_part(t, r) : nearer > hardly ? nearer : hardly, part = 0.25f;
        sharp[x] = part * own;
        far[x] = r > 0 ? part * (1 - own) : 0;
        one[x] = 1;
    }
    for (int x = 0; x < n; x++) {
        some[0] += sharp[x] > 0;
        some[1] += far[x] > 0;
    }
    for (int k = 0; k < 2; k++) {
        const float *weight = k ? far : sharp;
        h->seen[k] |= some[k] > 0;
        for (int c = 0; c < h->channels && some[k] > 0; c++)
            add_row(hf_at(&f->buf[HF_BUF_SOURCE], c, x0, y), weight, t->dim, n, h->level[k * h->channels + c] + at);
        if (some[k] > 0)
            add_row(one, weight, 1, n, h->level[2 * h->channels + k] + at);
    }
}

// Quads of the block and all around it that is read; 0 beyond the frame.
static void load(struct hf_behind *h, const struct hf_frame *f, float *line)
{
    h->seen[0] = h->seen[1] = 0;
    for (int p = 0; p < plane_count(h->channels); p++)
        memset(h->level[p], 0, sizeof(float) * (size_t)(h->stride * h->rows));
    for (int y = hf_max(2 * h->y0, 0); y < hf_min(2 * (h->y0 + h->rows), f->s->height); y++)
        load_row(h, f, y, line);
}

// The mean of three by three, `step` apart, of what lies `rim` or more inside the planes.
static void widen(const struct hf_behind *h, float *level, float *line, int step, int rim)
{
    const float third = 1 / 3.0f;
    const ptrdiff_t stride = h->stride, down = step * stride;
    for (int y = rim - step; y < h->rows - rim + step; y++) {
        const float *in = level + y * stride;
        float *out = line + y * stride;
        for (int x = rim; x < h->columns - rim; x++)
            out[x] = third * ((in[x - step] + in[x + step]) + in[x]);
    }
    for (int y = rim; y < h->rows - rim; y++) {
        const float *in = line + y * stride;
        float *out = level + y * stride;
        for (int x = rim; x < h->columns - rim; x++)
            out[x] = third * ((in[x - down] + in[x + down]) + in[x]);
    }
}

// Add a level to the result, where a quad's largest near radius asks for it.
static void add_level(const struct hf_behind *h, int j, const float *part)
{
    const int rim = h->reach - 1;
    for (int p = 0; p < plane_count(h->channels); p++)
        for (int y = rim; y < h->rows - rim && has(h, p); y++) {
            const float *in = h->level[p] + (ptrdiff_t)y * h->stride, *k = part + (ptrdiff_t)y * h->stride;
            float *out = h->sum[p] + (ptrdiff_t)y * h->stride;
            for (int x = rim; x < h->columns - rim; x++)
                out[x] = j ? out[x] + k[x] * in[x] : in[x];
        }
}

static void set_part(const struct hf_behind *h, int j, float *part)
{
    const float share = 1 / (float)(1 << 2 * j), size = (float)(1 << j);
    for (int y = 0; y < h->rows; y++)
        for (int x = 0; x < h->columns; x++) {
            const ptrdiff_t i = (ptrdiff_t)y * h->stride + x;
            part[i] = share * hf_saturate(2 - size / span(h->near[(ptrdiff_t)y * h->near_stride + x]));
        }
}

int hf_behind_make(struct hf_behind *h, const struct hf_frame *f, struct hf_rect r, int levels, float *memory)
{
    if (!has_near(f, r))
        return 0;
    h->channels = hf_scatter(f->s)->opaque ? 3 : f->s->channels;
    h->reach = hf_behind_reach(levels);
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
    spread_near(h, near, near + wide, near + 2 * wide);
    h->near = near + WIDE * h->near_stride + WIDE;
    h->widest = h->near + 2 * wide;
    load(h, f, near + 3 * wide);
    if (!h->seen[0] && !h->seen[1])
        return 0;
    add_level(h, 0, part);
    for (int j = 1; j < levels; j++) {
        for (int p = 0; p < planes; p++)
            if (has(h, p))
                widen(h, h->level[p], line, 1 << (j - 1), (1 << j) - 1);
        set_part(h, j, part);
        add_level(h, j, part);
    }
    return 1;
}

// Plane p at the near pixels of a row, bilinearly; 0 where there is nothing in it.
static void sample(const struct hf_behind *h, const struct hf_behind_line *l, int p, float *out)
{
    const float *own = h->sum[p] + (ptrdiff_t)((l->y >> 1) - h->y0) * h->stride - h->x0;
    const float *over = own + (l->y & 1 ? h->stride : -h->stride);
    const int first = (l->x >> 1) - 1, n = h->columns - 2 * h->reach + 2;
    if (!has(h, p)) {
        memset(out, 0, sizeof *out * (size_t)l->count);
        return;
    }
    for (int i = 0; i < n; i++)
        l->quad[i] = 0.75f * own[first + i] + 0.25f * over[first + i];
    for (int k = 0; k < l->count; k++) {
        const int x = l->x + l->at[k], a = (x >> 1) - first;
        out[k] = 0.75f * l->quad[a] + 0.25f * l->quad[x & 1 ? a + 1 : a - 1];
    }
}

static float mix(float a, float b, float t)
{
    return t < 1 ? hf_lerp(a, b, t) : b;
}

void hf_behind_begin(const struct hf_behind *h, struct hf_behind_line *l, int x, int y, int n, const float *radius)
{
    l->x = x;
    l->y = y;
    l->count = 0;
    for (int i = 0; i < n; i++) {
        l->at[l->count] = i;
        l->count += radius[i] < 0;
    }
    for (int k = 0; k < 2; k++)
        sample(h, l, 2 * h->channels + k, l->weight[k]);
}

void hf_behind_row(const struct hf_behind *h, const struct hf_behind_line *l, const struct hf_scatter_row *row,
                   int channel, const float *own, float *out)
{
    // Less than the outermost pixel of the widest neighbourhood weighs: there is no edge to what is seen.
    const float nothing = 1e-8f;
    for (int k = 0; k < 2; k++)
        sample(h, l, k * h->channels + channel, l->colour[k]);
    for (int k = 0; k < l->count; k++) {
        const int i = l->at[k];
        const float far_weight = row->far ? row->far_weight[i] : 0, near_weight = row->near ? row->near_weight[i] : 0;
        const float mine = own[i] * hf_scatter(row->setup)->dim;
        const float front = near_weight > 0 ? row->near[i] / near_weight : mine;
        const float far = far_weight > 0 ? row->far[i] / far_weight : mine;
        const float reached = hf_saturate(16 * far_weight), sharp = l->weight[0][k], blurred = l->weight[1][k];
        float v = mix(front, far, reached);
        if (sharp + blurred > 0) {
            float seen = v;
            if (blurred > 0)
                seen = mix(l->colour[1][k] / blurred, far, reached);
            if (sharp > 0)
                seen = mix(seen, l->colour[0][k] / sharp, sharp / (sharp + blurred));
            v = mix(seen, v, nothing / (sharp + blurred + nothing));
        }
        out[i] = v;
    }
}
