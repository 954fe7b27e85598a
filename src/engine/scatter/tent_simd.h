// SPDX-License-Identifier: BSD-3-Clause
// Scatter: the half-resolution means on vectors. Nothing is fused: which pixels are alike is the same everywhere.
#include "pixel/pass_c.h"
#include "pixel/coc_vf.h"
#include "engine/scatter/kernels.h"
#include "simd/simd.h"

HF_INLINE vf tent_half_weight(const struct hf_scatter *t, vf r)
{
    const vf part = vf_saturate(vf_mul(vf_sub(r, vf_set1(t->half_from)), vf_set1(t->half_slope)));
    const vf own = vf_saturate(vf_mul(vf_sub(vf_set1(t->fade), r), vf_set1(t->fade_slope)));
    return vf_mul(vf_keep(vf_gt(r, vf_zero()), vf_sub(vf_set1(1), own)), part);
}

static void quad_row_simd(const struct hf_scatter *t, const float *above, const float *below, int n, float sign,
                          float *const out[2])
{
    const vf s = vf_set1(sign);
    for (int i = 0; i < n; i += VF_N) {
        vf r[4], w[4];
        vf_unzip(vf_load(above + 2 * i), vf_load(above + 2 * i + VF_N), &r[0], &r[1]);
        vf_unzip(vf_load(below + 2 * i), vf_load(below + 2 * i + VF_N), &r[2], &r[3]);
        for (int k = 0; k < 4; k++) {
            r[k] = vf_mul(s, r[k]);
            w[k] = tent_half_weight(t, r[k]);
        }
        vf_store(out[0] + i, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
        for (int k = 0; k < 4; k++)
            w[k] = vf_mul(w[k], r[k]);
        vf_store(out[1] + i, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
    }
}

HF_INLINE vf tent_sum_around(const float *const row[3], int i)
{
    vf v[3];
    for (int k = 0; k < 3; k++)
        v[k] = vf_add(vf_load(row[k] + i), vf_add(vf_load(row[k] + i - 1), vf_load(row[k] + i + 1)));
    return vf_add(v[1], vf_add(v[0], v[2]));
}

static void site_row_simd(const float *const weight[3], const float *const moment[3], int n, float *out)
{
    const vf around = vf_set1(HF_SITE_AROUND);
    for (int i = 0; i < n; i += VF_N) {
        const vf all = vf_add(vf_load(weight[1] + i), vf_mul(around, tent_sum_around(weight, i)));
        const vf sum = vf_add(vf_load(moment[1] + i), vf_mul(around, tent_sum_around(moment, i)));
        vf_store(out + i, vf_keep(vf_gt(all, vf_zero()), vf_div(sum, all)));
    }
}

// The larger distance of r from the radii of two sources.
HF_INLINE vf tent_apart(const float *site, int i, int next, vf r)
{
    return vf_max(vf_abs(vf_sub(vf_load(site + i), r)), vf_abs(vf_sub(vf_load(site + next), r)));
}

// As hf_alike().
HF_INLINE vf tent_alike(vf r, vf apart)
{
    const vf most = vf_add(vf_set1(0.25f), vf_mul(r, vf_set1(1 / 32.0f))), steps = vf_set1(1 << HF_ALIKE_LOG2);
    const vf part = vf_mul(vf_saturate(vf_mul(vf_sub(most, apart), vf_set1(8))), steps);
    return vf_mul(vi_to_vf(vf_to_vi(part)), vf_set1(1.0f / (1 << HF_ALIKE_LOG2)));
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
            const vf v = vf_mul(vf_set1(t->sign), r[odd]), weight = tent_half_weight(s, v);
            const int next = odd ? i + 1 : i - 1;
            const vf apart = vf_max(tent_apart(t->own, i, next, v), tent_apart(t->next, i, next, v));
            const vf merged = vf_mul(weight, tent_alike(v, apart));
            lone = vm_or(lone, vf_gt(weight, merged));
            vf_store(t->pixel[odd][3] + i, merged);
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
