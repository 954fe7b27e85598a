// SPDX-License-Identifier: BSD-3-Clause
// CoC generation on vectors: rows.
#include "pixel/coc_vf.h"

// No pixel is near and far: near_0 <= far_0. So what is neither is what the two counts leave.
struct coc_sums {
    vi near, far, none;
    vf near_max, far_max;      // up to the last group of lanes
    vf group_near, group_far;  // the largest since that
    uint64_t near_groups, far_groups;
    vm nan;
};

// Near and far CoC of one vector of the variable. whole: near CoC and statistics too, not only far.
HF_INLINE void coc_block(const struct hf_setup *s, const int whole, vf v, float *near, float *far,
                         struct coc_sums *sums)
{
    const vf f = coc_far(s, v);
    vf_store(far, f);
    if (!whole)
        return;
    const vf n = coc_near(s, v);
    vf_store(near, n);
    sums->near = vi_count(sums->near, vf_gt(n, vf_zero()));
    sums->far = vi_count(sums->far, vf_gt(f, vf_zero()));
    sums->group_near = vf_max(n, sums->group_near);
    sums->group_far = vf_max(f, sums->group_far);
}

// The variable of one vector of depth, where surfaces may be missing. A NaN counts as no surface here, so it is looked for only
// there.
HF_INLINE vf coc_variable_counted(const struct hf_setup *s, const enum hf_depth_form form, const int whole, vf d, vf px,
                                  vf py, struct coc_sums *sums)
{
    vm none;
    const vf v = coc_variable(s, form, d, px, py, &none);
    if (vm_any(none)) {
        sums->nan = vm_or(sums->nan, vf_ne(d, d));
        if (whole)
            sums->none = vi_count(sums->none, none);
    }
    return v;
}

// Note whether the current group of lanes has CoC; lane x is the last of a group or of the row.
HF_INLINE void coc_end_group(struct coc_sums *sums, int x)
{
    sums->near_groups |= (uint64_t)vm_any(vf_gt(sums->group_near, vf_zero())) << hf_group(x);
    sums->far_groups |= (uint64_t)vm_any(vf_gt(sums->group_far, vf_zero())) << hf_group(x);
    sums->near_max = vf_max(sums->group_near, sums->near_max);
    sums->far_max = vf_max(sums->group_far, sums->far_max);
    sums->group_near = sums->group_far = vf_zero();
}

HF_INLINE void coc_row(const struct hf_frame *f, const enum hf_depth_form form, const enum coc_how how, const int whole,
                       int x, int y, int n, float *const out[4], struct coc_sums *sums)
{
    // Copies: stores through a float pointer cannot change them, so they stay in registers.
    struct hf_setup local = *f->s;
    const struct hf_setup *s = &local;
    float *const near[2] = {out[0], out[1]}, *const far[2] = {out[2], out[3]};
    struct coc_sums local_sums = *sums;
    const ptrdiff_t stride = f->depth->stride;
    const uint8_t *row = hf_depth_row(f, 2 * x, y, 2 * n, 0);
    static const float steps[16] = {0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30};
    const vf py = vf_set1((float)y + 0.5f - s->ray_cy), step = vf_load(steps);
    if (how != COC_ANY) {
        local.smoothstep = 0;
        local.storage = HF_STORAGE_FLOAT;
        local.lens = how == COC_LENS;
    }
    for (int i = 0; i < n; i += VF_N, row += 8 * VF_N) {
        vf d[2];
        for (int k = 0; k < 8 * VF_N; k += 64)  // two rows ahead, as in load_plane
            __builtin_prefetch((const uint8_t *)((uintptr_t)row + (uintptr_t)(2 * stride)) + k);
        vf_unzip(vf_load(row), vf_load(row + 4 * VF_N), &d[0], &d[1]);
        if (how == COC_ANY || coc_misses_some(vf_as_vi(d[0]), vf_as_vi(d[1]), vf_as_vi(d[0]), vf_as_vi(d[1]))) {
            // (2x + 1/2) - axis: the exact additions come first, as in the C.
            const vf px = vf_add(vf_set1((float)(2 * (x + i))), step);
            const vf px_even = vf_sub(vf_add(px, vf_set1(0.5f)), vf_set1(s->ray_cx));
            const vf px_odd = vf_sub(vf_add(px, vf_set1(1.5f)), vf_set1(s->ray_cx));
            d[0] = coc_variable_counted(s, form, whole, d[0], px_even, py, &local_sums);
            d[1] = coc_variable_counted(s, form, whole, d[1], px_odd, py, &local_sums);
        } else {
            d[0] = coc_of_z(s, d[0]);
            d[1] = coc_of_z(s, d[1]);
        }
        coc_block(s, whole, d[0], near[0] + i, far[0] + i, &local_sums);
        coc_block(s, whole, d[1], near[1] + i, far[1] + i, &local_sums);
        if (whole && ((x + i + VF_N) % HF_GROUP == 0 || i + VF_N >= n))
            coc_end_group(&local_sums, x + i + VF_N - 1);
    }
    *sums = local_sums;
}

HF_INLINE void coc_row_form(const struct hf_frame *f, const int whole, int x, int y, int n, float *const out[4],
                            struct coc_sums *sums)
{
    const enum coc_how how = coc_how(f->s);
    if (how == COC_RANGE) {
        coc_row(f, HF_FORM_Z, COC_RANGE, whole, x, y, n, out, sums);
        return;
    }
    if (how == COC_LENS) {
        coc_row(f, HF_FORM_Z, COC_LENS, whole, x, y, n, out, sums);
        return;
    }
    HF_WITH_FORM(f->s->form, coc_row(f, (enum hf_depth_form)FORM, COC_ANY, whole, x, y, n, out, sums))
}

// CoC is monotone in depth, so the nearest and the farthest pixel of a row decide for all of it. With AVX-512, a sharp
// frame takes 0.42 ms to compute its CoC, and 0.2 ms to find that there is none.
static int sharp_row_simd(const struct hf_frame *f, int x, int y, int n)
{
    const struct hf_setup *s = f->s;
    const ptrdiff_t stride = f->depth->stride;
    const int whole = hf_min(n, (s->width - 2 * x) / 2) / VF_N * VF_N;
    if (s->form != HF_FORM_Z)
        return 0;
    const uint8_t *row = hf_depth_row(f, 2 * x, y, 2 * whole, 0);
    if (whole > 0) {
        vf near[2] = {vf_load(row), vf_load(row)}, far[2] = {near[0], near[1]};
        vm number = vf_gt(near[0], vf_zero());
        for (int i = 0; i < whole; i += VF_N, row += 8 * VF_N) {
            for (int k = 0; k < 8 * VF_N; k += 64)
                __builtin_prefetch((const uint8_t *)((uintptr_t)row + (uintptr_t)(2 * stride)) + k);
            for (int o = 0; o < 2; o++) {
                const vf d = vf_load(row + o * 4 * VF_N);
                near[o] = vf_min(near[o], d);
                far[o] = vf_max(far[o], d);
                number = vm_and(number, vf_gt(d, vf_zero()));
            }
        }
        const vf ends[2] = {vf_min(near[0], near[1]), vf_max(far[0], far[1])};
        vm blurred = vm_not(number);
        for (int o = 0; o < 2; o++) {
            vm none;
            const vf v = coc_variable(s, HF_FORM_Z, ends[o], vf_zero(), vf_zero(), &none);
            const vm any = vm_or(vf_gt(coc_near(s, v), vf_zero()), vf_gt(coc_far(s, v), vf_zero()));
            blurred = vm_or(vm_or(blurred, none), any);
        }
        if (vm_any(blurred))
            return 0;
    }
    return whole == n || hf_sharp_row_c(f, x + whole, y, n - whole);
}

static void coc_row_simd(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    const int whole = hf_min(n, (f->s->width - 2 * x) / 2) / VF_N * VF_N;
    const vi no = vi_set1(0);
    const vf least = vf_zero();
    struct coc_sums sums = {no, no, no, least, least, least, least, 0, 0, vf_gt(least, least)};
    if (counts)
        coc_row_form(f, 1, x, y, whole, out, &sums);
    else
        coc_row_form(f, 0, x, y, whole, out, &sums);
    const uint64_t near_pixels = vi_sum(sums.near), far_pixels = vi_sum(sums.far);
    struct hf_counts c = {.near_pixels = near_pixels,
                          .far_pixels = far_pixels,
                          .sharp_pixels = 2 * (uint64_t)whole - near_pixels - far_pixels,
                          .no_surface = vi_sum(sums.none),
                          .near_max = vf_most(sums.near_max),
                          .far_max = vf_most(sums.far_max),
                          .near_groups = sums.near_groups,
                          .far_groups = sums.far_groups};
    // A NaN needs its neighbours, so the plain C does the row again; elsewhere its bits are the same.
    const int from = vm_any(sums.nan) ? 0 : whole;
    if (from == 0)
        c = (struct hf_counts){0};
    float *const rest[4] = {out[0] + from, out[1] + from, out[2] + from, out[3] + from};
    if (from < n)
        hf_coc_row_c(f, x + from, y, n - from, rest, &c);
    if (!counts)
        return;
    counts->near_pixels += c.near_pixels;
    counts->far_pixels += c.far_pixels;
    counts->sharp_pixels += c.sharp_pixels;
    counts->no_surface += c.no_surface;
    counts->depth_repaired += c.depth_repaired;
    counts->near_groups |= c.near_groups;
    counts->far_groups |= c.far_groups;
    counts->near_max = c.near_max > counts->near_max ? c.near_max : counts->near_max;
    counts->far_max = c.far_max > counts->far_max ? c.far_max : counts->far_max;
}
