// SPDX-License-Identifier: BSD-3-Clause
// Highlights on vectors. The order of operations is that of highlights.c.
#include <math.h>

#include "engine/layers/dimmed_vf.h"
#include "engine/layers/highlights.h"
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

static void layers_shares_simd(const float *const in[6], const float *const around[5], const float *const covered[5],
                               int n, float *out, uint8_t *any)
{
    const vf one = vf_set1(1);
    for (int x = 0; x < n; x += 2 * VF_N) {
        const vf light[2] = {layers_light(in, x), layers_light(in, x + VF_N)};
        vf least[2] = {vf_set1(HUGE_VALF), vf_set1(HUGE_VALF)};
        for (int i = 0; i < 5; i++) {
            const vf mean = vf_load(around[i] + x / 2), m = i ? vf_mul(mean, vf_set1(HF_LAYERS_BESIDE)) : mean;
            vf v[2];
            vf_zip(m, m, &v[0], &v[1]);
            if (covered) {
                const vf open = vf_sub(one, vf_load(covered[i] + x / 2));
                vf part[2];
                vf_zip(open, open, &part[0], &part[1]);
                for (int j = 0; j < 2; j++)
                    v[j] = vf_fma(part[j], vf_sqrt(vf_max(light[j], vf_zero())), v[j]);
            }
            for (int j = 0; j < 2; j++)
                least[j] = vf_min(v[j], least[j]);
        }
        for (int j = 0; j < 2; j++) {
            const int at = x + j * VF_N;
            const vf r = vf_load(in[5] + at);
            const vf cap =
                vf_mul(vf_mul(least[j], least[j]), vf_fma(vf_mul(r, r), vf_set1(0.001f * 3.14159265f), vf_set1(2)));
            const vm bright = vm_and(vf_gt(vf_abs(r), vf_set1(HF_LAYERS_FINE)), vf_gt(light[j], cap));
            vf share = vf_zero();
            if (vm_any(bright)) {
                share = vf_keep(bright, vf_mul(vf_load(in[4] + at), vf_sub(one, vf_div(cap, light[j]))));
                any[at / 16] = 1;
            }
            layers_leave(out + at, share);
        }
    }
}
