// SPDX-License-Identifier: BSD-3-Clause
// Row kernels of the disocclusion fill on vectors. Nothing is fused: the scatter has the same bits everywhere. Rows
// that are added to, or that end at the frame's edge, must not be written past their end; behind_rows.c does their last
// pixels.
#ifndef HF_BEHIND_SIMD_H
#define HF_BEHIND_SIMD_H

#include "pixel/behind.h"
#include "pixel/coc_vf.h"
#include "pixel/kernels.h"
#include "simd/simd.h"

static void near_row_simd(const float *radius, int n, float *out)
{
    const int whole = n / VF_N * VF_N;
    for (int i = 0; i < whole; i += VF_N) {
        vf a, b;
        vf_unzip(vf_load(radius + 2 * i), vf_load(radius + 2 * i + VF_N), &a, &b);
        vf_store(out + i, vf_max(vf_sub(vf_zero(), vf_min(a, b)), vf_load(out + i)));
    }
    hf_near_row_c(radius + 2 * whole, n - whole, out + whole);
}

static void most_row_simd(const float *a, const float *b, const float *c, int n, float *out)
{
    const int whole = n / VF_N * VF_N;
    for (int i = 0; i < whole; i += VF_N)
        vf_store(out + i, vf_max(vf_max(vf_load(a + i), vf_load(b + i)), vf_load(c + i)));
    hf_most_row_c(a + whole, b + whole, c + whole, n - whole, out + whole);
}

static void seen_row_simd(const float *v, const float *weight, float scale, int n, float *out)
{
    const int whole = n / VF_N * VF_N;
    const vf s = vf_set1(scale);
    for (int i = 0; i < whole; i += VF_N) {
        const vf a = vf_mul(vf_load(v + 2 * i), vf_mul(vf_load(weight + 2 * i), s));
        const vf b = vf_mul(vf_load(v + 2 * i + VF_N), vf_mul(vf_load(weight + 2 * i + VF_N), s));
        vf even, odd;
        vf_unzip(a, b, &even, &odd);
        vf_store(out + i, vf_add(vf_load(out + i), vf_add(even, odd)));
    }
    hf_seen_row_c(v + 2 * whole, weight + 2 * whole, scale, n - whole, out + whole);
}

static void third_row_simd(const float *a, const float *b, const float *c, int n, float *out)
{
    const vf third = vf_set1(1 / 3.0f);
    for (int i = 0; i < n; i += VF_N)
        vf_store(out + i, vf_mul(third, vf_add(vf_add(vf_load(a + i), vf_load(b + i)), vf_load(c + i))));
}

static void part_row_simd(const float *near, float share, float size, int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        const vf span = vf_add(vf_mul(vf_set1(0.5f), vf_load(near + i)), vf_set1(1));
        const vf part = vf_saturate(vf_sub(vf_set1(2), vf_div(vf_set1(size), span)));
        vf_store(out + i, vf_mul(vf_set1(share), part));
    }
}

static void add_part_simd(const float *in, const float *part, int n, float *out)
{
    const int whole = n / VF_N * VF_N;
    for (int i = 0; i < whole; i += VF_N)
        vf_store(out + i, vf_add(vf_load(out + i), vf_mul(vf_load(part + i), vf_load(in + i))));
    hf_add_part_c(in + whole, part + whole, n - whole, out + whole);
}

HF_INLINE vf up_quad(const float *own, const float *over)
{
    return vf_add(vf_mul(vf_set1(0.75f), vf_load(own)), vf_mul(vf_set1(0.25f), vf_load(over)));
}

static void up_row_simd(const float *own, const float *over, int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        const vf most = vf_mul(vf_set1(0.75f), up_quad(own + i, over + i)), rest = vf_set1(0.25f);
        vf a, b;
        vf_zip(vf_add(most, vf_mul(rest, up_quad(own + i - 1, over + i - 1))),
               vf_add(most, vf_mul(rest, up_quad(own + i + 1, over + i + 1))), &a, &b);
        vf_store(out + 2 * i, a);
        vf_store(out + 2 * i + VF_N, b);
    }
}

#endif
