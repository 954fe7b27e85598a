// SPDX-License-Identifier: BSD-3-Clause
// The sources of a slice and its disc on vectors. The order of operations is that of blur.c.
#include "engine/layers/kernels.h"
#include "simd/simd.h"

enum { LAYERS_SIDE = 2 };  // vectors of a disc side by side

// Prefetch the next row's samples. Runs of tiles are too short for the processor's own prefetchers.
HF_INLINE void layers_ask_for(const float *const in[6], const float *share, ptrdiff_t at, const int channels)
{
    for (int c = 0; c < 6; c++)
        if (c < channels || c == 5 || (c == 4 && in[4]))
            __builtin_prefetch(in[c] + at);
    if (share)
        __builtin_prefetch(share + at);
}

HF_INLINE void layers_weigh_of(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                               const int rows, const int channels, const int whole, int n, int add, float *const out[5],
                               uint8_t *any)
{
    const vf radius = vf_set1(s->radius), before = vf_set1(s->before), after = vf_set1(s->after);
    const vf square = vf_set1(s->square), before_square = vf_set1(s->before_square);
    const vf before_scale = vf_set1(s->before_scale), after_scale = vf_set1(s->after_scale), scale = vf_set1(s->scale);
    for (int x = 0; x < n; x += VF_N) {
        vf sum[5];
        for (int c = 0; c < 5; c++)
            sum[c] = vf_zero();
        for (int y = 0; y < rows; y++) {
            const ptrdiff_t at = y * stride + x;
            const vf r = vf_load(in[5] + at), weight = whole ? vf_set1(1) : vf_load(in[4] + at);
            if (x % 16 == 0)
                layers_ask_for(in, share, at + rows * stride, channels);
            vm inside = vm_and(vf_gt(r, before), vf_lt(r, after));
            if (!whole)
                inside = vm_and(inside, vf_gt(weight, vf_zero()));
            if (!vm_any(inside))
                continue;
            const vf r2 = vf_mul(r, r), a = vf_mul(vf_sub(r2, before_square), before_scale);
            const vf b = vf_fnma(vf_sub(r2, square), after_scale, vf_set1(1));
            const vf shown = vf_mul(vf_select(vf_lt(r, radius), a, b), scale);
            const vf left = share ? vf_sub(weight, vf_load(share + at)) : weight;
            const vf w = vf_keep(inside, whole && !share ? shown : vf_mul(shown, left));
            for (int c = 0; c < channels; c++) {
                const vf more = vf_fma(w, vf_load(in[c] + at), sum[c]);
                // A sample without weight has no defined colour.
                sum[c] = whole ? more : vf_select(inside, more, sum[c]);
            }
            sum[4] = vf_add(sum[4], w);
        }
        any[x / 16] |= (uint8_t)vm_any(vf_gt(sum[4], vf_zero()));
        for (int c = 0; c < 5; c++)
            if (c < channels || c == 4)
                vf_store(out[c] + x, add ? vf_add(vf_load(out[c] + x), sum[c]) : sum[c]);
    }
}

HF_INLINE void layers_weigh_rows(const struct hf_slice *s, const float *const in[6], const float *share,
                                 ptrdiff_t stride, int rows, const int channels, const int whole, int n, int add,
                                 float *const out[5], uint8_t *any)
{
    if (rows == 1)
        layers_weigh_of(s, in, share, stride, 1, channels, whole, n, add, out, any);
    else if (rows == 2)
        layers_weigh_of(s, in, share, stride, 2, channels, whole, n, add, out, any);
    else
        layers_weigh_of(s, in, share, stride, rows, channels, whole, n, add, out, any);
}

HF_INLINE void layers_weigh_all(const struct hf_slice *s, const float *const in[6], const float *share,
                                ptrdiff_t stride, int rows, const int channels, int n, int add, float *const out[5],
                                uint8_t *any)
{
    if (in[4])
        layers_weigh_rows(s, in, share, stride, rows, channels, 0, n, add, out, any);
    else
        layers_weigh_rows(s, in, share, stride, rows, channels, 1, n, add, out, any);
}

static void layers_weigh_simd(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                              int rows, int channels, int n, int add, float *const out[5], uint8_t *any)
{
    if (channels == 0)
        layers_weigh_all(s, in, share, stride, rows, 0, n, add, out, any);
    else
        HF_WITH_CHANNELS(channels, layers_weigh_all(s, in, share, stride, rows, CHANNELS, n, add, out, any));
}

// Reads and writes whole vectors only inside its arrays: n may be less than a vector.
static void layers_fold_simd(const float *in, int n, float *out)
{
    int x = 0;
    for (; x + VF_N <= n; x += VF_N) {
        vf even, odd;
        vf_unzip(vf_load(in + 2 * x), vf_load(in + 2 * x + VF_N), &even, &odd);
        vf_store(out + x, vf_add(even, odd));
    }
    if (x < n)
        hf_layers_fold_c(in + 2 * x, n - x, out + x);
}

// Whether a pixel within reach of a vector differs from 0 in either row.
static int layers_reached(const float *upper, const float *lower, int reach)
{
    vi any = vi_or(vi_load(upper + reach), vi_load(lower + reach));
    for (int x = -reach; x < reach; x += VF_N)
        any = vi_or(any, vi_or(vi_load(upper + x), vi_load(lower + x)));
    return vi_any(any);
}

// Two rows of sources, `side` vectors side by side. Index 0 is the upper row, 1 the lower one. sum: of the pixels up to `have`
// from each; pair: the sum of the next one on either side, but the pixel itself while there are none.
struct layers_disc {
    const float *row[2];
    vf sum[2][LAYERS_SIDE], pair[2][LAYERS_SIDE];
    ptrdiff_t have;
};

// What both rows add as row `part` of the disc.
HF_INLINE void layers_disc_part(struct layers_disc *s, const int side, const struct hf_disc_row *part,
                                vf to[2][LAYERS_SIDE])
{
    for (; s->have < part->n; s->have++)
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < side; j++) {
                const float *p = s->row[i] + j * VF_N;
                s->sum[i][j] = vf_add(s->sum[i][j], s->pair[i][j]);
                s->pair[i][j] = vf_add(vf_load(p - s->have - 2), vf_load(p + s->have + 2));
            }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < side; j++)
            to[i][j] = vf_fma(vf_set1(part->f), s->pair[i][j], s->sum[i][j]);
}

// Adds what a source row adds now, and the other one added before.
HF_INLINE void layers_disc_add(float *out, const int side, const vf now[LAYERS_SIDE], const vf last[LAYERS_SIDE])
{
    for (int j = 0; j < side; j++)
        vf_store(out + j * VF_N, vf_add(vf_load(out + j * VF_N), vf_add(now[j], last[j])));
}

// Draws two rows of sources at once: their contributions to a row of the result are added in registers.
HF_INLINE void layers_disc_of(const struct hf_slice *s, const float *upper, const float *lower, const int side,
                              int from, int to, float *out, ptrdiff_t stride)
{
    struct layers_disc rows = {.row = {upper, lower}, .have = -1};
    vf one[2][LAYERS_SIDE], two[2][LAYERS_SIDE];
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < side; j++) {
            rows.sum[i][j] = two[i][j] = vf_zero();
            rows.pair[i][j] = vf_load(rows.row[i] + j * VF_N);
        }
    // From row `whole` of the disc on, all it adds is among from..to. Such rows are drawn in pairs, down to row 0.
    const int last = s->rows - 1, whole = hf_min(hf_min(-from, to - 2), last),
              least = whole < 0 ? hf_layers_least_row(from, to) : (whole + 1) & ~1;
    const struct hf_disc_row *part = s->row + last;
    float *above = out - last * stride, *below = out + (last + 1) * stride;
    int d = last;
    for (; d >= least; d--, part--, above += stride, below -= stride) {
        layers_disc_part(&rows, side, part, one);
        if (-d >= from && -d < to)
            layers_disc_add(above, side, one[0], two[1]);
        if (d + 1 >= from && d + 1 < to)
            layers_disc_add(below, side, one[1], two[0]);
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < side; j++)
                two[i][j] = one[i][j];
    }
    for (; whole >= 0 && d > 0; d -= 2, part -= 2, above += 2 * stride, below -= 2 * stride) {
        layers_disc_part(&rows, side, part, one);
        layers_disc_add(above, side, one[0], two[1]);
        layers_disc_add(below, side, one[1], two[0]);
        layers_disc_part(&rows, side, part - 1, two);
        layers_disc_add(above + stride, side, two[0], one[1]);
        layers_disc_add(below - stride, side, two[1], one[0]);
    }
}

// The same for all planes.
HF_INLINE void layers_disc_planes(const struct hf_slice *s, const struct hf_layers_sources *in, const int side, int x)
{
    for (int i = 0; i < in->planes; i++)
        layers_disc_of(s, in->upper + i * in->plane + x, in->lower + i * in->plane + x, side, in->from, in->to,
                       in->out + i * in->out_plane + x, in->stride);
}

// Vectors that no source reaches get nothing: spans are wider than their sources need, and small things fill few pixels. Weights
// tell for all planes.
static void layers_disc_simd(const struct hf_slice *s, const struct hf_layers_sources *in)
{
    const float *upper = in->upper + (in->planes - 1) * in->plane, *lower = in->lower + (in->planes - 1) * in->plane;
    int x = 0;
    while (x < in->n)
        if (!layers_reached(upper + x, lower + x, s->reach)) {
            x += VF_N;
        } else if (x + LAYERS_SIDE * VF_N <= in->n) {
            layers_disc_planes(s, in, LAYERS_SIDE, x);
            x += LAYERS_SIDE * VF_N;
        } else {
            layers_disc_planes(s, in, 1, x);
            x += VF_N;
        }
}
