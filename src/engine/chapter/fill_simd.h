// SPDX-License-Identifier: BSD-3-Clause
// Fill on vectors. Maximum and mean are separable: a column's three values are combined once and serve three
// pixels. Only the per-pixel kernel, which picks its neighbours, and the far mean, which counts them, look at all nine.
#include "engine/chapter/chapter.h"
#include "engine/chapter/near_part_vf.h"
#include "pixel/coc_vf.h"
#include "pixel/format_vf.h"

HF_INLINE vf max3(vf a, vf b, vf c)
{
    return vf_max(vf_max(a, b), c);
}

HF_INLINE vf sum3(vf before, vf middle, vf after)
{
    return vf_add(vf_add(before, after), middle);
}

HF_INLINE vf column_max(const float *p, ptrdiff_t stride)
{
    return max3(vf_load(p - stride), vf_load(p), vf_load(p + stride));
}

// 3x3 maxima where want > 0, else the values themselves.
HF_INLINE void fill_max_vector(vf left, vf middle, vf right, const float *in, vm wanted, float *out)
{
    const vf v = vf_add(max3(left, middle, right), vf_zero());
    vf_store(out, vf_select(wanted, v, vf_load(in)));
}

// Of those, in part what begins to be near.
HF_INLINE void fill_max_begins(float *const in[4], float *const out[4], int x, vf want, const int channels)
{
    if (near_begins_vf(want))
        for (int c = 0; c < channels; c++)
            vf_store(out[c] + x, near_part_vf(0, vf_load(in[c] + x), vf_load(out[c] + x), want));
}

// A row of them. A first vector lies where the row begins, the others are aligned: their columns' maxima are made
// once, and shifted for the neighbours.
HF_INLINE void fill_max_row(float *const in[4], ptrdiff_t stride, const float *want, float *const out[4], int n,
                            int first, const int faithful, const int channels)
{
    vf left[4], middle[4], near = vf_load(want);
    vm wanted = vf_gt(near, vf_zero());
    HF_UNROLL(4)
    for (int c = 0; c < channels; c++)
        fill_max_vector(column_max(in[c] - 1, stride), column_max(in[c], stride), column_max(in[c] + 1, stride), in[c],
                        wanted, out[c]);
    if (!faithful)
        fill_max_begins(in, out, 0, near, channels);
    int x = VF_N - (first & (VF_N - 1));
    HF_UNROLL(4)
    for (int c = 0; c < channels && x < n; c++) {
        left[c] = column_max(in[c] + x - VF_N, stride);
        middle[c] = column_max(in[c] + x, stride);
    }
    for (; x < n; x += VF_N) {
        near = vf_load(want + x);
        wanted = vf_gt(near, vf_zero());
        HF_UNROLL(4)
        for (int c = 0; c < channels; c++) {
            const vf right = column_max(in[c] + x + VF_N, stride);
            fill_max_vector(vf_align(left[c], middle[c], VF_N - 1), middle[c], vf_align(middle[c], right, 1), in[c] + x,
                            wanted, out[c] + x);
            left[c] = middle[c];
            middle[c] = right;
        }
        if (!faithful)
            fill_max_begins(in, out, x, near, channels);
    }
}

static void fill_mean_row(const int faithful, const float *in, ptrdiff_t stride, const float *want, float *out, int n,
                          float *sums)
{
    // Rows first, then their sum, as in the C.
    for (int i = 0; i < 3; i++)
        for (int x = 0; x < n; x += VF_N) {
            const float *p = in + (i - 1) * stride + x;
            vf_store(sums + (size_t)i * (n + HF_PAD) + x, sum3(vf_load(p - 1), vf_load(p), vf_load(p + 1)));
        }
    for (int x = 0; x < n; x += VF_N) {
        const float *p = sums + x;
        const vf v = sum3(vf_load(p), vf_load(p + n + HF_PAD), vf_load(p + 2 * (size_t)(n + HF_PAD)));
        vf_store(out + x, near_part_vf(faithful, vf_load(in + x), vf_mul(v, vf_set1(1 / 9.0f)), vf_load(want + x)));
    }
}

static void fill_copy_row(const float *in, float *out, int n)
{
    for (int x = 0; x < n; x += VF_N)
        vf_store(out + x, vf_load(in + x));
}

// How much a far neighbour counts, 1 or more: wholly; rounded as the C is.
HF_INLINE vf fill_counts(const struct hf_setup *s, vf own, vf g)
{
    const vf one = vf_set1(1), begins = hf_chapter(s)->faithful ? one : vf_mul(vf_set1(4), g);
    if (!hf_fields(s)->per_pixel_kernel)
        return begins;
    const vf apart = vf_mul(vf_set1(4), vf_abs(vf_sub(own, g)));
    if (hf_chapter(s)->faithful)
        return vf_keep(vf_le(apart, one), one);
    return vf_mul(vf_min(begins, one), vf_saturate(vf_sub(vf_set1(2), apart)));
}

// The largest of what nine neighbours bring; part: how much of each counts. With `whole` that is nothing or all of it.
HF_INLINE vf fill_best(const float *in, ptrdiff_t stride, const vf part[9], const int whole)
{
    const vf value = vf_load(in);
    vf best = value;
    HF_UNROLL(9)
    for (int i = 0; i < 9; i++) {
        const vf t = vf_load(in + (i / 3 - 1) * stride + i % 3 - 1);
        const vf less = whole ? value : vf_add(value, vf_mul(part[i], vf_sub(t, value)));
        best = vf_max(vf_select(vf_lt(part[i], vf_set1(1)), less, t), best);
    }
    return vf_add(best, vf_zero());
}

// All nine looked at, for a maximum; how much they count is the same for all channels. Few vectors have neighbours that count in
// part ...
HF_INLINE void fill_far_max(const struct hf_setup *s, float *const in[4], ptrdiff_t stride, const float *coc,
                            ptrdiff_t coc_stride, float *const out[4], int n, const int channels)
{
    const vf one = vf_set1(1);
    for (int x = 0; x < n; x += VF_N) {
        const vf own = vf_load(coc + x);
        const vm is_far = vf_gt(own, vf_zero());
        if (!vm_any(is_far)) {
            for (int c = 0; c < channels; c++)
                vf_store(out[c] + x, vf_load(in[c] + x));
            continue;
        }
        vf part[9];
        vm in_part = vf_gt(vf_zero(), vf_zero());
        HF_UNROLL(9)
        for (int i = 0; i < 9; i++) {
            part[i] = fill_counts(s, own, vf_load(coc + (i / 3 - 1) * coc_stride + x + i % 3 - 1));
            in_part = vm_or(in_part, vm_and(vf_gt(part[i], vf_zero()), vf_lt(part[i], one)));
        }
        const int whole = !vm_any(in_part);
        for (int c = 0; c < channels; c++) {
            const float *p = in[c] + x;
            const vf best = whole ? fill_best(p, stride, part, 1) : fill_best(p, stride, part, 0);
            vf_store(out[c] + x, vf_select(is_far, best, vf_load(p)));
        }
    }
}

// ... and those that are far at all for a mean.
HF_INLINE void fill_far_mean(const struct hf_setup *s, const float *in, ptrdiff_t stride, const float *coc,
                             ptrdiff_t coc_stride, float *out, int n)
{
    for (int x = 0; x < n; x += VF_N) {
        const vf own = vf_load(coc + x), value = vf_load(in + x);
        vf sum[3], count[3];
        for (int j = -1; j <= 1; j++) {
            vf t[3], w[3];
            for (int i = -1; i <= 1; i++) {
                const vf g = vf_load(coc + j * coc_stride + x + i), v = vf_load(in + j * stride + x + i);
                w[i + 1] = vf_keep(vf_gt(g, vf_zero()), vf_min(fill_counts(s, own, g), vf_set1(1)));
                t[i + 1] = vf_keep(vf_gt(w[i + 1], vf_zero()), vf_mul(w[i + 1], v));
            }
            sum[j + 1] = sum3(t[0], t[1], t[2]);
            count[j + 1] = sum3(w[0], w[1], w[2]);
        }
        const vf v = vf_div(sum3(sum[0], sum[1], sum[2]), sum3(count[0], count[1], count[2]));
        vf_store(out + x, vf_select(vf_gt(own, vf_zero()), v, value));
    }
}

static void fill_row(const struct hf_frame *f, int in, int out, const struct hf_buf *want, int want_channel, int y,
                     struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int n = r.x1 - r.x0;
    const ptrdiff_t stride = f->buf[in].stride;
    const float *w = hf_at(want, want_channel, r.x0, y);
    float *to[4], *from[4];
    hf_row(&f->buf[out], s->channels, r.x0, y, to);
    hf_row(&f->buf[in], s->channels, r.x0, y, from);
    const int picked =
        in == HF_BUF_FAR && hf_chapter(s)->fill != HF_FILL_NONE &&
        (hf_fields(s)->per_pixel_kernel || hf_chapter(s)->fill == HF_FILL_MEAN || !hf_chapter(s)->faithful);
    if (hf_chapter(s)->fill == HF_FILL_MAX && !picked) {
        if (s->channels == 4)
            fill_max_row(from, stride, w, to, n, r.x0, hf_chapter(s)->faithful, 4);
        else if (hf_chapter(s)->faithful)
            fill_max_row(from, stride, w, to, n, r.x0, 1, 3);
        else
            fill_max_row(from, stride, w, to, n, r.x0, 0, 3);
    } else if (hf_chapter(s)->fill == HF_FILL_MAX) {
        if (s->channels == 4)
            fill_far_max(s, from, stride, w, want->stride, to, n, 4);
        else
            fill_far_max(s, from, stride, w, want->stride, to, n, 3);
    } else {
        for (int c = 0; c < s->channels; c++)
            if (hf_chapter(s)->fill == HF_FILL_NONE)
                fill_copy_row(from[c], to[c], n);
            else if (picked)
                fill_far_mean(s, from[c], stride, w, want->stride, to[c], n);
            else
                fill_mean_row(hf_chapter(s)->faithful, from[c], stride, w, to[c], n, f->work);
    }
    // The largest of what a storage holds is what it holds.
    if (hf_chapter(s)->fill == HF_FILL_MEAN || (hf_chapter(s)->fill == HF_FILL_MAX && !hf_chapter(s)->faithful))
        hf_store_rgb(f, to, n);
}

static void fill_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        if (f->near)
            fill_row(f, HF_BUF_NEAR, HF_BUF_NEAR_FILL, &f->buf[HF_BUF_BLUR], 0, y, r);
        if (f->far)
            fill_row(f, HF_BUF_FAR, HF_BUF_FAR_FILL, &f->buf[HF_BUF_COC4], 1, y, r);
    }
}
