// SPDX-License-Identifier: BSD-3-Clause
// Patterns compared on vectors. The order of operations is that of patterns.c.
#include "engine/layers/patterns.h"
#include "simd/simd.h"

HF_INLINE void layers_alike_of(const struct hf_pattern_place *place, const struct hf_pattern_tap *tap, int count,
                               const float *const in[6], const int channels, int n, float *sum, float *off)
{
    const vf zero = vf_zero(), one = vf_set1(1), middle = vf_set1(place->radius), slope = vf_set1(place->slope);
    for (int x = 0; x < n; x += VF_N) {
        vf s = zero, e = zero;
        for (int i = 0; i < count; i++) {
            const ptrdiff_t at = tap[i].at + x;
            const vf apart = vf_abs(vf_sub(vf_load(in[5] + at), middle));
            const vf t = vf_saturate(vf_fnma(apart, slope, vf_set1(2)));
            const vf full = vf_min(vf_mul(vf_set1(9), vf_load(in[4] + at)), one);
            const vf k = vf_mul(vf_mul(t, full), vf_set1(tap[i].weight));
            vf d = zero;
            for (int c = 0; c < channels; c++) {
                const vf v = vf_sub(vf_load(in[c] + at), vf_set1(tap[i].colour[c]));
                d = vf_fma(v, v, d);
            }
            s = vf_add(s, k);
            e = vf_fma(k, d, e);
        }
        vf_store(sum + x, s);
        vf_store(off + x, e);
    }
}

static void layers_alike_simd(const struct hf_pattern_place *place, const struct hf_pattern_tap *tap, int count,
                              const float *const in[6], int channels, int n, float *sum, float *off)
{
    HF_WITH_CHANNELS(channels, layers_alike_of(place, tap, count, in, CHANNELS, n, sum, off));
}
