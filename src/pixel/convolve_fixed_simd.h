// SPDX-License-Identifier: BSD-3-Clause
// Convolution with symmetric tap sets whose lattice is known at compile time, of radius FIXED_R at most. An engine
// that has such sets makes a column function for each by FIXED_COLUMN.
//
// The function walks down one vector of columns and keeps all sums in registers. For each input row it adds up the
// mirrored pairs h[j] of samples, and adds them, weighted, to the 2 r + 1 output rows that the input row reaches. The
// sum of an output row moves to the next register as an input row is added to it, which an instruction of three
// operands does for free. So each output row is stored once, and no pair is stored. The only loads are the weights and
// the shifted samples.
#ifndef HF_CONVOLVE_FIXED_SIMD_H
#define HF_CONVOLVE_FIXED_SIMD_H

#include "pixel/convolve.h"
#include "pixel/format_vf.h"

enum { FIXED_R = 8, FIXED_STRIP = 64 / VF_N };
// Four lanes have no load that repeats a number: the weights are laid out four times each.
enum { WEIGHT_N = VF_N == 4 ? 4 : 1 };

// Rows of weights: bits 0 to 8 say which columns they have, bit j for |dx| = j; from bit 12 on comes the run of weights of 1
// around the middle, 0 if there is none, else one more than how far it reaches (a disc). Sums of discs are scaled when they are
// complete.
#define RUN(reach) (((reach) + 1) << 12)

// Are these the weights of such rows, whatever their step? (A disc of 1 has no runs.)
HF_INLINE int fixed_are(const struct hf_taps *t, const uint16_t *rows, int r, int disc)
{
    if ((r > 1 && t->runs != disc) || !t->symmetric || t->nx != r || t->ny != r)
        return 0;
    for (int k = 0; k <= r; k++) {
        unsigned columns = 0;
        for (int i = t->first[k]; i < t->first[k + 1]; i++)
            columns |= 1u * (t->column[i] > r ? RUN(t->column[i] - r - 1) : 1 << t->column[i]);
        if (columns != rows[k])
            return 0;
    }
    return 1;
}

// Sums of pairs from the middle on, behind the pairs.
HF_INLINE void fixed_runs(const int r, vf *h)
{
    vf *sum = h + FIXED_R + 1;
    sum[0] = h[0];
    HF_UNROLL(8)
    for (int j = 1; j < r; j++)
        sum[j] = vf_add(sum[j - 1], h[j]);
}

// step: NULL for 1.
HF_INLINE void fixed_pairs(const float *p, const int r, const ptrdiff_t *step, vf *h)
{
    h[0] = vf_load(p);
    if (step) {
        HF_UNROLL(8)
        for (int j = 1; j <= r; j++)
            h[j] = vf_add(vf_load(p - j * *step), vf_load(p + j * *step));
        return;
    }
#if VF_ALIGNED_ONLY
    // A vector of 64 bytes that is not aligned is two loads. The right neighbours are shifted out of aligned ones: half
    // of the values, as shifts share a pipe with the sums.
    const vf next = vf_load(p + VF_N);
#define PAIR(j)                                                                                                        \
    if (j <= r)                                                                                                        \
    h[j] = vf_add(vf_load(p - j), vf_align(h[0], next, j))
    PAIR(1);
    PAIR(2);
    PAIR(3);
    PAIR(4);
    PAIR(5);
    PAIR(6);
    PAIR(7);
    PAIR(8);
#undef PAIR
#else
    HF_UNROLL(8)
    for (int j = 1; j <= r; j++)
        h[j] = vf_add(vf_load(p - j), vf_load(p + j));
#endif
}

HF_INLINE vf fixed_weight(const float *weight, int i)
{
    return WEIGHT_N == 1 ? vf_set1(weight[i]) : vf_load(weight + i * WEIGHT_N);
}

// Row k's sum. The weights lie one after the other; where each one is, is known when this is compiled. Fused, the
// weight of the taps on the axes is used once for all of row 0, and its product with h[0], axis, starts the other even
// rows: 32 multiply-adds for radius 6 instead of 36, at the price of two additions, which have units of their own.
HF_INLINE vf fixed_sum(const uint16_t *rows, const int k, const int r, const vf *h, const float *weight, vf axis,
                       const int disc)
{
    int n = 0;
    HF_UNROLL(8)
    for (int i = 0; i < k; i++)
        n += __builtin_popcount(rows[i] & 0xfff) + (rows[i] >> 12 != 0);
    vf sum = vf_zero();
    int j = 0;
    if (disc && rows[k] >> 12) {
        sum = h[FIXED_R + (rows[k] >> 12)];
        n++;
    }
    if (HF_FUSED && !disc && k == 0) {
        vf even = h[2];
        HF_UNROLL(4)
        for (int i = 4; i <= r; i += 2)
            even = vf_add(even, h[i]);
        return vf_fma(fixed_weight(weight, 0), h[0], vf_mul(fixed_weight(weight, 1), even));
    }
    if (HF_FUSED && !disc && k % 2 == 0) {
        sum = axis;
        j++;
        n++;
    }
    HF_UNROLL(9)
    for (; j <= r; j++)
        if (rows[k] >> j & 1)
            sum = vf_fma(fixed_weight(weight, n++), h[j], sum);
    return sum;
}

// An input row d rows outside of the strip, which is known when this is compiled: it reaches the first r - d + 1 output rows from that
// edge on. sums[i] is that of output row i from there.
HF_INLINE void fixed_edge_row(const uint16_t *rows, const int r, const int disc, const float *weight, vf scale,
                              const float *in, const ptrdiff_t *step, const int d, const int top, vf *sums)
{
    if (d > r)
        return;
    vf h[2 * FIXED_R + 2];
    fixed_pairs(in, r, step, h);
    if (disc)
        fixed_runs(r, h);
    __builtin_prefetch(in + 2 * VF_N);
    const vf axis = disc ? vf_zero() : vf_mul(fixed_weight(weight, 1), h[0]);
    HF_UNROLL(8)
    for (int k = r; k >= 1; k--)
        if (k >= d) {
            const vf sum = fixed_sum(rows, k, r, h, weight, axis, disc);
            sums[k - d] = top && k == r ? sum : vf_add(sums[k - d], sum);
            if (disc && !top && k == r)
                sums[k - d] = vf_mul(sums[k - d], scale);
        }
}

// All input rows outside of the strip, above it or below it. in, out: the strip's first row from there on.
HF_INLINE void fixed_edges(const uint16_t *rows, const int r, const int disc, const float *weight, vf scale,
                           const float *in, ptrdiff_t in_stride, const ptrdiff_t *step, const int top, float *out,
                           ptrdiff_t out_stride, int height)
{
    vf sums[FIXED_R];
    HF_UNROLL(8)
    for (int i = 0; i < r; i++)
        sums[i] = top || i >= height ? vf_zero() : vf_load(out + i * out_stride);
#define EDGE(i)                                                                                                        \
    fixed_edge_row(rows, r, disc, weight, scale, in - (top ? r + 1 - i : i) * in_stride, step,                         \
                   i > r ? r + 1                                                                                       \
                   : top ? r + 1 - i                                                                                   \
                         : i,                                                                                          \
                   top, sums)
    EDGE(1);
    EDGE(2);
    EDGE(3);
    EDGE(4);
    EDGE(5);
    EDGE(6);
    EDGE(7);
    EDGE(8);
#undef EDGE
    HF_UNROLL(8)
    for (int i = 0; i < r && i < height; i++)
        vf_store(out + i * out_stride, sums[i]);
}

// The rows of the strip itself; sums[i] is that of the output row r - i above the one at hand.
HF_INLINE void fixed_inside(const uint16_t *rows, const int r, const int disc, const float *weight, vf scale,
                            const float *in, ptrdiff_t in_stride, const ptrdiff_t *step, float *out,
                            ptrdiff_t out_stride, int height)
{
    vf sums[2 * FIXED_R + 1];
    HF_UNROLL(17)
    for (int i = 0; i <= 2 * r; i++)
        sums[i] = i > r && i - r - 1 < height ? vf_load(out + (i - r - 1) * out_stride) : vf_zero();
    for (int y = 0; y < height; y++) {
        const float *p = in + y * in_stride;
        vf h[2 * FIXED_R + 2], row[FIXED_R + 1];
        fixed_pairs(p, r, step, h);
        if (disc)
            fixed_runs(r, h);
        __builtin_prefetch(p + 2 * VF_N);
        const vf axis = disc ? vf_zero() : vf_mul(fixed_weight(weight, 1), h[0]);
        HF_UNROLL(9)
        for (int k = r; k >= 0; k--) {
            row[k] = fixed_sum(rows, k, r, h, weight, axis, disc);
            sums[r - k] = vf_add(sums[r - k + 1], row[k]);
            if (k == r && y >= r)
                vf_store(out + (y - r) * out_stride, disc ? vf_mul(sums[0], scale) : sums[0]);
        }
        HF_UNROLL(8)
        for (int k = 1; k < r; k++)
            sums[r + k] = vf_add(sums[r + k + 1], row[k]);
        sums[2 * r] = row[r];
    }
    HF_UNROLL(8)
    for (int i = 1; i <= r; i++)
        if (height - 1 - r + i >= 0)
            vf_store(out + (height - 1 - r + i) * out_stride, sums[i]);
}

// One vector of columns, of rows that lie in_stride apart; step: between columns.
typedef void fixed_column(const float *weight, float scale, const float *in, ptrdiff_t in_stride, ptrdiff_t step,
                          float *out, ptrdiff_t out_stride, int height);

// name_column, of these rows. steps: NULL where the step is 1, or &step. Three functions: inlined into one, the compiler keeps the
// weights of all rows as vectors, and spills them.
#define FIXED_COLUMN(name, rows, r, disc, steps)                                                                       \
    static __attribute__((noinline)) void name##_top(const float *weight, float scale, const float *in,                \
                                                     ptrdiff_t in_stride, ptrdiff_t step, float *out,                  \
                                                     ptrdiff_t out_stride, int height)                                 \
    {                                                                                                                  \
        (void)step;                                                                                                    \
        fixed_edges(rows, r, disc, weight, vf_set1(scale), in, in_stride, steps, 1, out, out_stride, height);          \
    }                                                                                                                  \
    static __attribute__((noinline)) void name##_inside(const float *weight, float scale, const float *in,             \
                                                        ptrdiff_t in_stride, ptrdiff_t step, float *out,               \
                                                        ptrdiff_t out_stride, int height)                              \
    {                                                                                                                  \
        (void)step;                                                                                                    \
        fixed_inside(rows, r, disc, weight, vf_set1(scale), in, in_stride, steps, out, out_stride, height);            \
    }                                                                                                                  \
    static __attribute__((noinline)) void name##_bottom(const float *weight, float scale, const float *in,             \
                                                        ptrdiff_t in_stride, ptrdiff_t step, float *out,               \
                                                        ptrdiff_t out_stride, int height)                              \
    {                                                                                                                  \
        (void)step;                                                                                                    \
        fixed_edges(rows, r, disc, weight, vf_set1(scale), in, in_stride, steps, 0, out, out_stride, height);          \
    }                                                                                                                  \
    static void name##_column(const float *weight, float scale, const float *in, ptrdiff_t in_stride, ptrdiff_t step,  \
                              float *out, ptrdiff_t out_stride, int height)                                            \
    {                                                                                                                  \
        const ptrdiff_t last = height - 1;                                                                             \
        name##_top(weight, scale, in, in_stride, step, out, out_stride, height);                                       \
        name##_inside(weight, scale, in, in_stride, step, out, out_stride, height);                                    \
        name##_bottom(weight, scale, in + last * in_stride, -in_stride, step, out + last * out_stride, -out_stride,    \
                      height);                                                                                         \
    }

// The weights as columns take them.
static const float *fixed_weights(const struct hf_taps *t, float *work)
{
    if (WEIGHT_N == 1)
        return t->weight;
    for (int i = 0; i < t->first[t->rows]; i++)
        vf_store(work + i * VF_N, vf_set1(t->weight[i]));
    return work;
}

#endif
