// SPDX-License-Identifier: BSD-3-Clause
// Signed CoC radii on vectors. As in CoC generation nothing is fused, so which pixels are sharp is the same everywhere.
#include <math.h>

#include "pixel/depth_rows.h"
#include "pixel/coc_vf.h"

HF_INLINE vf radius_of_vf(const struct hf_setup *s, vf v)
{
    vf r;
    if (s->radius_k > 0) {
        r = vf_mul(vf_sub(v, vf_set1(s->radius_0)), vf_set1(s->radius_k));
        r = vf_min(vf_max(r, vf_set1(-s->max_radius)), vf_set1(s->max_radius));
    } else {
        const vf n = coc_ramp(s, vf_mul(vf_sub(vf_set1(s->near_0), v), vf_set1(s->near_i)));
        const vf f = coc_ramp(s, vf_mul(vf_sub(v, vf_set1(s->far_0)), vf_set1(s->far_i)));
        r = vf_mul(vf_set1(s->strength * s->max_radius), vf_sub(f, n));
    }
    if (s->uniform)
        r = vf_set1(s->max_radius);
    return vf_keep(vf_gt(vf_abs(r), vf_set1(s->sharp_radius)), r);
}

struct radius_sums {
    vi near, far, none;
    vf min, max;
    vm nan, group_near, group_far;  // since the last group of lanes began
    uint64_t near_groups, far_groups;
};

// counted: what the radii are is counted too. Otherwise only NaN is noted.
HF_INLINE void radius_form(const struct hf_frame *f, const enum hf_depth_form form, const int counted, int x, int y,
                           int n, float *out, struct radius_sums *sums)
{
    const struct hf_setup *s = f->s;
    const uint8_t *row = hf_depth_row(f, x, y, n, 0);
    static const float steps[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const vf py = vf_set1((float)y + 0.5f - s->ray_cy), step = vf_load(steps);
    for (int i = 0; i < n; i += VF_N) {
        vm none;
        const vf d = vf_load(row + (size_t)i * 4);
        const vf px = vf_sub(vf_add(vf_add(vf_set1((float)(x + i)), step), vf_set1(0.5f)), vf_set1(s->ray_cx));
        const vf r = radius_of_vf(s, coc_variable(s, form, d, px, py, &none));
        vf_store(out + i, r);
        sums->nan = vm_or(sums->nan, vf_ne(d, d));
        if (!counted)
            continue;
        sums->none = vi_count(sums->none, none);
        const vm is_near = vf_lt(r, vf_zero()), is_far = vf_gt(r, vf_zero());
        sums->near = vi_count(sums->near, is_near);
        sums->far = vi_count(sums->far, is_far);
        sums->group_near = vm_or(sums->group_near, is_near);
        sums->group_far = vm_or(sums->group_far, is_far);
        sums->min = vf_min(sums->min, r);
        sums->max = vf_max(sums->max, r);
        if ((x + i + VF_N) % (2 * HF_GROUP) == 0 || i + VF_N >= n) {
            const int group = hf_group((x + i + VF_N - 1) / 2);
            sums->near_groups |= (uint64_t)vm_any(sums->group_near) << group;
            sums->far_groups |= (uint64_t)vm_any(sums->group_far) << group;
            sums->group_near = sums->group_far = vf_gt(vf_zero(), vf_zero());
        }
    }
}

static void radius_row_simd(const struct hf_frame *f, int x, int y, int n, float *out, struct hf_counts *counts)
{
    const int whole = n / VF_N * VF_N;
    const vm no = vf_gt(vf_zero(), vf_zero());
    struct radius_sums sums = {vi_set1(0), vi_set1(0), vi_set1(0), vf_set1(HUGE_VALF), vf_set1(-HUGE_VALF), no, no,
                               no,         0,          0};
    if (counts)
        HF_WITH_FORM(f->s->form, radius_form(f, (enum hf_depth_form)FORM, 1, x, y, whole, out, &sums))
    else
        HF_WITH_FORM(f->s->form, radius_form(f, (enum hf_depth_form)FORM, 0, x, y, whole, out, &sums))
    // A NaN needs its neighbours, so the plain C does the row again; elsewhere its bits are the same.
    const int from = vm_any(sums.nan) ? 0 : whole;
    if (from < n)
        hf_radius_row_c(f, x + from, y, n - from, out + from, counts);
    if (!counts || from == 0)
        return;
    const float least = -vf_most(vf_sub(vf_zero(), sums.min)), most = vf_most(sums.max);
    const uint32_t near = vi_sum(sums.near), far = vi_sum(sums.far);
    counts->near_groups |= sums.near_groups;
    counts->far_groups |= sums.far_groups;
    counts->near_pixels += near;
    counts->far_pixels += far;
    counts->sharp_pixels += (uint64_t)whole - near - far;
    counts->no_surface += vi_sum(sums.none);
    counts->radius_min = least < counts->radius_min ? least : counts->radius_min;
    counts->radius_max = most > counts->radius_max ? most : counts->radius_max;
}

static void zip_row_simd(const float *even, const float *odd, int n, float *out)
{
    for (int i = 0; i < n; i += VF_N) {
        vf a, b;
        vf_zip(vf_load(even + i), vf_load(odd + i), &a, &b);
        vf_store(out + 2 * i, a);
        vf_store(out + 2 * i + VF_N, b);
    }
}

static void unzip_row_simd(const float *in, int n, float *even, float *odd)
{
    for (int i = 0; i < n; i += VF_N) {
        vf a, b;
        vf_unzip(vf_load(in + 2 * i), vf_load(in + 2 * i + VF_N), &a, &b);
        vf_store(even + i, a);
        vf_store(odd + i, b);
    }
}
