// SPDX-License-Identifier: BSD-3-Clause
// Rows of the gaussian engine on vectors. Multiply and add are fused only where that changes no bit, so the bits are
// the same everywhere, fast or deterministic.
#ifndef HF_GAUSSIAN_BLUR_SIMD_H
#define HF_GAUSSIAN_BLUR_SIMD_H

#include <float.h>

#include "pixel/depth_rows.h"
#include "engine/gaussian/kernels.h"
#include "pixel/coc_vf.h"

// 1 2 1. Doubling is exact, so fusing changes no bit.
HF_INLINE vf smooth_vf(vf a, vf b, vf c)
{
    return vf_muladd_fused(vf_set1(2), b, vf_add(a, c));
}

// The 5-tap kernel is 1 2 1 twice, applied down a column one sample at a time. It keeps the last two samples and their
// last two sums, so a sample costs one load.
struct column {
    vf v[2], q[2];
};

// Take the next sample of a column; returns the result two samples back.
HF_INLINE vf smooth_down(struct column *p, vf sample)
{
    const vf v = vf_mul(sample, vf_set1(0.0625f));
    const vf q = smooth_vf(p->v[0], p->v[1], v), sum = smooth_vf(p->q[0], p->q[1], q);
    *p = (struct column){{p->v[1], v}, {p->q[1], q}};
    return sum;
}

HF_INLINE vf five_faithful_vf(vf a, vf b, vf c, vf d, vf e)
{
    const vf half = vf_set1(0.5f), most = vf_set1(FLT_MAX), least = vf_set1(-FLT_MAX);
    const vf outer = vf_mul(vf_add(vf_mul(a, half), vf_mul(e, half)), vf_set1(2 * 0.3f));
    const vf inner = vf_mul(vf_add(vf_mul(b, half), vf_mul(d, half)), vf_set1(2 * 0.15f));
    return vf_max(vf_min(vf_add(vf_add(outer, inner), vf_mul(c, vf_set1(0.1f))), most), least);
}

HF_INLINE vf line_sums(const float *p)
{
    const vf sixteenth = vf_set1(0.0625f);
    const vf a = vf_mul(vf_load(p - 1), sixteenth), c = vf_mul(vf_load(p + 1), sixteenth);
    return smooth_vf(a, vf_mul(vf_load(p), sixteenth), c);
}

static void gaussian_line_simd(const float *in, int n, float *out, int faithful)
{
    if (faithful) {
        for (int i = 0; i < n; i += VF_N) {
            const float *p = in + i;
            vf_store(out + i,
                     five_faithful_vf(vf_load(p - 2), vf_load(p - 1), vf_load(p), vf_load(p + 1), vf_load(p + 2)));
        }
        return;
    }
    // Neighbours of pixels are loaded, neighbours of sums are shifted from registers: on Zen 4 shifts share a unit with
    // additions, and four of them were a third slower. Sums are one pixel ahead; before the first vector only the last
    // two of them matter.
    vf ahead = line_sums(in + 1 - VF_N), own = vf_back(ahead, ahead);
    for (int i = 0; i < n; i += VF_N) {
        const vf next = line_sums(in + i + 1), middle = vf_back(ahead, next);
        vf_store(out + i, smooth_vf(vf_back(own, middle), middle, next));
        ahead = next;
        own = middle;
    }
}

// Two vectors of columns keep enough additions in flight and need few registers.
HF_INLINE void columns_pair(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                            ptrdiff_t out_stride)
{
    struct column p = {{vf_zero(), vf_zero()}, {vf_zero(), vf_zero()}}, q = p;
    vf a = vf_zero(), b = a;
    for (int y = from - 2; y < to + 2; y++) {
        if (y < rows) {  // past the end the last row repeats, though it may be overwritten in memory
            const float *row = in + hf_max(y, 0) * in_stride;
            a = vf_load(row);
            b = vf_load(row + VF_N);
        }
        const vf sum = smooth_down(&p, a), sum_b = smooth_down(&q, b);
        if (y < from + 2)
            continue;
        vf_store(out, sum);
        vf_store(out + VF_N, sum_b);
        out += out_stride;
    }
}

HF_INLINE void columns_faithful(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                                ptrdiff_t out_stride)
{
    vf v[5];
    for (int i = 0; i < 4; i++)
        v[i + 1] = vf_load(in + hf_max(0, hf_min(rows - 1, from - 2 + i)) * in_stride);
    for (int y = from; y < to; y++, out += out_stride) {
        for (int i = 0; i < 4; i++)
            v[i] = v[i + 1];
        v[4] = y + 2 < rows ? vf_load(in + (y + 2) * in_stride) : v[3];
        vf_store(out, five_faithful_vf(v[0], v[1], v[2], v[3], v[4]));
    }
}

static void gaussian_columns_simd(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                                  ptrdiff_t out_stride, int n, int faithful)
{
    if (faithful)
        for (int x = 0; x < n; x += VF_N)
            columns_faithful(in + x, in_stride, rows, from, to, out + x, out_stride);
    else
        for (int x = 0; x < n; x += 2 * VF_N)
            columns_pair(in + x, in_stride, rows, from, to, out + x, out_stride);
}

static void lerp_row_simd(float *a, const float *b, const float *t, int n)
{
    for (int i = 0; i < n; i += VF_N) {
        const vf w = vf_load(t + i), v = vf_load(a + i), to = vf_load(b + i), apart = vf_sub(to, v);
        const vm near = vf_le(vf_abs(apart), vf_set1(FLT_MAX));
        vf mixed = vf_add(v, vf_mul(w, apart));
        if (vm_any(vm_not(near)))
            mixed = vf_select(near, mixed, vf_add(vf_mul(vf_sub(vf_set1(1), w), v), vf_mul(w, to)));
        vf_store(a + i, vf_select(vf_eq(w, vf_zero()), v, mixed));
    }
}

// ---- blend factors ----

// As hf_gaussian_depth.
HF_INLINE vf gaussian_depth_vf(const struct hf_setup *s, const int faithful, vf z)
{
    const vf far = vf_set1(hf_gaussian(s)->plane_far);
    z = vf_min(vf_max(z, vf_set1(hf_gaussian(s)->plane_near)), far);
    return faithful ? vf_div(vf_mul(vf_set1(2), z), vf_add(z, far)) : vf_div(z, far);
}

struct blend_sums {
    vi any, none;
    vm nan;
};

HF_INLINE vf blend_vf(const struct hf_setup *s, const enum hf_depth_form form, const int faithful, vf d, vf px, vf py,
                      struct blend_sums *sums)
{
    vm none;
    const vf z = coc_variable(s, form, d, px, py, &none);
    const vf distance = vf_abs(vf_sub(gaussian_depth_vf(s, faithful, z), vf_set1(hf_gaussian(s)->focus_d)));
    vf t = vf_min(vf_mul(vf_set1(3), distance), vf_set1(1));
    if (s->smoothstep)
        t = vf_smoothstep(t);
    t = vf_mul(vf_set1(s->strength), t);
    sums->nan = vm_or(sums->nan, vf_ne(d, d));
    sums->none = vi_count(sums->none, none);
    sums->any = vi_count(sums->any, vf_gt(t, vf_zero()));
    return t;
}

HF_INLINE void blend_depth(const struct hf_frame *f, const enum hf_depth_form form, const int faithful, int x, int y,
                           int n, float *const out[4], struct blend_sums *sums)
{
    const struct hf_setup *s = f->s;
    const uint8_t *row = hf_depth_row(f, 2 * x, y, 2 * n, 0);
    static const float steps[16] = {0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30};
    const vf py = vf_set1((float)y + 0.5f - s->ray_cy), step = vf_load(steps);
    for (int i = 0; i < n; i += VF_N, row += 8 * VF_N) {
        vf even, odd;
        vf_unzip(vf_load(row), vf_load(row + 4 * VF_N), &even, &odd);
        const vf px = vf_add(vf_set1((float)(2 * (x + i))), step);
        const vf px_even = vf_sub(vf_add(px, vf_set1(0.5f)), vf_set1(s->ray_cx));
        const vf px_odd = vf_sub(vf_add(px, vf_set1(1.5f)), vf_set1(s->ray_cx));
        vf_store(out[0] + i, blend_vf(s, form, faithful, even, px_even, py, sums));
        vf_store(out[1] + i, blend_vf(s, form, faithful, odd, px_odd, py, sums));
    }
}

HF_INLINE void blend_forms(const struct hf_frame *f, const int faithful, int x, int y, int n, float *const out[4],
                           struct blend_sums *sums)
{
    switch (f->s->form) {
    case HF_FORM_RAY:
        blend_depth(f, HF_FORM_RAY, faithful, x, y, n, out, sums);
        break;
    case HF_FORM_IZ:
        blend_depth(f, HF_FORM_IZ, faithful, x, y, n, out, sums);
        break;
    default:
        blend_depth(f, HF_FORM_Z, faithful, x, y, n, out, sums);
        break;
    }
}

static void blend_coc(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    struct hf_counts unused = {0};
    const vf strength = vf_set1(f->s->strength);
    f->k->coc_row(f, x, y, n, out, counts ? counts : &unused);
    for (int i = 0; i < n; i += VF_N)
        for (int o = 0; o < 2; o++)
            vf_store(out[o] + i, vf_mul(strength, vf_max(vf_load(out[o] + i), vf_load(out[2 + o] + i))));
}

static void blend_row_simd(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts)
{
    if (!hf_gaussian(f->s)->by_depth) {
        blend_coc(f, x, y, n, out, counts);
        return;
    }
    const int whole = hf_min(n, (f->s->width - 2 * x) / 2) / VF_N * VF_N;
    struct blend_sums sums = {vi_set1(0), vi_set1(0), vf_gt(vf_zero(), vf_zero())};
    if (hf_gaussian(f->s)->faithful)
        blend_forms(f, 1, x, y, whole, out, &sums);
    else
        blend_forms(f, 0, x, y, whole, out, &sums);
    // A NaN needs its neighbours, so the plain C does the row again; elsewhere its bits are the same.
    const int from = vm_any(sums.nan) ? 0 : whole;
    float *const rest[4] = {out[0] + from, out[1] + from, NULL, NULL};
    if (from < n)
        hf_blend_row_c(f, x + from, y, n - from, rest, counts);
    if (!counts || from == 0)
        return;
    const uint32_t any = vi_sum(sums.any);
    counts->far_pixels += any;
    for (int i = 0; i < whole; i += VF_N) {
        const vf t = vf_max(vf_load(out[0] + i), vf_load(out[1] + i));
        counts->far_groups |= (uint64_t)vm_any(vf_gt(t, vf_zero())) << hf_group(x + i);
    }
    counts->sharp_pixels += 2 * (uint64_t)whole - any;
    counts->no_surface += vi_sum(sums.none);
}

// ---- upsampling ----

// a + w (b - a), computed from halves as in the C.
HF_INLINE vf between_vf(vf a, vf b, float w)
{
    const vf half = vf_set1(0.5f);
    return vf_add(a, vf_mul(vf_set1(2 * w), vf_sub(vf_mul(half, b), vf_mul(half, a))));
}

// Interpolate a vector in y, from column x on.
HF_INLINE vf up_column(const float *own, const float *next, int x, float w)
{
    return between_vf(vf_load(own + x), vf_load(next + x), w);
}

static void gaussian_up_simd(const struct hf_buf *b, int c, int quarter, int x, int y, int n, float *even, float *odd)
{
    const int scale = quarter ? 4 : 2, row = y / scale, phase = y % scale;
    const float *own = hf_at(b, c, quarter ? x / 2 : x, row);
    const float *next = hf_at(b, c, quarter ? x / 2 : x, 2 * phase < scale ? row - 1 : row + 1);
    const float w = !quarter ? 0.25f : phase == 0 || phase == 3 ? 0.375f : 0.125f;
    if (!quarter) {
        for (int i = 0; i < n; i += VF_N) {
            const vf v = up_column(own, next, i, w);
            vf_store(even + i, between_vf(v, up_column(own, next, i - 1, w), 0.25f));
            vf_store(odd + i, between_vf(v, up_column(own, next, i + 1, w), 0.25f));
        }
        return;
    }
    if (x % 2) {
        hf_gaussian_up_c(b, c, quarter, x, y, n, even, odd);
        return;
    }
    // Each sample makes four pixels; the first and third are even ones.
    for (int i = 0; i < n; i += 2 * VF_N) {
        const vf v = up_column(own, next, i / 2, w), left = up_column(own, next, i / 2 - 1, w);
        const vf right = up_column(own, next, i / 2 + 1, w);
        vf p, q;
        vf_zip(between_vf(v, left, 0.375f), between_vf(v, right, 0.125f), &p, &q);
        vf_store(even + i, p);
        vf_store(even + i + VF_N, q);
        vf_zip(between_vf(v, left, 0.125f), between_vf(v, right, 0.375f), &p, &q);
        vf_store(odd + i, p);
        vf_store(odd + i + VF_N, q);
    }
}

#endif
