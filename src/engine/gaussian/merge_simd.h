// SPDX-License-Identifier: BSD-3-Clause
// Blends the blur into the picture, 4 VF_N pixels at a time, from picture to picture. Nothing is fused, as in
// blur_simd.h.
#ifndef HF_GAUSSIAN_MERGE_SIMD_H
#define HF_GAUSSIAN_MERGE_SIMD_H

#include "engine/gaussian/blur_simd.h"
#include "engine/gaussian/kernels.h"
#include "engine/gaussian/shrink_simd.h"
#include "pixel/coc_vf.h"
#include "pixel/depth_rows.h"
#include "pixel/format_vf.h"

// ---- the blend ----

// A row of the blur, interpolated in y to full resolution but not yet in x.
struct merge_rows {
    const float *channel[3];
};

// n lanes from lane x of row y of the frame on. Uses scratch rows 0 to 2.
HF_INLINE struct merge_rows merge_rows_at(const struct hf_frame *f, const int scale, int x, int y, int n)
{
    const struct hf_buf *b = hf_gaussian_buf(f, HF_GAUSSIAN_BLUR);
    const int row = y / scale, phase = y % scale, column = 2 * x / scale, columns = 2 * n / scale;
    const float w = scale == 2 ? 0.25f : phase == 0 || phase == 3 ? 0.375f : 0.125f;
    struct merge_rows r;
    for (int c = 0; c < 3; c++) {
        const float *own = hf_at(b, c, column, row);
        r.channel[c] = own;
        if (scale == 1)
            continue;
        const float *next = hf_at(b, c, column, 2 * phase < scale ? row - 1 : row + 1);
        float *line = hf_line(f, c) + HF_PAD;
        line[-1] = own[-1] + 2 * w * (0.5f * next[-1] - 0.5f * own[-1]);
        for (int i = 0; i < columns; i += VF_N)
            vf_store(line + i, up_column(own, next, i, w));
        line[columns] = own[columns] + 2 * w * (0.5f * next[columns] - 0.5f * own[columns]);
        r.channel[c] = line;
    }
    return r;
}

// Upsample a channel of the blur to 4 VF_N pixels from lane i on: even and odd ones of both halves. As
// gaussian_up_simd.
HF_INLINE void merge_up(const float *line, const int scale, int i, vf even[2], vf odd[2])
{
    if (scale == 4) {
        const float *p = line + i / 2;
        const vf v = vf_load(p), left = vf_load(p - 1), right = vf_load(p + 1);
        vf_zip(between_vf(v, left, 0.375f), between_vf(v, right, 0.125f), &even[0], &even[1]);
        vf_zip(between_vf(v, left, 0.125f), between_vf(v, right, 0.375f), &odd[0], &odd[1]);
        return;
    }
    for (int k = 0; k < 2; k++) {
        const float *p = line + i + k * VF_N;
        if (scale == 1) {
            p = line + 2 * (i + k * VF_N);
            vf_unzip(vf_load(p), vf_load(p + VF_N), &even[k], &odd[k]);
            continue;
        }
        const vf v = vf_load(p);
        even[k] = between_vf(v, vf_load(p - 1), 0.25f);
        odd[k] = between_vf(v, vf_load(p + 1), 0.25f);
    }
}

// As lerp_row_simd. Colours of the small float formats are finite and never -0, so with t = 0 the sum is the colour
// itself.
HF_INLINE vf merge_mix(const int format, vf a, vf b, vf t)
{
    const vf mixed = vf_add(a, vf_mul(t, vf_sub(b, a)));
    return format == HF_FORMAT_R11G11B10F ? mixed : vf_select(vf_eq(t, vf_zero()), a, mixed);
}

// Blend factors of 2 VF_N pixels from their depth, as blend_coc makes them in the simplest case: by range, linear and
// unrounded. Clamping the larger of two numbers to 0..1 gives the larger of both clamped. Returns the NaN lanes.
HF_INLINE vm merge_blend(const struct hf_setup *s, const uint8_t *depth, vf t[2])
{
    const vf infinity = vf_set1(__builtin_inff());
    vf d[2];
    vf_unzip(vf_load(depth), vf_load(depth + 4 * VF_N), &d[0], &d[1]);
    for (int o = 0; o < 2; o++) {
        const vf z = vf_select(vm_and(vf_gt(d[o], vf_zero()), vf_lt(d[o], vf_set1(1e10f))), d[o], infinity);
        const vf near = vf_mul(vf_sub(vf_set1(s->near_0), z), vf_set1(s->near_i));
        const vf far = vf_mul(vf_sub(z, vf_set1(s->far_0)), vf_set1(s->far_i));
        t[o] = vf_mul(vf_set1(s->strength), vf_min(vf_max(far, vf_max(near, vf_zero())), vf_set1(1)));
    }
    return vf_unordered(d[0], d[1]);
}

// Blend lanes from r.x0 on, a multiple of 2 VF_N. lines: even and odd blend factors; NULL: computed here from depth.
// Returns how many were done: n, or those before a block that has a sample that is not finite or too far from its blur
// for a float.
HF_INLINE int merge_lanes(const struct hf_frame *f, const int format, const int bpp, const int scale, int y,
                          struct hf_rect r, int n, float *const *lines, vi *clamped)
{
    const struct hf_setup s = *f->s;  // a copy, which stores cannot change, so it stays in registers
    const uint8_t *depth = lines ? NULL : hf_depth_row(f, 2 * r.x0, y, 2 * n, 0);
    const struct merge_rows rows = merge_rows_at(f, scale, r.x0, y, n);
    const uint8_t *from = plane_at(f->src, 0, bpp, r.x0, y);
    uint8_t *to = plane_at(f->dst, 0, bpp, r.x0, y);
    for (int i = 0; i < n; i += 2 * VF_N) {
        vf colour[2][2][4], up[2][2], t[2][2];
        vm bad = vf_gt(vf_zero(), vf_zero());
        for (int k = 0; k < 2; k++) {
            const size_t at = (size_t)(i + k * VF_N) * 2 * (size_t)bpp;
            GAUSSIAN_FETCH(from + at, f->src->stride[0], 2, 2 * VF_N * bpp, 0);
            GAUSSIAN_FETCH(to + at, f->dst->stride[0], 2, 2 * VF_N * bpp, 1);
            bad = vm_or(bad, load_block(format, from + at, colour[k][0], colour[k][1]));
            if (lines) {
                t[k][0] = vf_load(lines[0] + i + k * VF_N);
                t[k][1] = vf_load(lines[1] + i + k * VF_N);
            } else {
                const uint8_t *d = depth + (size_t)(i + k * VF_N) * 8;
                GAUSSIAN_FETCH(d, f->depth->stride, 2, 8 * VF_N, 0);
                bad = vm_or(bad, merge_blend(&s, d, t[k]));
            }
        }
        for (int c = 0; c < 3; c++) {
            merge_up(rows.channel[c], scale, i, up[0], up[1]);
            for (int k = 0; k < 2; k++)
                for (int o = 0; o < 2; o++) {
                    colour[k][o][c] = merge_mix(format, colour[k][o][c], up[o][k], t[k][o]);
                    if (format != HF_FORMAT_R11G11B10F)
                        bad = vm_or(bad, not_finite(colour[k][o][c]));
                }
        }
        if (vm_any(bad))
            return i;
        for (int k = 0; k < 2; k++)
            store_block(format, to + (size_t)(i + k * VF_N) * 2 * (size_t)bpp, colour[k][0], colour[k][1], clamped);
    }
    return n;
}

HF_INLINE int merge_scales(const struct hf_frame *f, const int format, const int bpp, int y, struct hf_rect r, int n,
                           float *const *lines, vi *clamped)
{
    switch (hf_gaussian(f->s)->resolution) {
    case HF_RESOLUTION_QUARTER:
        return r.x0 % 2 ? 0 : merge_lanes(f, format, bpp, 4, y, r, n, lines, clamped);
    case HF_RESOLUTION_HALF:
        return merge_lanes(f, format, bpp, 2, y, r, n, lines, clamped);
    default:
        return merge_lanes(f, format, bpp, 1, y, r, n, lines, clamped);
    }
}

HF_INLINE int merge_format(const struct hf_frame *f, const int format, const int bpp, int y, struct hf_rect r, int n,
                           vi *clamped)
{
    float *const lines[4] = {hf_line(f, 8), hf_line(f, 9), hf_line(f, 10), hf_line(f, 11)};
    const struct hf_setup *s = f->s;
    if (s->form == HF_FORM_Z && !hf_gaussian(s)->by_depth && !s->lens && !s->smoothstep &&
        s->storage == HF_STORAGE_FLOAT)
        return merge_scales(f, format, bpp, y, r, n, NULL, clamped);
    blend_row_simd(f, r.x0, y, n, lines, NULL);
    return merge_scales(f, format, bpp, y, r, n, lines, clamped);
}

// Two formats of float colours go from picture to picture in registers, all others through lines.
static void merge_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const enum hf_format format = f->src->format;
    const int pixels = hf_min(2 * r.x1, f->s->width) - 2 * r.x0;
    const int direct = f->dst->format == format && !f->s->highlight.on && !f->s->part;
    const int n = direct ? pixels / 2 / (2 * VF_N) * (2 * VF_N) : 0;
    // Repairing a sample needs its neighbours, which in place may be overwritten already.
    const int in_place = f->src->data[0] == f->dst->data[0] && !f->repaired;
    vi clamped = vi_set1(0);
    int done = 0;
    if (n && format == HF_FORMAT_R11G11B10F &&
        !(in_place && !f->k->finite_r11(plane_at(f->src, 0, 4, r.x0, y), (size_t)pixels, NULL)))
        done = merge_format(f, HF_FORMAT_R11G11B10F, 4, y, r, n, &clamped);
    else if (n && format == HF_FORMAT_RGB32F &&
             !(in_place && !f->k->finite_f32(plane_at(f->src, 0, 12, r.x0, y), 3 * (size_t)pixels, NULL)))
        done = merge_format(f, HF_FORMAT_RGB32F, 12, y, r, n, &clamped);
    f->counts->clamped += vi_sum(clamped);
    if (done < r.x1 - r.x0)
        hf_gaussian_merge_c(f, y, (struct hf_rect){r.x0 + done, r.y0, r.x1, r.y1});
}

#endif
