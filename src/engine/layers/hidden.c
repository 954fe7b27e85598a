// SPDX-License-Identifier: BSD-3-Clause
// Hidden samples: what lies behind a silhouette, where a lens, being larger than a point, sees past it. They come from
// the farthest of the surroundings, at distances that double from level to level.
#include "engine/layers/hidden.h"

#include <math.h>

#include "pixel/pass_c.h"

// What others see in a pixel: the back of a mixed one, else the pixel itself. share is the back's part. A pixel with a
// tiny back is partly itself, or its quad would jump from one surface to the other.
static float behind_of(const float *const seen[6], const float *const mixed[6], int at, float *weight)
{
    const float m = mixed[4][at], part = HF_LAYERS_EDGE * m, less = hf_saturate(1 - part * part);
    const float own = m > 0 ? seen[4][at] * (less * less) : seen[4][at];
    *weight = m > 0 ? m + own : own;
    return m > 0 ? m / *weight : 0;
}

static float between(const float *const seen[6], const float *const mixed[6], int c, int at, float share)
{
    return share > 0 ? share * mixed[c][at] + (1 - share) * seen[c][at] : seen[c][at];
}

void hf_layers_quads_c(const float *const seen[2][6], const float *const mixed[2][6], int channels, int n,
                       float *const out[6])
{
    for (int x = 0; x < n; x++) {
        float weight[4], share[4], radius[4], farthest = HF_LAYERS_NOTHING, sum = 0, r = 0, colour[4] = {0};
        for (int i = 0; i < 4; i++) {
            const int y = i >> 1, at = 2 * x + (i & 1);
            share[i] = behind_of(seen[y], mixed[y], at, &weight[i]);
            radius[i] = between(seen[y], mixed[y], 5, at, share[i]);
            farthest = weight[i] > 0 && radius[i] > farthest ? radius[i] : farthest;
        }
        for (int i = 0; i < 4; i++) {
            const int y = i >> 1, at = 2 * x + (i & 1);
            const float near = 1 - (farthest - radius[i]) * 0.5f, g = weight[i] * (near > 0 ? near : 0);
            sum = sum + g;
            r = r + g * radius[i];
            for (int c = 0; c < channels; c++)
                colour[c] = colour[c] + g * hf_layers_root(between(seen[y], mixed[y], c, at, share[i]));
        }
        const float inverse = sum > 0 ? 1 / sum : 0;
        out[4][x] = sum * 0.25f;
        out[5][x] = sum > 0 ? r * inverse : HF_LAYERS_NOTHING;
        for (int c = 0; c < channels; c++)
            out[c][x] = colour[c] * inverse;
    }
}

// A row of samples: colour, weight (4), radius (5).
static void row_of(const struct hf_frame *f, int colour, int at, int x, int y, float *row[6])
{
    hf_row(&f->buf[colour], hf_layers(f->s)->channels, x, y, row);
    row[4] = hf_at(&f->buf[at], 0, x, y);
    row[5] = hf_at(&f->buf[at], 1, x, y);
}

// The farthest sample of n quads, and the radius of the nearest that hides.
static void quads_of(const struct hf_frame *f, float *const seen[2][6], float *const mixed[2][6], int n,
                     float *const out[6], float *nearest, int vectors)
{
    const float *radius[4] = {seen[0][5], seen[1][5], mixed[0][5], mixed[1][5]},
                *weight[4] = {seen[0][4], seen[1][4], mixed[0][4], mixed[1][4]};
    const struct hf_layers_kernels *k = hf_layers_kernels(f);
    const int channels = hf_layers(f->s)->channels;
    (vectors ? k->quads : hf_layers_quads_c)((const float *const(*)[6])seen, (const float *const(*)[6])mixed, channels,
                                             n, out);
    (vectors ? k->nearest : hf_layers_nearest_c)(radius, weight, n, nearest);
}

void hf_layers_quads_pass(const struct hf_frame *f, struct hf_rect r)
{
    const int n = hf_min(r.x1, f->s->width / 2) - r.x0;
    for (int y = r.y0; y < r.y1; y++) {
        float *seen[2][6] = {{NULL}}, *mixed[2][6] = {{NULL}}, *out[6] = {NULL};
        float *nearest = hf_at(&f->buf[HF_LAYERS_BUF_QUADS_AT], 2, r.x0, y);
        for (int i = 0; i < 2; i++) {
            const int py = hf_min(2 * y + i, f->s->height - 1);
            row_of(f, HF_LAYERS_BUF_SEEN, HF_LAYERS_BUF_SEEN_AT, 2 * r.x0, py, seen[i]);
            row_of(f, HF_LAYERS_BUF_MIXED, HF_LAYERS_BUF_MIXED_AT, 2 * r.x0, py, mixed[i]);
        }
        row_of(f, HF_LAYERS_BUF_QUADS, HF_LAYERS_BUF_QUADS_AT, r.x0, y, out);
        quads_of(f, seen, mixed, n, out, nearest, 1);
        if (r.x0 + n == r.x1)
            continue;
        // At an odd width the last pixel is paired with itself.
        float pair[2][2][6][2], *one[2][2][6];
        for (int i = 0; i < 24; i++) {
            const float *in = i < 12 ? seen[i / 6 % 2][i % 6] : mixed[i / 6 % 2][i % 6];
            float *to = pair[i / 12][i / 6 % 2][i % 6];
            to[0] = to[1] = in ? in[2 * n] : 0;
            one[i / 12][i / 6 % 2][i % 6] = to;
        }
        for (int c = 0; c < 6; c++)
            out[c] = out[c] ? out[c] + n : NULL;
        quads_of(f, one[0], one[1], 1, out, nearest + n, 0);
    }
}

void hf_layers_merge_c(const float *const in[3][6], int channels, float slope, int n, float *const out[6])
{
    for (int x = 0; x < n; x++) {
        const float a = in[0][5][x], b = in[1][5][x], c = in[2][5][x];
        const float ab = a > b ? a : b, farthest = ab > c ? ab : c;
        float g[3], sum = 0;
        for (int i = 0; i < 3; i++) {
            const float near = 1 - (farthest - in[i][5][x]) * slope;
            g[i] = in[i][4][x] * (near > 0 ? near : 0);
        }
        sum = g[0] + g[1] + g[2];
        const float inverse = sum > 0 ? 1 / sum : 0;
        for (int k = 0; k < channels; k++)
            out[k][x] = (g[0] * in[0][k][x] + g[1] * in[1][k][x] + g[2] * in[2][k][x]) * inverse;
        const float r = (g[0] * a + g[1] * b + g[2] * c) * inverse;
        out[4][x] = sum * (1.0f / 3);
        out[5][x] = sum > 0 ? r : HF_LAYERS_NOTHING;
    }
}

static void add_tap(const struct hf_hidden_tap *tap, ptrdiff_t at, int channels, const float *nearest, int n,
                    float *const sum[7])
{
    const float *const *in = tap->in;
    for (int x = 0; x < n; x++, at++) {
        const float behind = in[5][at] - nearest[x];
        const float a = hf_saturate((behind - tap->from) * tap->scale);
        const float v = tap->part * a * hf_saturate(9 * in[4][at]) * hf_layers_hides(behind - 1);
        const float w = v > HF_LAYERS_SOME ? v : 0;
        for (int c = 0; c < channels; c++)
            sum[c][x] = sum[c][x] + w * in[c][at];
        sum[4][x] = sum[4][x] + w;
        sum[5][x] = w > 0 ? sum[5][x] + w * in[5][at] : sum[5][x];
        sum[6][x] = sum[6][x] + w * tap->whole;
    }
}

void hf_layers_taps_c(const struct hf_hidden_tap *const *tap, int count, ptrdiff_t at, int channels,
                      const float *nearest, int n, float *const sum[7])
{
    for (int i = 0; i < count; i++)
        add_tap(tap[i], at, channels, nearest, n, sum);
}

// The first surface behind `nearest` on one side of a line; several samples may make it up. end: weighted sums of
// colour, radius (4) and distance (5). Returns the sum of the weights.
static float side_of(const struct hf_hidden_line *line, int side, int steps, const float *const in[6], int channels,
                     int x, float nearest, float end[6])
{
    float open = 1, whole = 0;
    for (int i = 0; i < steps; i++) {
        const ptrdiff_t at = line->side[side][i] + x;
        const float behind = in[5][at] - nearest, seen = hf_saturate(behind * (1.0f / 3) + (1 - line->away[i]));
        const float part = open * (hf_saturate(9 * in[4][at]) * (hf_layers_hides(behind - 1) * seen));
        open = open - part;
        whole = whole + part;
        for (int c = 0; c < channels; c++)
            end[c] = end[c] + part * in[c][at];
        end[4] = end[4] + part * in[5][at];
        end[5] = end[5] + part * line->away[i];
    }
    return whole;
}

void hf_layers_between_c(const struct hf_hidden_line *line, int steps, const float *const in[6], int channels,
                         const float *nearest, int n, float *const sum[7])
{
    for (int x = 0; x < n; x++) {
        float end[2][6] = {{0}}, whole[2], inverse[2];
        for (int i = 0; i < 2; i++) {
            whole[i] = side_of(line, i, steps, in, channels, x, nearest[x], end[i]);
            inverse[i] = whole[i] > 0 ? 1 / whole[i] : 0;
        }
        const float r0 = end[0][4] * inverse[0], r1 = end[1][4] * inverse[1];
        const float t0 = end[0][5] * inverse[0], t1 = end[1][5] * inverse[1], t = t0 < t1 ? t0 : t1;
        const float behind = (r0 + r1) * 0.5f - nearest[x], apart = behind > 1 ? behind : 1;
        const float alike = hf_saturate(2 - fabsf(r0 - r1) * HF_LAYERS_UNLIKE / apart);
        const float square = t * t, fourth = square * square;
        const float both = whole[0] * whole[1] * alike, v = both * HF_LAYERS_BETWEEN / (fourth * fourth);
        const float w = v > HF_LAYERS_SOME ? v : 0;
        if (!(w > 0))
            continue;
        const float share = w / (t0 + t1), g0 = share * t1 * inverse[0], g1 = share * t0 * inverse[1];
        for (int c = 0; c < channels; c++)
            sum[c][x] = sum[c][x] + g0 * end[0][c] + g1 * end[1][c];
        sum[4][x] = sum[4][x] + w;
        sum[5][x] = sum[5][x] + g0 * end[0][4] + g1 * end[1][4];
        sum[6][x] = sum[6][x] + both * HF_LAYERS_REACHED;
    }
}

void hf_layers_quad_rows(const struct hf_frame *f, int x, int y, const float *radius[4], const float *weight[4])
{
    for (int i = 0; i < 4; i++) {
        const struct hf_buf *of = &f->buf[i < 2 ? HF_LAYERS_BUF_SEEN_AT : HF_LAYERS_BUF_MIXED_AT];
        weight[i] = hf_at(of, 0, 2 * x, 2 * y + i % 2);
        radius[i] = hf_at(of, 1, 2 * x, 2 * y + i % 2);
    }
}

// From which radius on a pixel in row `row` of a quad hides. The nearer of its samples is the front.
static float hides_from(const float *const radius[4], const float *const weight[4], int row, int at)
{
    const int two = weight[2 + row][at] > 0, swapped = two && radius[2 + row][at] < radius[row][at];
    const float front = radius[swapped ? 2 + row : row][at], back = radius[swapped ? row : 2 + row][at];
    const float some = weight[swapped ? 2 + row : row][at] * HF_LAYERS_THIN;
    return two && some < 1 ? some * (front - back) + back : front;
}

void hf_layers_nearest_c(const float *const radius[4], const float *const weight[4], int n, float *out)
{
    for (int x = 0; x < n; x++) {
        const float r[4] = {hides_from(radius, weight, 0, 2 * x), hides_from(radius, weight, 1, 2 * x),
                            hides_from(radius, weight, 0, 2 * x + 1), hides_from(radius, weight, 1, 2 * x + 1)};
        const float left = r[0] < r[1] ? r[0] : r[1], right = r[2] < r[3] ? r[2] : r[3];
        out[x] = left < right ? left : right;
    }
}

// How much of pixel i of a quad lies before a radius: its visible sample, and the back of a mixed one.
static float before_of(const float *const radius[4], const float *const weight[4], int x, int i, float limit)
{
    const int row = i >> 1, at = 2 * x + (i & 1);
    const float mixed =
        weight[2 + row][at] > 0 ? weight[2 + row][at] * hf_layers_hides(limit - radius[2 + row][at]) : 0;
    return weight[row][at] * hf_layers_hides(limit - radius[row][at]) + mixed;
}

void hf_layers_found_c(const float *const sum[7], const float *const radius[4], const float *const weight[4],
                       int channels, int n, float *const out[6])
{
    for (int x = 0; x < n; x++) {
        const float inverse = sum[4][x] > 0 ? 1 / sum[4][x] : 0, r = sum[5][x] * inverse;
        float before[4];
        for (int i = 0; i < 4; i++)
            before[i] = before_of(radius, weight, x, i, r - 1);
        const float all = ((before[0] + before[2]) + (before[1] + before[3])) * 0.25f;
        out[4][x] = sum[4][x] > 0 ? all * hf_saturate(sum[6][x]) : 0;
        out[5][x] = r;
        for (int c = 0; c < channels; c++)
            out[c][x] = sum[c][x] * inverse;
    }
}

void hf_layers_spread_c(const float *const in[6], const float *const radius[4], const float *const weight[4], int row,
                        int channels, int n, float *const out[6])
{
    for (int x = 0; x < n; x++) {
        const float r = in[5][x], w = in[4][x];
        float before[4];
        for (int i = 0; i < 4; i++)
            before[i] = w > 0 ? before_of(radius, weight, x, i, r - 1) : 0;
        const float sum = (before[0] + before[2]) + (before[1] + before[3]), part = sum > 0 ? 4 * w / sum : 0;
        for (int i = 0; i < 2; i++) {
            for (int c = 0; c < channels; c++)
                out[c][2 * x + i] = in[c][x];
            out[4][2 * x + i] = (part < 1 ? part : 1) * before[2 * row + i];
            out[5][2 * x + i] = r;
        }
    }
}

static float roots_of(const float *const in[6], int x)
{
    return fabsf(in[0][x]) + fabsf(in[1][x]) + fabsf(in[2][x]);
}

// Splits a sample's weight in a mean around radius r, i being its place in the line: *of is the part that is as far as
// r; returns the rest.
static float in_line(float weight, float radius, float r, int i, float *of)
{
    const float line = weight > 0 ? hf_layers_line(i) * hf_saturate(HF_LAYERS_WHOLE * weight) : 0;
    const float alike = 1 - fabsf((weight > 0 ? radius : 0) - r) * (1.0f / HF_LAYERS_ALIKE);
    *of = line * (alike > 0 ? alike : 0);
    return line - *of;
}

// Weights of samples that are as far and of others, and the others' weights times their absolute radii.
struct company {
    float like, others, size;
};

static void add_company(struct company *c, float of, float rest, float weight, float radius)
{
    c->like = c->like + of;
    c->others = c->others + rest;
    c->size = c->size + rest * fabsf(weight > 0 ? radius : 0);
}

static float lonely(const struct company *c, float r)
{
    return hf_layers_lonely(r, c->like, c->others, c->size);
}

// How close a sample's colour is to that of the middle one.
static float shade(const float *const in[6], const float *const middle[6], int x, float apart)
{
    const float off = fabsf(in[0][x] - middle[0][x]) + fabsf(in[1][x] - middle[1][x]) + fabsf(in[2][x] - middle[2][x]);
    const float v = 1 - off * apart;
    return v > HF_LAYERS_OTHER ? v : HF_LAYERS_OTHER;
}

void hf_layers_smooth_c(const float *const in[13][6], const float *const along[2], int channels, int n,
                        float *const out[6])
{
    for (int x = 0; x < n; x++) {
        const float r = in[HF_LAYERS_SMOOTH][5][x], weight = in[HF_LAYERS_SMOOTH][4][x];
        if (!(weight > 0)) {
            for (int c = 0; c < 6; c++)
                if (c < channels || c >= 4)
                    out[c][x] = 0;
            continue;
        }
        float of[HF_LAYERS_TAPS], rest[HF_LAYERS_TAPS], alone = 0, sum = 0, radius = 0, colour[4] = {0};
        struct company line = {0}, across = {0};
        for (int i = 0; i < HF_LAYERS_TAPS; i++) {
            rest[i] = in_line(in[i][4][x], in[i][5][x], r, i, &of[i]);
            add_company(&line, of[i], rest[i], in[i][4][x], in[i][5][x]);
        }
        for (int i = 0; along && i < HF_LAYERS_TAPS; i++) {
            const int at = x + i - HF_LAYERS_SMOOTH;
            float near;
            const float far = in_line(along[0][at], along[1][at], r, i, &near);
            add_company(&across, near, far, along[0][at], along[1][at]);
        }
        if (along) {
            const float here = lonely(&line, r), there = lonely(&across, r);
            alone = here < there ? here : there;
        }
        const float middle = roots_of(in[HF_LAYERS_SMOOTH], x), plain = middle * HF_LAYERS_GLARE;
        const float apart = HF_LAYERS_SHADES / (middle > HF_LAYERS_SOME ? middle : HF_LAYERS_SOME);
        for (int i = 0; i < HF_LAYERS_TAPS; i++) {
            const float near = of[i] * shade(in[i], in[HF_LAYERS_SMOOTH], x, apart),
                        all = alone * (rest[i] - near) + near,
                        g = all > 0 ? all * hf_layers_dimmed(roots_of(in[i], x), plain) : 0;
            if (!(g > 0))
                continue;
            sum = sum + g;
            radius = radius + g * in[i][5][x];
            for (int c = 0; c < channels; c++)
                colour[c] = colour[c] + g * in[i][c][x];
        }
        const float inverse = sum > HF_LAYERS_SOME ? 1 / sum : 0;
        out[4][x] = weight;
        out[5][x] = radius * inverse;
        for (int c = 0; c < channels; c++) {
            const float v = colour[c] * inverse;
            out[c][x] = along ? v * fabsf(v) : v;
        }
    }
}

void hf_layers_extremes_c(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows,
                          struct hf_layers_range *out)
{
    struct hf_layers_range range = *out;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < n; x++) {
            const ptrdiff_t at = y * stride + x;
            const float r = radius[at];
            const int counts = !weight || weight[at] > 0;
            range.low = counts && r < range.low ? r : range.low;
            range.high = counts && r > range.high ? r : range.high;
        }
    *out = range;
}

int hf_layers_inside_c(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows, float before,
                       float after)
{
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < n; x++) {
            const ptrdiff_t at = y * stride + x;
            if ((!weight || weight[at] > 0) && radius[at] > before && radius[at] < after)
                return 1;
        }
    return 0;
}
