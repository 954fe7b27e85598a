// SPDX-License-Identifier: BSD-3-Clause
// Integer colour on vectors, as in unorm.h. Nothing is fused, so bits are the same everywhere. A pixel is one 32-bit
// word, or two for RGBA16. Words are split first into even and odd pixels, then into channels.
#ifndef HF_UNORM_SIMD_H
#define HF_UNORM_SIMD_H

#include "pixel/unorm.h"
#include "simd/simd.h"

enum { UNORM_SRGB = 0x100 };  // added to a format: the sRGB transfer

HF_INLINE int unorm_bits(const int format, const int c)
{
    return format == HF_FORMAT_RGBA16 ? 16 : format != HF_FORMAT_RGB10A2 ? 8 : c == 3 ? 2 : 10;
}

// With up to 8 lanes, loads are as fast as a gather, and emulators get them right.
HF_INLINE vf unorm_lookup(vi code)
{
#if defined __AVX512F__
    return vf_gather(hf_srgb8, code);
#else
    uint32_t index[VF_N];
    float value[VF_N];
    vi_store(index, code);
    for (int i = 0; i < VF_N; i++)
        value[i] = hf_srgb8[index[i]];
    return vf_load(value);
#endif
}

HF_INLINE vf unorm_decode(vi code, const int bits, const int srgb)
{
    static const float p[6] = HF_SRGB_DECODE;
    if (srgb && bits == 8)
        return unorm_lookup(code);
    const vf s = vf_mul(vi_to_vf(code), vf_set1(1 / (float)((1 << bits) - 1)));
    if (!srgb)
        return s;
    const vf u = vf_mul(vf_add(s, vf_set1(0.055f)), vf_set1(1 / 1.055f)), r = vf_sqrt(vf_sqrt(u));
    vf sum = vf_set1(p[0]);
    for (int i = 1; i < 6; i++)
        sum = vf_add(vf_mul(sum, r), vf_set1(p[i]));
    return vf_select(vf_gt(s, vf_set1(0.04045f)), vf_mul(vf_mul(u, u), sum), vf_mul(s, vf_set1(1 / 12.92f)));
}

HF_INLINE vi unorm_encode(vf in, const int bits, const int srgb, vi *clamped)
{
    static const float p[8] = HF_SRGB_ENCODE;
    vf v = vf_saturate(in);
    *clamped = vi_count(*clamped, vf_ne(v, in));
    if (srgb) {
        const vf q = vf_sqrt(vf_sqrt(v));
        vf sum = vf_set1(p[0]);
        for (int i = 1; i < 8; i++)
            sum = vf_add(vf_mul(sum, q), vf_set1(p[i]));
        const vf curve = vf_sub(vf_mul(sum, vf_set1(1.055f)), vf_set1(0.055f));
        v = vf_select(vf_gt(v, vf_set1(0.0031308f)), curve, vf_mul(v, vf_set1(12.92f)));
    }
    return vf_to_vi(vf_add(vf_mul(v, vf_set1((float)((1 << bits) - 1))), vf_set1(0.5f)));
}

// Shift counts must be literals.
HF_INLINE vi unorm_shift_down(vi u, const int n)
{
    return n == 0    ? u
           : n == 8  ? vi_shr(u, 8)
           : n == 10 ? vi_shr(u, 10)
           : n == 16 ? vi_shr(u, 16)
           : n == 20 ? vi_shr(u, 20)
           : n == 24 ? vi_shr(u, 24)
                     : vi_shr(u, 30);
}

HF_INLINE vi unorm_shift_up(vi u, const int n)
{
    return n == 0    ? u
           : n == 8  ? vi_shl(u, 8)
           : n == 10 ? vi_shl(u, 10)
           : n == 16 ? vi_shl(u, 16)
           : n == 20 ? vi_shl(u, 20)
           : n == 24 ? vi_shl(u, 24)
                     : vi_shl(u, 30);
}

// Where channel c lies in its word.
HF_INLINE int unorm_place(const int format, const int c)
{
    if (format == HF_FORMAT_RGBA16)
        return c & 1 ? 16 : 0;
    if (format == HF_FORMAT_RGB10A2)
        return 10 * c;
    return c < 3 && (format == HF_FORMAT_BGRA8 || format == HF_FORMAT_BGRX8) ? 16 - 8 * c : 8 * c;
}

// The words of VF_N pixels: one vector, or two for RGBA16 (R and G, B and A).
HF_INLINE void unorm_unpack(const int format, const int srgb, const vi words[2], vf out[4])
{
    for (int c = 0; c < 4; c++) {
        const int bits = unorm_bits(format, c);
        const vi word = words[format == HF_FORMAT_RGBA16 && c > 1];
        const vi code = vi_and(unorm_shift_down(word, unorm_place(format, c)), vi_set1((1 << bits) - 1));
        if (c < 3 || (format != HF_FORMAT_RGBX8 && format != HF_FORMAT_BGRX8))
            out[c] = unorm_decode(code, bits, srgb && c < 3);
    }
}

HF_INLINE void unorm_pack(const int format, const int srgb, const vf in[4], vi words[2], vi *clamped)
{
    const int no_alpha = format == HF_FORMAT_RGBX8 || format == HF_FORMAT_BGRX8;
    words[0] = no_alpha ? vi_set1((int32_t)0xff000000u) : vi_set1(0);
    words[1] = vi_set1(0);
    for (int c = 0; c < (no_alpha ? 3 : 4); c++) {
        const vi code = unorm_encode(in[c], unorm_bits(format, c), srgb && c < 3, clamped);
        vi *word = &words[format == HF_FORMAT_RGBA16 && c > 1];
        *word = vi_or(*word, unorm_shift_up(code, unorm_place(format, c)));
    }
}

// 2 VF_N pixels.
HF_INLINE void unorm_load_block(const int format, const int srgb, const uint8_t *p, vf even[4], vf odd[4])
{
    vf words[2][2];  // even and odd pixels
    if (format == HF_FORMAT_RGBA16) {
        vf rg[2], ba[2];
        for (int i = 0; i < 2; i++)
            vf_unzip(vf_load(p + 8 * i * VF_N), vf_load(p + (8 * i + 4) * VF_N), &rg[i], &ba[i]);
        vf_unzip(rg[0], rg[1], &words[0][0], &words[1][0]);
        vf_unzip(ba[0], ba[1], &words[0][1], &words[1][1]);
    } else {
        vf_unzip(vf_load(p), vf_load(p + 4 * VF_N), &words[0][0], &words[1][0]);
        words[0][1] = words[1][1] = vf_zero();
    }
    for (int o = 0; o < 2; o++) {
        const vi w[2] = {vf_as_vi(words[o][0]), vf_as_vi(words[o][1])};
        unorm_unpack(format, srgb, w, o ? odd : even);
    }
}

HF_INLINE void unorm_store_block(const int format, const int srgb, uint8_t *p, const vf even[4], const vf odd[4],
                                 vi *clamped)
{
    vi w[2][2];
    vf a[2], b[2];
    unorm_pack(format, srgb, even, w[0], clamped);
    unorm_pack(format, srgb, odd, w[1], clamped);
    vf_zip(vi_as_vf(w[0][0]), vi_as_vf(w[1][0]), &a[0], &a[1]);
    if (format != HF_FORMAT_RGBA16) {
        vf_store(p, a[0]);
        vf_store(p + 4 * VF_N, a[1]);
        return;
    }
    vf_zip(vi_as_vf(w[0][1]), vi_as_vf(w[1][1]), &b[0], &b[1]);
    for (int i = 0; i < 2; i++) {
        vf lo, hi;
        vf_zip(a[i], b[i], &lo, &hi);
        vf_store(p + 8 * i * VF_N, lo);
        vf_store(p + (8 * i + 4) * VF_N, hi);
    }
}

#endif
