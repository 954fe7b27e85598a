// SPDX-License-Identifier: BSD-3-Clause
// What Downsample on vectors is made of: rows come split into even and odd pixels, so a quad is four aligned loads.
#ifndef HF_DOWN_VF_H
#define HF_DOWN_VF_H

#include "base/cpu.h"
#include "pixel/coc_vf.h"
#include "pixel/fields.h"
#include "pixel/format_vf.h"

HF_INLINE vf down_sum(const vf c[4])
{
    return vf_add(vf_add(c[0], c[1]), vf_add(c[2], c[3]));
}

HF_INLINE vf down_limited(vf v, float largest)
{
    return vf_min(vf_max(v, vf_set1(-largest)), vf_set1(largest));
}

// Lanes of a row that are too large; only those that there are.
static uint64_t down_count(vf sum, int lanes, float largest)
{
    float v[VF_N];
    uint64_t n = 0;
    vf_store(v, sum);
    for (int i = 0; i < hf_min(lanes, VF_N); i++)
        n += !(__builtin_fabsf(v[i]) <= largest);
    return n;
}

// R11G11B10F words of a quad as floats 2^112 times too small: see r11_unpack. Sums of four have the bits that they
// have at full size, products with weights do not.
HF_INLINE void down_unpack(const vi u[4], vf quad[3][4])
{
    for (int i = 0; i < 4; i++) {
        quad[0][i] = vi_as_vf(vi_and(vi_shl(u[i], 17), vi_set1(0x7ff << 17)));
        quad[1][i] = vi_as_vf(vi_and(vi_shl(u[i], 6), vi_set1(0x7ff << 17)));
        quad[2][i] = vi_as_vf(vi_and(vi_shr(u[i], 4), vi_set1(0x3ff << 18)));
    }
}

// The next words of the two rows of quads of R11G11B10F at p, as down_unpack wants them.
HF_INLINE void down_load(const struct hf_image *m, const uint8_t *const p[2], int x, vi u[4])
{
    for (int row = 0; row < 2; row++) {
        const uint8_t *from = p[row] + 8 * x;
        vf even, odd;
        for (int k = 0; k < 8 * VF_N; k += 64)
            __builtin_prefetch((const uint8_t *)((uintptr_t)from + (uintptr_t)(2 * m->stride[0])) + k);
        vf_unzip(vf_load(from), vf_load(from + 4 * VF_N), &even, &odd);
        u[2 * row] = vf_as_vi(even);
        u[2 * row + 1] = vf_as_vi(odd);
    }
}

// One sample that is not finite makes 65536 / 4 at least.
HF_INLINE int down_is_finite(vf largest)
{
    return !vm_any(vm_not(vf_lt(largest, vf_set1(16384))));
}

// Up to where a row of quads can be made of R11G11B10F words: the last vector that lies in the picture as a whole.
HF_INLINE int down_words_end(const struct hf_frame *f, struct hf_rect r)
{
    return hf_min(r.x1, r.x0 + (f->s->width / 2 - r.x0) / VF_N * VF_N);
}

// Are the planes of a frame so large that what is written first has left the cache, through which the pictures go too,
// before it is read? Then they are written past it, and push nothing else out.
HF_INLINE int down_streams(const struct hf_frame *f, struct hf_rect r)
{
    enum { LARGE = 12 << 20 };
    const struct hf_buf *b = &f->buf[HF_BUF_COC4];
    const size_t bytes = (size_t)b->stride * (size_t)f->s->half_height * 8 * sizeof(float);
    return bytes > LARGE && bytes > hf_cpu_cache() / 2 && (uintptr_t)hf_at(b, 0, r.x0, r.y0) % sizeof(vf) == 0;
}

// The colour of n quads from lane x of row y on, by way of lines.
struct down_lines {
    float *lane[4][4];  // [row and even or odd][channel]
};

HF_INLINE struct down_lines down_read(const struct hf_frame *f, int x, int y, int n)
{
    struct down_lines l;
    for (int i = 0; i < 16; i++)
        l.lane[i >> 2][i & 3] = hf_line(f, i);
    hf_read_colour(f, x, 2 * y, n, l.lane[0], l.lane[1], f->seen);
    hf_read_colour(f, x, hf_min(2 * y + 1, f->s->height - 1), n, l.lane[2], l.lane[3], f->seen);
    return l;
}

// The quads of a channel from lane x of these on; returns their means, those too large are counted as clamped.
HF_INLINE vf down_quads(const struct hf_frame *f, const struct down_lines *l, int c, int x, int n, float largest,
                        vf quad[4])
{
    for (int i = 0; i < 4; i++)
        quad[i] = vf_load(l->lane[i][c] + x);
    const vf sum = vf_mul(vf_set1(0.25f), down_sum(quad));
    if (vm_any(vm_not(vf_le(vf_abs(sum), vf_set1(largest)))))
        f->counts->clamped += down_count(sum, n - x, largest);
    return sum;
}

// The two rows of words of row y of quads.
HF_INLINE void down_words(const struct hf_image *m, int x, int y, const uint8_t *p[2])
{
    for (int row = 0; row < 2; row++)
        p[row] = plane_at(m, 0, 4, x, hf_min(2 * y + row, m->height - 1));
}

#endif
