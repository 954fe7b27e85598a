// SPDX-License-Identifier: BSD-3-Clause
// Rows of shapes on vectors. The order of operations is that of runs.c.
#include <string.h>

#include "engine/layers/kernels.h"
#include "simd/simd.h"

static void layers_pairs_simd(const float *in, int apart, int n, float *out)
{
    int x = 0;
    for (; x + VF_N <= n; x += VF_N)
        vf_store(out + x, vf_add(vf_load(in + x), vf_load(in + x + apart)));
    hf_layers_pairs_c(in + x, apart, n - x, out + x);
}

// Computes `side` vectors side by side.
HF_INLINE void layers_runs_of(const struct hf_shape_run *run, int count, const float *window, ptrdiff_t plane,
                              const float *part, const int side, float *out)
{
    vf sum[4];
    for (int j = 0; j < side; j++)
        sum[j] = vf_zero();
    for (int i = 0; i < count; i++) {
        const struct hf_shape_run *r = &run[i];
        const float *in = window + r->start;
        const vf before = vf_set1(r->before), after = vf_set1(r->after), weight = vf_set1(r->weight);
        vf v[4];
        for (int j = 0; j < side; j++)
            v[j] = vf_fma(after, vf_load(in + r->length + j * VF_N), vf_mul(before, vf_load(in - 1 + j * VF_N)));
        for (unsigned left = (unsigned)r->length; left; left &= left - 1) {
            const int k = __builtin_ctz(left);
            for (int j = 0; j < side; j++)
                v[j] = vf_add(v[j], vf_load(in + k * plane + j * VF_N));
            in += 1 << k;
        }
        for (int j = 0; j < side; j++)
            sum[j] = vf_fma(weight, v[j], sum[j]);
    }
    for (int j = 0; j < side; j++) {
        const vf was = vf_load(out + j * VF_N);
        vf_store(out + j * VF_N, part ? vf_fma(vf_load(part + j * VF_N), sum[j], was) : vf_add(was, sum[j]));
    }
}

static void layers_runs_simd(const struct hf_shape_run *run, int count, const float *window, ptrdiff_t plane,
                             const float *part, int n, float *out)
{
    int x = 0;
    for (; x + 4 * VF_N <= n; x += 4 * VF_N)
        layers_runs_of(run, count, window + x, plane, part ? part + x : NULL, 4, out + x);
    for (; x < n; x += VF_N)
        layers_runs_of(run, count, window + x, plane, part ? part + x : NULL, 1, out + x);
}

HF_INLINE void layers_weights_of(const float *weight, int count, const float *in, const int side, float *out)
{
    vf sum[4];
    for (int j = 0; j < side; j++)
        sum[j] = vf_zero();
    for (int i = 0; i < count; i++) {
        const vf w = vf_set1(weight[i]);
        for (int j = 0; j < side; j++)
            sum[j] = vf_fma(w, vf_load(in - i + j * VF_N), sum[j]);
    }
    for (int j = 0; j < side; j++)
        vf_store(out + j * VF_N, vf_add(vf_load(out + j * VF_N), sum[j]));
}

static void layers_weights_simd(const float *weight, int count, const float *in, int n, float *out)
{
    int x = 0;
    for (; x + 4 * VF_N <= n; x += 4 * VF_N)
        layers_weights_of(weight, count, in + x, 4, out + x);
    for (; x < n; x += VF_N)
        layers_weights_of(weight, count, in + x, 1, out + x);
}

// The remainder is a vector too, so all numbers are fused, or none.
static void layers_stamp_simd(const float *weight, int n, float v, float *out)
{
    const vf value = vf_set1(v);
    int i = 0;
    for (; i + VF_N <= n; i += VF_N)
        vf_store(out + i, vf_fma(value, vf_load(weight + i), vf_load(out + i)));
    if (i == n)
        return;
    float rest[2][VF_N] = {{0}};
    memcpy(rest[0], weight + i, sizeof(float) * (size_t)(n - i));
    memcpy(rest[1], out + i, sizeof(float) * (size_t)(n - i));
    vf_store(rest[1], vf_fma(value, vf_load(rest[0]), vf_load(rest[1])));
    memcpy(out + i, rest[1], sizeof(float) * (size_t)(n - i));
}
