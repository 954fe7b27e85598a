// SPDX-License-Identifier: BSD-3-Clause
// Depth of formats other than float32 converted to floats, on vectors.
#ifndef HF_DEPTH_ROWS_SIMD_H
#define HF_DEPTH_ROWS_SIMD_H

#include "pixel/depth_rows.h"
#include "pixel/format_vf.h"
#include "simd/simd.h"

// VF_N samples of 4 bytes.
HF_INLINE vf widen_word(const enum hf_depth_format format, vi u)
{
    if (format == HF_DEPTH_FORMAT_D24S8)
        return vf_mul(vi_to_vf(vi_shr(u, 8)), vf_set1(HF_DEPTH_UNIT_24));
    if (format == HF_DEPTH_FORMAT_X8D24)
        return vf_mul(vi_to_vf(vi_and(u, vi_set1(0xffffff))), vf_set1(HF_DEPTH_UNIT_24));
    const vf high = vi_to_vf(vi_shr(u, 16)), low = vi_to_vf(vi_and(u, vi_set1(0xffff)));
    return vf_mul(vf_add(vf_mul(high, vf_set1(65536)), low), vf_set1(HF_DEPTH_UNIT_32));
}

// Only whole vectors are read; the C does the rest.
HF_INLINE void widen_words(const enum hf_depth_format format, const uint8_t *p, int n, float *out)
{
    int i = 0;
    for (; i + VF_N <= n; i += VF_N)
        vf_store(out + i, widen_word(format, vi_load(p + (size_t)i * 4)));
    hf_widen_depth_c(format, p + (size_t)i * 4, n - i, out + i);
}

static void widen_d24s8_simd(const void *p, int n, float *out)
{
    widen_words(HF_DEPTH_FORMAT_D24S8, p, n, out);
}

static void widen_x8d24_simd(const void *p, int n, float *out)
{
    widen_words(HF_DEPTH_FORMAT_X8D24, p, n, out);
}

static void widen_unorm32_simd(const void *p, int n, float *out)
{
    widen_words(HF_DEPTH_FORMAT_UNORM32, p, n, out);
}

// Each word holds two samples.
static void widen_unorm16_simd(const void *p, int n, float *out)
{
    const uint8_t *from = p;
    int i = 0;
    for (; i + 2 * VF_N <= n; i += 2 * VF_N) {
        const vi u = vi_load(from + (size_t)i * 2);
        const vf even = vf_mul(vi_to_vf(vi_and(u, vi_set1(0xffff))), vf_set1(HF_DEPTH_UNIT_16));
        const vf odd = vf_mul(vi_to_vf(vi_shr(u, 16)), vf_set1(HF_DEPTH_UNIT_16));
        vf a, b;
        vf_zip(even, odd, &a, &b);
        vf_store(out + i, a);
        vf_store(out + i + VF_N, b);
    }
    hf_widen_depth_c(HF_DEPTH_FORMAT_UNORM16, from + (size_t)i * 2, n - i, out + i);
}

// Infinity and NaN stay what they are. vf_load_half may turn them into large numbers, so the C does rows that have
// some.
static void widen_float16_simd(const void *p, int n, float *out)
{
    const uint8_t *from = p;
    vm large = vf_gt(vf_zero(), vf_zero());
    int i = 0;
    for (; i + VF_N <= n; i += VF_N) {
        const vf v = vf_load_half(from + (size_t)i * 2);
        large = vm_or(large, vm_not(vf_lt(vf_abs(v), vf_set1(65536))));
        vf_store(out + i, v);
    }
    if (vm_any(large))
        i = 0;
    hf_widen_depth_c(HF_DEPTH_FORMAT_FLOAT16, from + (size_t)i * 2, n - i, out + i);
}

static void depth_rows_init(struct hf_pixel_kernels *k)
{
    k->depth[HF_DEPTH_FORMAT_FLOAT16] = widen_float16_simd;
    k->depth[HF_DEPTH_FORMAT_UNORM16] = widen_unorm16_simd;
    k->depth[HF_DEPTH_FORMAT_UNORM32] = widen_unorm32_simd;
    k->depth[HF_DEPTH_FORMAT_D24S8] = widen_d24s8_simd;
    k->depth[HF_DEPTH_FORMAT_X8D24] = widen_x8d24_simd;
}

#endif
