// SPDX-License-Identifier: BSD-3-Clause
// Rows of images on vectors: load, store, check, round.
#include "pixel/format_vf.h"

// Load one row of one plane from its first byte. bpp: bytes per pixel. pixels: how many of the 2n pixels exist. A
// tile's rows are too short for hardware prefetchers, so each row prefetches the one after next.
HF_INLINE int load_plane(const int format, const int bpp, const int channels, const uint8_t *p, ptrdiff_t stride, int n,
                         int pixels, float *const even[4], float *const odd[4])
{
    vm bad = vf_gt(vf_zero(), vf_zero());
    for (int i = 0; i < n; i += VF_N) {
        uint8_t rest[2 * VF_N * FORMAT_MAX_BYTES];
        const uint8_t *from = p + (size_t)i * 2 * bpp;
        const int left = pixels - 2 * i;
        for (int k = 0; k < 2 * VF_N * bpp; k += 64)
            __builtin_prefetch((const uint8_t *)((uintptr_t)from + (uintptr_t)(2 * stride)) + k);
        if (left < 2 * VF_N) {
            // At the row's end, memory behind it must not be read. Its last pixel is repeated.
            memcpy(rest, from, (size_t)left * bpp);
            for (int k = left; k < 2 * VF_N; k++)
                memcpy(rest + k * bpp, rest + (left - 1) * bpp, bpp);
            from = rest;
        }
        vf e[4], o[4];
        bad = vm_or(bad, load_block(format, from, e, o));
        for (int c = 0; c < channels; c++) {
            vf_store(even[c] + i, e[c]);
            vf_store(odd[c] + i, o[c]);
        }
    }
    return vm_any(bad);
}

HF_INLINE uint32_t store_plane(const int format, const int bpp, const int channels, uint8_t *p, ptrdiff_t stride, int n,
                               int pixels, const float *const even[4], const float *const odd[4])
{
    vi clamped = vi_set1(0);
    for (int i = 0; i < n; i += VF_N) {
        const int left = pixels - 2 * i;
        for (int k = 0; k < 2 * VF_N * bpp; k += 64)
            __builtin_prefetch((uint8_t *)((uintptr_t)p + (uintptr_t)(2 * stride)) + (size_t)i * 2 * bpp + k, 1);
        vf e[4], o[4];
        for (int c = 0; c < channels; c++) {
            e[c] = even[c] ? vf_load(even[c] + i) : vf_set1(1);
            o[c] = odd[c] ? vf_load(odd[c] + i) : vf_set1(1);
        }
        if (left >= 2 * VF_N) {
            store_block(format, p + (size_t)i * 2 * bpp, e, o, &clamped);
            continue;
        }
        // At the row's end, only pixels inside the image may be counted or written.
        uint8_t rest[2 * VF_N * FORMAT_MAX_BYTES];
        for (int c = 0; c < channels; c++) {
            float lane[2][VF_N];
            vf_store(lane[0], e[c]);
            vf_store(lane[1], o[c]);
            for (int k = left; k < 2 * VF_N; k++)
                lane[k & 1][k / 2] = 0;
            e[c] = vf_load(lane[0]);
            o[c] = vf_load(lane[1]);
        }
        store_block(format, rest, e, o, &clamped);
        memcpy(p + (size_t)i * 2 * bpp, rest, (size_t)left * bpp);
    }
    return vi_sum(clamped);
}

#define HF_FORMAT_ROWS(name, format, bpp, channels)                                                                    \
    static int load_##name##_simd(const struct hf_image *m, int x, int y, int n, float *const even[4],                 \
                                  float *const odd[4])                                                                 \
    {                                                                                                                  \
        return load_plane(format, bpp, channels, plane_at(m, 0, bpp, x, y), m->stride[0], n, m->width - 2 * x, even,   \
                          odd);                                                                                        \
    }                                                                                                                  \
    static uint64_t store_##name##_simd(const struct hf_image *m, int x, int y, int n, const float *const even[4],     \
                                        const float *const odd[4])                                                     \
    {                                                                                                                  \
        return store_plane(format, bpp, channels, plane_at(m, 0, bpp, x, y), m->stride[0], n,                          \
                           hf_min(m->width - 2 * x, 2 * n), even, odd);                                                \
    }

HF_FORMAT_ROWS(rgba32f, HF_FORMAT_RGBA32F, 16, 4)
HF_FORMAT_ROWS(rgb32f, HF_FORMAT_RGB32F, 12, 3)
HF_FORMAT_ROWS(rgba16f, HF_FORMAT_RGBA16F, 8, 4)
HF_FORMAT_ROWS(r11, HF_FORMAT_R11G11B10F, 4, 3)

// Integer formats: each transfer curve has a loop of its own.
#define HF_UNORM_ROWS(name, format, bpp, channels)                                                                     \
    HF_FORMAT_ROWS(name##_linear, format, bpp, channels)                                                               \
    HF_FORMAT_ROWS(name##_srgb, format | UNORM_SRGB, bpp, channels)                                                    \
    static int load_##name##_simd(const struct hf_image *m, int x, int y, int n, float *const even[4],                 \
                                  float *const odd[4])                                                                 \
    {                                                                                                                  \
        return m->transfer == HF_TRANSFER_SRGB ? load_##name##_srgb_simd(m, x, y, n, even, odd)                        \
                                               : load_##name##_linear_simd(m, x, y, n, even, odd);                     \
    }                                                                                                                  \
    static uint64_t store_##name##_simd(const struct hf_image *m, int x, int y, int n, const float *const even[4],     \
                                        const float *const odd[4])                                                     \
    {                                                                                                                  \
        return m->transfer == HF_TRANSFER_SRGB ? store_##name##_srgb_simd(m, x, y, n, even, odd)                       \
                                               : store_##name##_linear_simd(m, x, y, n, even, odd);                    \
    }

HF_UNORM_ROWS(rgba8, HF_FORMAT_RGBA8, 4, 4)
HF_UNORM_ROWS(bgra8, HF_FORMAT_BGRA8, 4, 4)
HF_UNORM_ROWS(rgbx8, HF_FORMAT_RGBX8, 4, 3)
HF_UNORM_ROWS(bgrx8, HF_FORMAT_BGRX8, 4, 3)
HF_UNORM_ROWS(rgb10a2, HF_FORMAT_RGB10A2, 4, 4)
HF_UNORM_ROWS(rgba16, HF_FORMAT_RGBA16, 8, 4)

static int load_planar_simd(const struct hf_image *m, int x, int y, int n, float *const even[4], float *const odd[4])
{
    int bad = 0;
    for (int c = 0; c < hf_plane_count(m); c++)
        bad |= load_plane(HF_FORMAT_PLANAR32F, 4, 1, plane_at(m, c, 4, x, y), m->stride[c], n, m->width - 2 * x,
                          even + c, odd + c);
    return bad;
}

static uint64_t store_planar_simd(const struct hf_image *m, int x, int y, int n, const float *const even[4],
                                  const float *const odd[4])
{
    for (int c = 0; c < hf_plane_count(m); c++)
        store_plane(HF_FORMAT_PLANAR32F, 4, 1, plane_at(m, c, 4, x, y), m->stride[c], n,
                    hf_min(m->width - 2 * x, 2 * n), even + c, odd + c);
    return 0;
}

// ---- checks and rounding ----

enum copy_how { COPY_NOT, COPY_PLAIN, COPY_STREAM };

// Whether whole vectors of words are finite. masks select the exponents in a word; 16-bit words are checked in pairs.
HF_INLINE int finite_vectors(const uint8_t *p, size_t bytes, const uint32_t masks[3], const int count, uint8_t *to,
                             const enum copy_how how)
{
    vm bad = vf_gt(vf_zero(), vf_zero());
    for (size_t i = 0; i + 4 * VF_N <= bytes; i += 4 * VF_N) {
        const vi u = vi_load(p + i);
        if (how == COPY_PLAIN)
            vi_store(to + i, u);
        if (how == COPY_STREAM)
            vf_stream(to + i, vi_as_vf(u));
        for (int k = 0; k < count; k++) {
            const vi mask = vi_set1((int32_t)masks[k]);
            bad = vm_or(bad, vi_eq(vi_and(u, mask), mask));
        }
    }
    if (how == COPY_STREAM)
        vf_stream_end();
    return !vm_any(bad);
}

// Aligned copies go past the caches, because nothing here reads them again.
HF_INLINE int finite_words(const uint8_t *p, size_t bytes, const uint32_t masks[3], const int count, uint8_t *to)
{
    const int finite = !to                          ? finite_vectors(p, bytes, masks, count, to, COPY_NOT)
                       : (uintptr_t)to % (4 * VF_N) ? finite_vectors(p, bytes, masks, count, to, COPY_PLAIN)
                                                    : finite_vectors(p, bytes, masks, count, to, COPY_STREAM);
    size_t i = bytes / (4 * VF_N) * (4 * VF_N);
    if (!finite)
        return 0;
    if (to)
        memcpy(to + i, p + i, bytes - i);
    for (; i < bytes; i += 4) {
        uint32_t u = 0;
        memcpy(&u, p + i, bytes - i < 4 ? bytes - i : 4);
        for (int k = 0; k < count; k++)
            if ((u & masks[k]) == masks[k])
                return 0;
    }
    return 1;
}

static int finite_f32_simd(const void *words, size_t n, void *copy)
{
    static const uint32_t masks[3] = {0x7f800000};
    return finite_words(words, 4 * n, masks, 1, copy);
}

static int finite_f16_simd(const void *words, size_t n, void *copy)
{
    static const uint32_t masks[3] = {0x7c00, 0x7c000000};
    return finite_words(words, 2 * n, masks, 2, copy);
}

static int finite_any_simd(const void *words, size_t n, void *copy)
{
    return finite_words(words, 4 * n, NULL, 0, copy);
}

static int finite_r11_simd(const void *words, size_t n, void *copy)
{
    static const uint32_t masks[3] = {0x7c0, 0x3e0000, 0xf8000000};
    return finite_words(words, 4 * n, masks, 3, copy);
}

static void truncate_r11_simd(float *r, float *g, float *b, int n)
{
    for (int i = 0; i < n; i += VF_N) {
        vf_store(r + i, truncate_channel(vf_load(r + i), 0));
        vf_store(g + i, truncate_channel(vf_load(g + i), 1));
        vf_store(b + i, truncate_channel(vf_load(b + i), 2));
    }
}

static void round_half_simd(float *v, int n)
{
    for (int i = 0; i < n; i += VF_N)
        vf_store(v + i, round_half_vf(vf_load(v + i)));
}

static void format_init(struct hf_pixel_kernels *k)
{
#define ROWS(format, name)                                                                                             \
    k->load[HF_FORMAT_##format] = load_##name##_simd;                                                                  \
    k->store[HF_FORMAT_##format] = store_##name##_simd;
    ROWS(RGBA32F, rgba32f)
    ROWS(RGB32F, rgb32f)
    ROWS(RGBA16F, rgba16f)
    ROWS(R11G11B10F, r11)
    ROWS(PLANAR32F, planar)
    ROWS(RGBA8, rgba8)
    ROWS(BGRA8, bgra8)
    ROWS(RGBX8, rgbx8)
    ROWS(BGRX8, bgrx8)
    ROWS(RGB10A2, rgb10a2)
    ROWS(RGBA16, rgba16)
#undef ROWS
    k->finite_f32 = finite_f32_simd;
    k->finite_f16 = finite_f16_simd;
    k->finite_r11 = finite_r11_simd;
    k->finite_any = finite_any_simd;
    k->truncate_r11 = truncate_r11_simd;
    k->round_half = round_half_simd;
}
