// SPDX-License-Identifier: BSD-3-Clause
// Scatter: the half-resolution means on vectors. Nothing is fused: what is alike has one answer everywhere.
#include "pixel/pass_c.h"
#include "scatter/kernels.h"
#include "simd/simd.h"

// Smallest and largest of the positive ones so far.
HF_INLINE void tent_range(vf r, vf *least, vf *most)
{
    *least = vf_select(vf_gt(r, vf_zero()), vf_min(r, *least), *least);
    *most = vf_max(r, *most);
}

// In the middle between the two; -1: they are not alike; 0: there are none.
HF_INLINE vf tent_middle(vf least, vf most)
{
    const vf bound = vf_add(vf_set1(0.5f), vf_mul(least, vf_set1(1 / 32.0f)));
    const vf v = vf_select(vf_le(vf_sub(most, least), bound), vf_mul(vf_set1(0.5f), vf_add(least, most)), vf_set1(-1));
    return vf_keep(vf_gt(most, vf_zero()), v);
}

static void quad_row_simd(const float *above, const float *below, int n, float sign, float *out)
{
    const vf s = vf_set1(sign);
    for (int i = 0; i < n; i += VF_N) {
        vf r[4], least = vf_set1(__builtin_inff()), most = vf_zero();
        vf_unzip(vf_load(above + 2 * i), vf_load(above + 2 * i + VF_N), &r[0], &r[1]);
        vf_unzip(vf_load(below + 2 * i), vf_load(below + 2 * i + VF_N), &r[2], &r[3]);
        for (int k = 0; k < 4; k++)
            tent_range(vf_mul(s, r[k]), &least, &most);
        vf_store(out + i, tent_middle(least, most));
    }
}

static void site_row_simd(const float *const quad[3], int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        vf own = vf_load(quad[1] + i);
        if (vm_any(vf_eq(own, vf_zero()))) {
            vf least = vf_set1(__builtin_inff()), most = vf_zero();
            for (int k = 0; k < 9; k++)
                tent_range(vf_load(quad[k / 3] + i + k % 3 - 1), &least, &most);
            own = vf_select(vf_eq(own, vf_zero()), tent_middle(least, most), own);
        }
        vf_store(out + i, vf_max(own, vf_zero()));
    }
}

HF_INLINE vf tent_saturate(vf v)
{
    return vf_min(vf_max(v, vf_zero()), vf_set1(1));
}

HF_INLINE vm tent_alike(const float *quad, vf r, vf bound)
{
    const vf q = vf_load(quad);
    return vm_and(vf_gt(q, vf_zero()), vf_le(vf_abs(vf_sub(q, r)), bound));
}

static int tent_weights_simd(const struct hf_tent_row *t, int first)
{
    const struct hf_scatter *s = t->scatter;
    const int whole = first + (t->n - first) / VF_N * VF_N;
    vm lone = vf_gt(vf_zero(), vf_zero());
    for (int i = first; i < whole; i += VF_N) {
        vf r[2];
        vf_unzip(vf_load(t->radius + 2 * i), vf_load(t->radius + 2 * i + VF_N), &r[0], &r[1]);
        for (int odd = 0; odd < 2; odd++) {
            const vf v = vf_mul(vf_set1(t->sign), r[odd]), bound = vf_add(vf_set1(0.5f), vf_mul(v, vf_set1(1 / 32.0f)));
            const vf part = tent_saturate(vf_mul(vf_sub(v, vf_set1(s->half_from)), vf_set1(s->half_slope)));
            const vf own = tent_saturate(vf_mul(vf_sub(vf_set1(s->fade), v), vf_set1(s->fade_slope)));
            vf weight = vf_sub(vf_set1(1), own);
            weight = vf_mul(vf_keep(vf_gt(v, vf_zero()), weight), part);
            const int next = odd ? i + 1 : i - 1;
            const vm merged = vm_and(vm_and(tent_alike(t->own + i, v, bound), tent_alike(t->own + next, v, bound)),
                                     vm_and(tent_alike(t->next + i, v, bound), tent_alike(t->next + next, v, bound)));
            lone = vm_or(lone, vm_and(vf_gt(weight, vf_zero()), vm_not(merged)));
            vf_store(t->pixel[odd][3] + i, vf_keep(merged, weight));
        }
        const vf dim = vf_set1(s->dim);
        const vf even = vf_mul(vf_load(t->pixel[0][3] + i), dim), odd = vf_mul(vf_load(t->pixel[1][3] + i), dim);
        for (int c = 0; c < t->channels; c++) {
            vf a, b;
            vf_unzip(vf_load(t->colour[c] + 2 * i), vf_load(t->colour[c] + 2 * i + VF_N), &a, &b);
            vf_store(t->pixel[0][c] + i, vf_mul(a, even));
            vf_store(t->pixel[1][c] + i, vf_mul(b, odd));
        }
    }
    return hf_tent_weights_c(t, whole) | vm_any(lone);
}

static void tent_simd(const float *even, const float *odd, int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        const vf inner = vf_mul(vf_set1(0.375f), vf_add(vf_load(even + i), vf_load(odd + i)));
        const vf outer = vf_mul(vf_set1(0.125f), vf_add(vf_load(odd + i - 1), vf_load(even + i + 1)));
        vf_store(out + i, vf_add(inner, outer));
    }
}

static void mean_row_simd(const float *const tent[4], const float part[4], int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        vf t[4];
        for (int k = 0; k < 4; k++)
            t[k] = vf_mul(vf_set1(part[k]), vf_load(tent[k] + i));
        vf_store(out + i, vf_mul(vf_set1(0.5f), vf_add(vf_add(t[0], t[3]), vf_add(t[1], t[2]))));
    }
}
