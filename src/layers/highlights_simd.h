// SPDX-License-Identifier: BSD-3-Clause
// Highlights on vectors: in the order of operations of highlights.c.
#include "layers/highlights.h"
#include "simd/simd.h"

HF_INLINE vf layers_light(const float *const in[3], int x)
{
    return vf_add(vf_add(vf_load(in[0] + x), vf_load(in[1] + x)), vf_load(in[2] + x));
}

static void layers_roots_simd(const float *const above[3], const float *const below[3], int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        vf sum[2], even, odd;
        for (int i = 0; i < 2; i++) {
            const int at = 2 * x + i * VF_N;
            sum[i] = vf_add(vf_sqrt(vf_max(layers_light(above, at), vf_zero())),
                            vf_sqrt(vf_max(layers_light(below, at), vf_zero())));
        }
        vf_unzip(sum[0], sum[1], &even, &odd);
        vf_store(out + x, vf_mul(vf_add(even, odd), vf_set1(0.25f)));
    }
}

static void layers_nine_simd(const float *const in[9], int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        vf sum = vf_load(in[4] + x);
        for (int i = 1; i <= 4; i++)
            sum = vf_add(sum, vf_add(vf_load(in[4 - i] + x), vf_load(in[4 + i] + x)));
        vf_store(out + x, vf_mul(sum, vf_set1(1.0f / 9)));
    }
}

static void layers_shares_simd(const float *const in[6], const float *limit, int n, float *out)
{
    const vf one = vf_set1(1);
    for (int x = 0; x < n; x += 2 * VF_N) {
        const vf m = vf_load(limit + x / 2), q = vf_mul(m, m);
        vf cap[2];
        vf_zip(q, q, &cap[0], &cap[1]);
        for (int i = 0; i < 2; i++) {
            const int at = x + i * VF_N;
            const vf r = vf_load(in[5] + at), light = layers_light(in, at);
            const vf c = vf_mul(cap[i], vf_fma(vf_mul(r, r), vf_set1(0.001f * 3.14159265f), vf_set1(2)));
            const vm bright = vm_and(vf_gt(vf_abs(r), vf_set1(HF_LAYERS_FINE)), vf_gt(light, c));
            vf_store(out + at, vf_keep(bright, vf_mul(vf_load(in[4] + at), vf_sub(one, vf_div(c, light)))));
        }
    }
}
