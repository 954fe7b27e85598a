// SPDX-License-Identifier: BSD-3-Clause
// Where the gaussian engine meets the picture: shrinking it, and merging the blur into it, a block of 2 VF_N pixels at a
// time from the picture to the picture. Nothing is fused, as in blur_simd.h.
#include "gaussian/blur_simd.h"
#include "gaussian/kernels.h"
#include "pixel/coc_vf.h"
#include "pixel/depth_rows.h"
#include "pixel/format_vf.h"

// 2 VF_N pixels of a row further on: a tile's rows are too short for hardware prefetchers to catch on.
#define MERGE_FETCH(p, stride, rows, bytes, write)                                                                     \
    for (int k_ = 0; k_ < (bytes); k_ += 64)                                                                           \
    __builtin_prefetch((const uint8_t *)((uintptr_t)(p) + (uintptr_t)((rows) * (stride))) + k_, write)

// ---- shrinking ----

// VF_N lanes: sums of pairs over all rows, each pixel weighed by share. Returns lanes that are not finite.
HF_INLINE vm shrink_block(const int format, const int bpp, const int channels, const uint8_t *const row[4],
                          const int rows, ptrdiff_t stride, vf share, vf sum[4])
{
    vm bad = vf_gt(vf_zero(), vf_zero());
    for (int i = 0; i < rows; i++) {
        vf e[4], o[4];
        MERGE_FETCH(row[i], stride, rows, 2 * VF_N * bpp, 0);
        bad = vm_or(bad, load_block(format, row[i], e, o));
        for (int c = 0; c < channels; c++) {
            const vf pair = vf_add(vf_mul(e[c], share), vf_mul(o[c], share));
            sum[c] = i ? vf_add(sum[c], pair) : pair;
        }
    }
    return bad;
}

// n lanes, all of them inside the picture: a multiple of VF_N, of 2 VF_N for quarters. Returns 0 if there may be a sample
// that is not finite.
HF_INLINE int shrink_lanes(const struct hf_frame *f, const int format, const int bpp, const int channels,
                           const int rows, int x, int y, int n, float *const sum[4])
{
    const struct hf_image *m = f->src;
    const vf share = vf_set1(1.0f / (float)(rows * rows));
    const uint8_t *row[4];
    vm bad = vf_gt(vf_zero(), vf_zero());
    for (int i = 0; i < rows; i++)
        row[i] = plane_at(m, 0, bpp, x, hf_min(y * rows + i, m->height - 1));
    for (int k = 0; k < n; k += VF_N) {
        vf a[4], b[4];
        bad = vm_or(bad, shrink_block(format, bpp, channels, row, rows, m->stride[0], share, a));
        for (int i = 0; i < rows; i++)
            row[i] += 2 * VF_N * bpp;
        if (rows == 2) {
            for (int c = 0; c < channels; c++)
                vf_store(sum[c] + k, a[c]);
            continue;
        }
        k += VF_N;
        bad = vm_or(bad, shrink_block(format, bpp, channels, row, rows, m->stride[0], share, b));
        for (int i = 0; i < rows; i++)
            row[i] += 2 * VF_N * bpp;
        for (int c = 0; c < channels; c++) {
            vf even, odd;
            vf_unzip(a[c], b[c], &even, &odd);
            vf_store(sum[c] + (k - VF_N) / 2, vf_add(even, odd));
        }
    }
    return !vm_any(bad);
}

HF_INLINE int shrink_rows(const struct hf_frame *f, const int format, const int bpp, const int channels, int x, int y,
                          int n, float *const sum[4])
{
    return f->s->resolution == HF_RESOLUTION_QUARTER ? shrink_lanes(f, format, bpp, channels, 4, x, y, n, sum)
                                                     : shrink_lanes(f, format, bpp, channels, 2, x, y, n, sum);
}

static void shrink_simd(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                        float *const sum[4])
{
    const int quarter = f->s->resolution == HF_RESOLUTION_QUARTER, whole = 2 * VF_N;
    int done = hf_min(n, (f->s->width - 2 * x) / 2) / whole * whole, finite = 0;
    switch (f->src->format) {
    case HF_FORMAT_R11G11B10F:
        finite = shrink_rows(f, HF_FORMAT_R11G11B10F, 4, 3, x, y, done, sum);
        break;
    case HF_FORMAT_RGB32F:
        finite = shrink_rows(f, HF_FORMAT_RGB32F, 12, 3, x, y, done, sum);
        break;
    case HF_FORMAT_RGBA16F:
        finite = shrink_rows(f, HF_FORMAT_RGBA16F, 8, 4, x, y, done, sum);
        break;
    case HF_FORMAT_RGBA32F:
        finite = shrink_rows(f, HF_FORMAT_RGBA32F, 16, 4, x, y, done, sum);
        break;
    default:
        break;
    }
    done = finite ? done : 0;
    float *rest[4];
    for (int c = 0; c < f->s->channels; c++)
        rest[c] = sum[c] + (done >> quarter);
    if (done < n)
        hf_gaussian_shrink_c(f, x + done, y, n - done, even, odd, rest);
}

// ---- merging ----

// Of a row of the blur: the row that it belongs to and the next one, from the working pixel of lane r.x0 on.
struct merge_rows {
    const float *own, *next;
    ptrdiff_t plane;
    float w;  // of the next
};

HF_INLINE struct merge_rows merge_rows_at(const struct hf_buf *b, const int scale, int x, int y)
{
    const int row = y / scale, phase = y % scale, column = 2 * x / scale;
    return (struct merge_rows){.own = hf_at(b, 0, column, row),
                               .next = hf_at(b, 0, column, 2 * phase < scale ? row - 1 : row + 1),
                               .plane = b->ch[1] - b->ch[0],
                               .w = scale == 1                 ? 0
                                    : scale == 2               ? 0.25f
                                    : phase == 0 || phase == 3 ? 0.375f
                                                               : 0.125f};
}

// Channel c of the blur at 4 VF_N pixels from lane i on: even and odd ones of both halves. As gaussian_up_simd.
HF_INLINE void merge_up(const struct merge_rows *r, const int scale, int c, int i, vf even[2], vf odd[2])
{
    const float *own = r->own + c * r->plane, *next = r->next + c * r->plane;
    if (scale == 4) {
        const int x = i / 2;
        const vf v = up_column(own, next, x, r->w), left = up_column(own, next, x - 1, r->w);
        const vf right = up_column(own, next, x + 1, r->w);
        vf_zip(between_vf(v, left, 0.375f), between_vf(v, right, 0.125f), &even[0], &even[1]);
        vf_zip(between_vf(v, left, 0.125f), between_vf(v, right, 0.375f), &odd[0], &odd[1]);
        return;
    }
    for (int k = 0; k < 2; k++) {
        const int x = i + k * VF_N;
        if (scale == 1) {
            vf_unzip(vf_load(own + 2 * x), vf_load(own + 2 * x + VF_N), &even[k], &odd[k]);
            continue;
        }
        const vf v = up_column(own, next, x, r->w);
        even[k] = between_vf(v, up_column(own, next, x - 1, r->w), 0.25f);
        odd[k] = between_vf(v, up_column(own, next, x + 1, r->w), 0.25f);
    }
}

HF_INLINE vf merge_mix(vf a, vf b, vf t)
{
    return vf_select(vf_eq(t, vf_zero()), a, vf_add(a, vf_mul(t, vf_sub(b, a))));
}

// Blend factors of 2 VF_N pixels from their distances, as blend_coc makes them. Returns lanes that are no number.
HF_INLINE vm merge_blend(const struct hf_setup *s, const uint8_t *depth, vf t[2])
{
    vf d[2];
    vf_unzip(vf_load(depth), vf_load(depth + 4 * VF_N), &d[0], &d[1]);
    for (int o = 0; o < 2; o++) {
        vm none;
        const vf v = coc_variable(s, HF_FORM_Z, d[o], vf_zero(), vf_zero(), &none);
        t[o] = vf_mul(vf_set1(s->strength), vf_max(coc_near(s, v), coc_far(s, v)));
    }
    return vf_unordered(d[0], d[1]);
}

// Lanes from r.x0 on, a multiple of 2 VF_N. lines: even and odd blend factors, NULL: made here, of depth. Returns how many
// were done: n, or those before a block with a sample that is not finite.
HF_INLINE int merge_lanes(const struct hf_frame *f, const int format, const int bpp, const int channels,
                          const int scale, int y, struct hf_rect r, int n, float *const *lines, vi *clamped)
{
    const struct hf_setup s = *f->s;  // stores cannot change it, so that it stays in registers
    const uint8_t *depth = lines ? NULL : hf_depth_row(f, 2 * r.x0, y, 2 * n, 0);
    const struct merge_rows rows = merge_rows_at(&f->buf[HF_GAUSSIAN_BLUR], scale, r.x0, y);
    const uint8_t *from = plane_at(f->src, 0, bpp, r.x0, y);
    uint8_t *to = plane_at(f->dst, 0, bpp, r.x0, y);
    for (int i = 0; i < n; i += 2 * VF_N) {
        vf colour[2][2][4], up[2][2], t[2][2];
        vm bad = vf_gt(vf_zero(), vf_zero());
        for (int k = 0; k < 2; k++) {
            const size_t at = (size_t)(i + k * VF_N) * 2 * (size_t)bpp;
            MERGE_FETCH(from + at, f->src->stride[0], 2, 2 * VF_N * bpp, 0);
            MERGE_FETCH(to + at, f->dst->stride[0], 2, 2 * VF_N * bpp, 1);
            bad = vm_or(bad, load_block(format, from + at, colour[k][0], colour[k][1]));
            if (lines) {
                t[k][0] = vf_load(lines[0] + i + k * VF_N);
                t[k][1] = vf_load(lines[1] + i + k * VF_N);
            } else {
                const uint8_t *d = depth + (size_t)(i + k * VF_N) * 8;
                MERGE_FETCH(d, f->depth->stride, 2, 8 * VF_N, 0);
                bad = vm_or(bad, merge_blend(&s, d, t[k]));
            }
        }
        if (vm_any(bad))
            return i;
        for (int c = 0; c < channels; c++) {
            merge_up(&rows, scale, c, i, up[0], up[1]);
            for (int k = 0; k < 2; k++)
                for (int o = 0; o < 2; o++)
                    colour[k][o][c] = merge_mix(colour[k][o][c], up[o][k], t[k][o]);
        }
        for (int k = 0; k < 2; k++)
            store_block(format, to + (size_t)(i + k * VF_N) * 2 * (size_t)bpp, colour[k][0], colour[k][1], clamped);
    }
    return n;
}

HF_INLINE int merge_scales(const struct hf_frame *f, const int format, const int bpp, const int channels, int y,
                           struct hf_rect r, int n, float *const *lines, vi *clamped)
{
    switch (f->s->resolution) {
    case HF_RESOLUTION_QUARTER:
        return r.x0 % 2 ? 0 : merge_lanes(f, format, bpp, channels, 4, y, r, n, lines, clamped);
    case HF_RESOLUTION_HALF:
        return merge_lanes(f, format, bpp, channels, 2, y, r, n, lines, clamped);
    default:
        return merge_lanes(f, format, bpp, channels, 1, y, r, n, lines, clamped);
    }
}

HF_INLINE int merge_format(const struct hf_frame *f, const int format, const int bpp, const int channels, int y,
                           struct hf_rect r, int n, vi *clamped)
{
    float *const lines[4] = {hf_line(f, 8), hf_line(f, 9), hf_line(f, 10), hf_line(f, 11)};
    if (f->s->form == HF_FORM_Z && !hf_gaussian(f->s)->by_depth)
        return merge_scales(f, format, bpp, channels, y, r, n, NULL, clamped);
    blend_row_simd(f, r.x0, y, n, lines, NULL);
    return merge_scales(f, format, bpp, channels, y, r, n, lines, clamped);
}

// Two formats of float colours go from picture to picture in registers, all others through lines.
static void merge_simd(const struct hf_frame *f, int y, struct hf_rect r)
{
    const enum hf_format format = f->src->format;
    const int pixels = hf_min(2 * r.x1, f->s->width) - 2 * r.x0;
    const int n = f->dst->format == format ? pixels / 2 / (2 * VF_N) * (2 * VF_N) : 0;
    // In place, a sample that is not finite wants neighbours that have not been overwritten.
    const int in_place = f->src->data[0] == f->dst->data[0];
    vi clamped = vi_set1(0);
    int done = 0;
    if (n && format == HF_FORMAT_R11G11B10F &&
        !(in_place && !f->k->finite_r11(plane_at(f->src, 0, 4, r.x0, y), (size_t)pixels, NULL)))
        done = merge_format(f, HF_FORMAT_R11G11B10F, 4, 3, y, r, n, &clamped);
    else if (n && format == HF_FORMAT_RGB32F &&
             !(in_place && !f->k->finite_f32(plane_at(f->src, 0, 12, r.x0, y), 3 * (size_t)pixels, NULL)))
        done = merge_format(f, HF_FORMAT_RGB32F, 12, 3, y, r, n, &clamped);
    f->counts->clamped += vi_sum(clamped);
    if (done < r.x1 - r.x0)
        hf_gaussian_merge_c(f, y, (struct hf_rect){r.x0 + done, r.y0, r.x1, r.y1});
}
