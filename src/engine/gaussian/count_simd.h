// SPDX-License-Identifier: BSD-3-Clause
// Count the pixels with near or far CoC, on vectors, by the limits of depth (limits.c).
#ifndef HF_GAUSSIAN_COUNT_SIMD_H
#define HF_GAUSSIAN_COUNT_SIMD_H

#include "engine/gaussian/kernels.h"
#include "pixel/depth_rows.h"
#include "simd/simd.h"

struct limit_sums {
    vi near, far, none;
    vf first, last;  // the nearest and the farthest depth, infinite if there is no surface
    vm is_near, is_far, nan;
};

HF_INLINE void count_block(vf d, vf near_last, vf far_first, struct limit_sums *sums)
{
    const vm surface = vm_and(vf_gt(d, vf_zero()), vf_lt(d, vf_set1(1e10f)));
    if (vm_any(vm_not(surface))) {
        sums->nan = vm_or(sums->nan, vf_unordered(d, d));
        sums->none = vi_count(sums->none, vm_not(surface));
        d = vf_select(surface, d, vf_set1(__builtin_inff()));
    }
    const vm near = vf_le(d, near_last), far = vf_le(far_first, d);
    sums->near = vi_count(sums->near, near);
    sums->far = vi_count(sums->far, far);
    sums->is_near = vm_or(sums->is_near, near);
    sums->is_far = vm_or(sums->is_far, far);
    sums->first = vf_min(d, sums->first);
    sums->last = vf_max(d, sums->last);
}

// Count n lanes, a multiple of VF_N, all inside the picture.
HF_INLINE struct limit_sums count_lanes(const struct hf_frame *f, int x, int y, int n, struct hf_counts *c)
{
    const vm no = vf_gt(vf_zero(), vf_zero());
    const vf near_last = vf_set1(hf_gaussian(f->s)->near_last), far_first = vf_set1(hf_gaussian(f->s)->far_first);
    const ptrdiff_t ahead = 2 * f->depth->stride;  // two rows ahead, because chunks have few rows
    struct limit_sums sums = {vi_set1(0), vi_set1(0), vi_set1(0), vf_set1(__builtin_inff()), vf_set1(-__builtin_inff()),
                              no,         no,         no};
    const uint8_t *row = hf_depth_row(f, 2 * x, y, 2 * n, 0);
    for (int i = 0; i < n;) {
        const int end = hf_min((x + i) / HF_GROUP * HF_GROUP + HF_GROUP - x, n), group = hf_group(x + i);
        for (; i < end; i += VF_N, row += 8 * VF_N) {
            for (int k = 0; k < 8 * VF_N; k += 64)
                __builtin_prefetch((const uint8_t *)((uintptr_t)row + (uintptr_t)ahead) + k);
            count_block(vf_load(row), near_last, far_first, &sums);
            count_block(vf_load(row + 4 * VF_N), near_last, far_first, &sums);
        }
        c->near_groups |= (uint64_t)vm_any(sums.is_near) << group;
        c->far_groups |= (uint64_t)vm_any(sums.is_far) << group;
        sums.is_near = sums.is_far = no;
    }
    return sums;
}

static void count_row_simd(const struct hf_frame *f, int x, int y, int n, struct hf_counts *counts)
{
    const int whole = hf_min(n, (f->s->width - 2 * x) / 2) / VF_N * VF_N;
    if (!hf_gaussian(f->s)->by_limits || whole <= 0) {
        hf_gaussian_count_c(f, x, y, n, counts);
        return;
    }
    struct hf_counts c = {0};
    const struct limit_sums sums = count_lanes(f, x, y, whole, &c);
    // A NaN needs its neighbours, so the plain C does the row.
    if (vm_any(sums.nan)) {
        hf_gaussian_count_c(f, x, y, n, counts);
        return;
    }
    const uint32_t near = vi_sum(sums.near), far = vi_sum(sums.far);
    const float nearest = -vf_most(vf_sub(vf_zero(), sums.first));
    counts->near_pixels += near;
    counts->far_pixels += far;
    counts->sharp_pixels += 2 * (uint64_t)whole - near - far;
    counts->no_surface += vi_sum(sums.none);
    counts->near_groups |= c.near_groups;
    counts->far_groups |= c.far_groups;
    counts->near_max = __builtin_fmaxf(counts->near_max, hf_gaussian_near(f->s, nearest));
    counts->far_max = __builtin_fmaxf(counts->far_max, hf_gaussian_far(f->s, vf_most(sums.last)));
    if (whole < n)
        hf_gaussian_count_c(f, x + whole, y, n - whole, counts);
}

#endif
