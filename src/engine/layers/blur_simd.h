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
                               const int rows, const int channels, int n, int add, float *const out[5], uint8_t *any)
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
            const vf r = vf_load(in[5] + at), r2 = vf_mul(r, r);
            const vf weight = in[4] ? vf_load(in[4] + at) : vf_set1(1);
            if (x % 16 == 0)
                layers_ask_for(in, share, at + rows * stride, channels);
            const vm inside = vm_and(vf_gt(weight, vf_zero()), vm_and(vf_gt(r, before), vf_lt(r, after)));
            if (!vm_any(inside))
                continue;
            const vf a = vf_mul(vf_sub(r2, before_square), before_scale);
            const vf b = vf_fnma(vf_sub(r2, square), after_scale, vf_set1(1));
            const vf shown = vf_mul(vf_select(vf_lt(r, radius), a, b), scale);
            const vf w = vf_mul(shown, share ? vf_sub(weight, vf_load(share + at)) : weight);
            for (int c = 0; c < channels; c++)
                sum[c] = vf_select(inside, vf_fma(w, vf_load(in[c] + at), sum[c]), sum[c]);
            sum[4] = vf_add_where(inside, w, sum[4]);
        }
        any[x / 16] |= (uint8_t)vm_any(vf_gt(sum[4], vf_zero()));
        for (int c = 0; c < 5; c++)
            if (c < channels || c == 4)
                vf_store(out[c] + x, add ? vf_add(vf_load(out[c] + x), sum[c]) : sum[c]);
    }
}

HF_INLINE void layers_weigh_rows(const struct hf_slice *s, const float *const in[6], const float *share,
                                 ptrdiff_t stride, int rows, const int channels, int n, int add, float *const out[5],
                                 uint8_t *any)
{
    if (rows == 1)
        layers_weigh_of(s, in, share, stride, 1, channels, n, add, out, any);
    else if (rows == 2)
        layers_weigh_of(s, in, share, stride, 2, channels, n, add, out, any);
    else
        layers_weigh_of(s, in, share, stride, rows, channels, n, add, out, any);
}

static void layers_weigh_simd(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                              int rows, int channels, int n, int add, float *const out[5], uint8_t *any)
{
    if (channels == 0)
        layers_weigh_rows(s, in, share, stride, rows, 0, n, add, out, any);
    else
        HF_WITH_CHANNELS(channels, layers_weigh_rows(s, in, share, stride, rows, CHANNELS, n, add, out, any));
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
    hf_layers_fold_c(in + 2 * x, n - x, out + x);
}

// Draws two rows of sources at once, `side` vectors side by side: their contributions to a row of the result are added
// in registers. Where a sparse slice adds nothing, the result is neither read nor written.
HF_INLINE void layers_disc_of(const struct hf_slice *s, const float *upper, const float *lower, const int side,
                              const int sparse, int from, int to, float *out, ptrdiff_t stride)
{
    // Index 0 is the upper row, 1 the lower one. pair: the sum of the next pixel on either side of those in sum.
    vf sum[2][LAYERS_SIDE], last[2][LAYERS_SIDE], pair[2][LAYERS_SIDE];
    const float *const row[2] = {upper, lower};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < side; j++) {
            const vf middle = vf_load(row[i] + j * VF_N);
            sum[i][j] = last[i][j] = vf_zero();
            pair[i][j] = vf_add(middle, middle);
        }
    const int least = hf_layers_least_row(from, to);
    int have = -1;
    for (int d = s->rows - 1; d >= least; d--) {
        const struct hf_disc_row part = s->row[d];
        for (; have < part.n; have++)
            for (int i = 0; i < 2; i++)
                for (int j = 0; j < side; j++) {
                    const float *p = row[i] + j * VF_N;
                    sum[i][j] = have < 0 ? vf_load(p) : vf_add(sum[i][j], pair[i][j]);
                    pair[i][j] = vf_add(vf_load(p - have - 2), vf_load(p + have + 2));
                }
        vf v[2][LAYERS_SIDE];
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < side; j++)
                v[i][j] = vf_fma(vf_set1(part.f), pair[i][j], sum[i][j]);
        for (int i = 0; i < 2; i++) {
            const int y = i ? d + 1 : -d;
            for (int j = 0; y >= from && y < to && j < side; j++) {
                float *o = out + y * stride + j * VF_N;
                const vf more = vf_add(v[i][j], last[!i][j]);
                if (!sparse || vm_any(vf_ne(more, vf_zero())))
                    vf_store(o, vf_add(vf_load(o), more));
            }
        }
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < side; j++)
                last[i][j] = v[i][j];
    }
}

HF_INLINE void layers_disc_all(const struct hf_slice *s, const float *upper, const float *lower, int n,
                               const int sparse, int from, int to, float *out, ptrdiff_t stride)
{
    int x = 0;
    for (; x + LAYERS_SIDE * VF_N <= n; x += LAYERS_SIDE * VF_N)
        layers_disc_of(s, upper + x, lower + x, LAYERS_SIDE, sparse, from, to, out + x, stride);
    for (; x < n; x += VF_N)
        layers_disc_of(s, upper + x, lower + x, 1, sparse, from, to, out + x, stride);
}

static void layers_disc_simd(const struct hf_slice *s, const float *upper, const float *lower, int n, int from, int to,
                             float *out, ptrdiff_t stride)
{
    if (s->sparse)
        layers_disc_all(s, upper, lower, n, 1, from, to, out, stride);
    else
        layers_disc_all(s, upper, lower, n, 0, from, to, out, stride);
}
