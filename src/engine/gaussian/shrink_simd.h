// SPDX-License-Identifier: BSD-3-Clause
// The picture at half or a quarter of its size, on vectors.
#ifndef HF_GAUSSIAN_SHRINK_SIMD_H
#define HF_GAUSSIAN_SHRINK_SIMD_H

#include "engine/gaussian/kernels.h"
#include "pixel/format_vf.h"

// Prefetch a block some rows ahead: a tile's rows are too short for hardware prefetchers.
#define GAUSSIAN_FETCH(p, stride, rows, bytes, write)                                                                  \
    for (int k_ = 0; k_ < (bytes); k_ += 64)                                                                           \
    __builtin_prefetch((const uint8_t *)((uintptr_t)(p) + (uintptr_t)((rows) * (stride))) + k_, write)

// Sums of neighbouring pairs: of 2 VF_N numbers, VF_N.
HF_INLINE vf shrink_pairs(vf a, vf b)
{
    vf even, odd;
    vf_unzip(a, b, &even, &odd);
    return vf_add(even, odd);
}

// For VF_N lanes: sum down all rows, each pixel times share, and sum pairs. Returns the lanes that are not finite.
HF_INLINE vm shrink_block(const int format, const int bpp, const int channels, const uint8_t *const row[4],
                          const int rows, ptrdiff_t stride, vf share, vf sum[4])
{
    vm bad = vf_gt(vf_zero(), vf_zero());
    vf odd[4];
    for (int i = 0; i < rows; i++) {
        vf e[4], o[4];
        GAUSSIAN_FETCH(row[i], stride, rows, 2 * VF_N * bpp, 0);
        bad = vm_or(bad, load_block(format, row[i], e, o));
        for (int c = 0; c < channels; c++) {
            const vf own = vf_mul(e[c], share), next = vf_mul(o[c], share);
            sum[c] = i ? vf_add(sum[c], own) : own;
            odd[c] = i ? vf_add(odd[c], next) : next;
        }
    }
    for (int c = 0; c < channels; c++)
        sum[c] = vf_add(sum[c], odd[c]);
    return bad;
}

// Shrink n lanes inside the picture, a multiple of VF_N, of 2 VF_N for quarters. Returns 0 if a sample may not be
// finite.
HF_INLINE int shrink_lanes(const struct hf_frame *f, const int format, const int bpp, const int channels,
                           const int rows, const uint8_t *row[4], int n, float *const sum[4])
{
    const ptrdiff_t stride = f->src->stride[0];
    const vf share = vf_set1(1.0f / (float)(rows * rows));
    vm bad = vf_gt(vf_zero(), vf_zero());
    for (int k = 0; k < n; k += VF_N) {
        vf a[4], b[4];
        bad = vm_or(bad, shrink_block(format, bpp, channels, row, rows, stride, share, a));
        for (int i = 0; i < rows; i++)
            row[i] += 2 * VF_N * bpp;
        if (rows == 2) {
            for (int c = 0; c < channels; c++)
                vf_store(sum[c] + k, a[c]);
            continue;
        }
        k += VF_N;
        bad = vm_or(bad, shrink_block(format, bpp, channels, row, rows, stride, share, b));
        for (int i = 0; i < rows; i++)
            row[i] += 2 * VF_N * bpp;
        for (int c = 0; c < channels; c++)
            vf_store(sum[c] + (k - VF_N) / 2, shrink_pairs(a[c], b[c]));
    }
    return !vm_any(bad);
}

// Sum VF_N pixels of R11G11B10F down all rows, as the numbers are before r11_channel scales them: these are powers of
// two times exact values, and their sums stay exact, so one product at the end corrects them.
HF_INLINE void shrink_small_block(const uint8_t *const row[4], const int rows, size_t at, vf sum[3])
{
    for (int i = 0; i < rows; i++) {
        const vi u = vi_load(row[i] + at);
        const vf v[3] = {vi_as_vf(vi_and(vi_shl(u, 17), vi_set1(0x7ff << 17))),
                         vi_as_vf(vi_and(vi_shl(u, 6), vi_set1(0x7ff << 17))),
                         vi_as_vf(vi_and(vi_shr(u, 4), vi_set1(0x3ff << 18)))};
        for (int c = 0; c < 3; c++)
            sum[c] = i ? vf_add(sum[c], v[c]) : v[c];
    }
}

// As shrink_lanes. A sample that is not finite has the largest exponent; read as a number it is at least 65536. So a
// mean that may contain one is at least a share of that. Very bright pictures look the same and take the slow path.
HF_INLINE int shrink_small(const struct hf_frame *f, const int rows, const uint8_t *const row[4], int n,
                           float *const sum[4])
{
    const float share = 1.0f / (float)(rows * rows);
    const vf scale = vf_set1(0x1p112f * share);
    const int blocks = rows;  // blocks of VF_N pixels that make VF_N sums
    vf most = vf_zero();
    for (int k = 0; k < n; k += blocks * VF_N / 2) {
        vf v[4][3];
        for (int j = 0; j < blocks; j++) {
            const size_t at = ((size_t)2 * (size_t)k + (size_t)(j * VF_N)) * 4;
            for (int i = 0; i < rows; i++)
                GAUSSIAN_FETCH(row[i] + at, f->src->stride[0], rows, 4 * VF_N, 0);
            shrink_small_block(row, rows, at, v[j]);
        }
        for (int c = 0; c < 3; c++) {
            vf s = shrink_pairs(v[0][c], v[1][c]);
            if (rows == 4)
                s = shrink_pairs(s, shrink_pairs(v[2][c], v[3][c]));
            s = vf_mul(s, scale);
            most = vf_max(most, s);
            vf_store(sum[c] + 2 * k / rows, s);
        }
    }
    return !vm_any(vm_not(vf_lt(most, vf_set1(65536 * share))));
}

HF_INLINE int shrink_format(const struct hf_frame *f, const int rows, int x, int y, int n, float *const sum[4])
{
    const struct hf_image *m = f->src;
    const enum hf_format format = m->format;
    const int bpp = format == HF_FORMAT_R11G11B10F ? 4
                    : format == HF_FORMAT_RGB32F   ? 12
                    : format == HF_FORMAT_RGBA16F  ? 8
                                                   : 16;
    const uint8_t *row[4];
    for (int i = 0; i < rows; i++)
        row[i] = plane_at(m, 0, bpp, x, hf_min(y * rows + i, m->height - 1));
    switch (format) {
    case HF_FORMAT_R11G11B10F:
        return shrink_small(f, rows, row, n, sum) || shrink_lanes(f, HF_FORMAT_R11G11B10F, 4, 3, rows, row, n, sum);
    case HF_FORMAT_RGB32F:
        return shrink_lanes(f, HF_FORMAT_RGB32F, 12, 3, rows, row, n, sum);
    case HF_FORMAT_RGBA16F:
        return shrink_lanes(f, HF_FORMAT_RGBA16F, 8, 4, rows, row, n, sum);
    case HF_FORMAT_RGBA32F:
        return shrink_lanes(f, HF_FORMAT_RGBA32F, 16, 4, rows, row, n, sum);
    default:
        return 0;
    }
}

static void shrink_simd(const struct hf_frame *f, int x, int y, int n, float *const lines[16])
{
    const int quarter = hf_gaussian(f->s)->resolution == HF_RESOLUTION_QUARTER, whole = 2 * VF_N;
    const int inside = f->s->highlight.on ? 0 : hf_min(n, (f->s->width - 2 * x) / 2) / whole * whole;
    const int finite = quarter ? shrink_format(f, 4, x, y, inside, lines) : shrink_format(f, 2, x, y, inside, lines);
    const int done = finite ? inside : 0;
    float *rest[16];
    for (int i = 0; i < 16; i++)
        rest[i] = lines[i] + (i < 4 ? done >> quarter : 0);
    if (done < n)
        hf_gaussian_shrink_c(f, x + done, y, n - done, rest);
}

#endif
