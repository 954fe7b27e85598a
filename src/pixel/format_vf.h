// SPDX-License-Identifier: BSD-3-Clause
// Load and store vectors in every format. The small floats share one trick: shifted so that their exponent is where a
// float's is, they are floats too small by 2^112, denormals included, and one multiplication corrects that.
#ifndef HF_FORMAT_VF_H
#define HF_FORMAT_VF_H

#include "pixel/pass_c.h"
#include "pixel/unorm_simd.h"
#include "simd/simd.h"

HF_INLINE vf clamp_unsigned(vf v, float max)
{
    return vf_min(vf_max(v, vf_zero()), vf_set1(max));
}

// Encode an unsigned float with m mantissa bits, to nearest even; 0 <= v <= the largest finite. hf_encode_small
// explains how.
HF_INLINE vi encode_normal(vf v, const int m)
{
    const vi u = vf_as_vi(v), odd = vi_and(vi_shr(u, 23 - m), vi_set1(1));
    const vi bias = vi_set1((int32_t)((1u << (22 - m)) - 1 - (112u << 23)));
    return vi_shr(vi_add(vi_add(u, bias), odd), 23 - m);
}

HF_INLINE vi encode_small(vf v, const int m)
{
    const vi normal = encode_normal(v, m);
    const vi magic = vi_set1((127 + 23 - 14 - m) << 23);
    const vi denormal = vi_sub(vf_as_vi(vf_add(v, vi_as_vf(magic))), magic);
    return vf_as_vi(vf_select(vf_lt(v, vf_set1(0x1p-14f)), vi_as_vf(denormal), vi_as_vf(normal)));
}

// v as a float 2^112 times too small, so that the small format's exponent and m mantissa bits are its upper bits; the
// bits below may be anything. v is cut before the product, so the product is exact in the bits that count.
HF_INLINE vi small_bits(vf v, const int m)
{
    const vi cut = vi_and(vf_as_vi(v), vi_set1((int32_t)(0xffffffffu << (23 - m))));
    return vf_as_vi(vf_mul(vi_as_vf(cut), vf_set1(0x1p-112f)));
}

// A float with the value of v truncated to m mantissa bits and 5 exponent bits.
HF_INLINE vf truncate_small(vf v, const int m)
{
    const vi bits = vi_and(small_bits(v, m), vi_set1((int32_t)(0xffffffffu << (23 - m))));
    return vf_mul(vi_as_vf(bits), vf_set1(0x1p112f));
}

// Channel c of R11G11B10F words. *most: the largest bits so far, before the multiplication; none is negative.
HF_INLINE vf r11_channel(vi u, const int c, vi *most)
{
    const vi v = c == 0   ? vi_and(vi_shl(u, 17), vi_set1(0x7ff << 17))
                 : c == 1 ? vi_and(vi_shl(u, 6), vi_set1(0x7ff << 17))
                          : vi_and(vi_shr(u, 4), vi_set1(0x3ff << 18));
    *most = vi_max(*most, v);
    return vf_mul(vi_as_vf(v), vf_set1(0x1p112f));
}

HF_INLINE void r11_unpack(vi u, vf out[3], vi *most)
{
    for (int c = 0; c < 3; c++)
        out[c] = r11_channel(u, c, most);
}

// The bits of v relative to those of 2^-14, to be cut after rounding to m mantissa bits. Smaller numbers give huge
// results, unless they round to 2^-14.
HF_INLINE vi r11_from_smallest(vf v, const int m)
{
    return vi_add(vf_as_vi(v), vi_set1((int32_t)((1u << (22 - m)) - 1 - (113u << 23))));
}

HF_INLINE vi r11_odd(vf v, const int m)
{
    return vi_and(vi_shr(vf_as_vi(v), 23 - m), vi_set1(1));
}

// Kept out of line and called with arguments in registers: this case is rare, and inlined it would take registers from
// the common one.
HF_INLINE vi r11_pack_any(vf red, vf green, vf blue, vi *clamped)
{
    static const float max[3] = {HF_R11_MAX, HF_R11_MAX, HF_R10_MAX};
    const vf in[3] = {red, green, blue};
    vf v[3];
    for (int c = 0; c < 3; c++) {
        v[c] = clamp_unsigned(in[c], max[c]);
        *clamped = vi_count(*clamped, vf_ne(v[c], in[c]));
    }
    return vi_or(vi_or(encode_small(v[0], 6), vi_shl(encode_small(v[1], 6), 11)), vi_shl(encode_small(v[2], 5), 22));
}

// Pack two vectors. Usually nothing needs clamping and nothing is denormal or zero, which halves the work. As unsigned
// numbers relative to the smallest normal one, small, negative and NaN values are all large.
HF_INLINE void r11_pack(const vf in[2][4], vi out[2], vi *clamped)
{
    vi v[2][3], most = vi_set1(0);
    for (int o = 0; o < 2; o++)
        for (int c = 0; c < 3; c++) {
            v[o][c] = r11_from_smallest(in[o][c], c == 2 ? 5 : 6);
            most = vi_max(most, v[o][c]);
        }
    const int32_t max = (int32_t)(0x477c0000u - (113u << 23) + 0xffff);  // the bits of HF_R10_MAX
    if (__builtin_expect(vm_any(vm_not(vi_le(most, vi_set1(max)))), 0)) {
        for (int o = 0; o < 2; o++)
            out[o] = r11_pack_any(in[o][0], in[o][1], in[o][2], clamped);
        return;
    }
    for (int o = 0; o < 2; o++) {
        for (int c = 0; c < 3; c++)
            v[o][c] = vi_add(v[o][c], r11_odd(in[o][c], c == 2 ? 5 : 6));
        vi u = vi_shr(v[o][0], 17);
        u = vi_or_and(u, vi_shr(v[o][1], 6), vi_set1(0x7ff << 11));
        u = vi_or_and(u, vi_shl(v[o][2], 4), vi_set1((int32_t)(0x3ffu << 22)));
        out[o] = vi_add(u, vi_set1(1 << 6 | 1 << 17 | 1 << 27));  // the exponent of 2^-14
    }
}

// Pack by truncation: no rounding, and denormals need no care.
HF_INLINE vi r11_pack_cut(const vf in[3])
{
    const vi r = small_bits(clamp_unsigned(in[0], HF_R11_MAX), 6), g = small_bits(clamp_unsigned(in[1], HF_R11_MAX), 6);
    const vi b = small_bits(clamp_unsigned(in[2], HF_R10_MAX), 5);
    const vi rg = vi_or_and(vi_shr(r, 17), vi_shr(g, 6), vi_set1(0x7ff << 11));
    return vi_or_and(rg, vi_shl(b, 4), vi_set1((int32_t)(0x3ffu << 22)));
}

#ifdef VF_SOFT_HALF
HF_INLINE vf vf_load_half(const void *p)
{
    const vi u = vi_load_u16(p);
    const vf v = vf_mul(vi_as_vf(vi_shl(vi_and(u, vi_set1(0x7fff)), 13)), vf_set1(0x1p112f));
    return vi_as_vf(vi_or(vf_as_vi(v), vi_shl(vi_and(u, vi_set1(0x8000)), 16)));
}

// v must be finite and within +-65504.
HF_INLINE void vf_store_half(void *p, vf v)
{
    vi_store_u16(p, vi_or(encode_small(vf_abs(v), 10), vi_and(vi_shr(vf_as_vi(v), 16), vi_set1(0x8000))));
}
#endif

// NaN becomes 0.
HF_INLINE vf clamp_half(vf v)
{
    return vf_max(vf_min(vf_keep(vf_eq(v, v), v), vf_set1(HF_HALF_MAX)), vf_set1(-HF_HALF_MAX));
}

HF_INLINE vf round_half_vf(vf v)
{
    uint16_t h[VF_N];
    vf_store_half(h, clamp_half(v));
    return vf_load_half(h);
}

#ifndef VF_OWN_INTERLEAVE
// 4 pixels per 128-bit lane.
HF_INLINE void vf_load_rgba(const float *p, vf out[4])
{
    vf row[4];
    for (int i = 0; i < 4; i++)
        row[i] = vf_load_lanes(p + 4 * i, 16);
    const vf a = vf_shuffle(row[0], row[1], 0x44), b = vf_shuffle(row[0], row[1], 0xee);
    const vf c = vf_shuffle(row[2], row[3], 0x44), d = vf_shuffle(row[2], row[3], 0xee);
    out[0] = vf_shuffle(a, c, 0x88);
    out[1] = vf_shuffle(a, c, 0xdd);
    out[2] = vf_shuffle(b, d, 0x88);
    out[3] = vf_shuffle(b, d, 0xdd);
}

HF_INLINE void vf_store_rgba(float *p, const vf in[4])
{
    const vf a = vf_shuffle(in[0], in[1], 0x44), b = vf_shuffle(in[0], in[1], 0xee);
    const vf c = vf_shuffle(in[2], in[3], 0x44), d = vf_shuffle(in[2], in[3], 0xee);
    vf_store_lanes(p, 16, vf_shuffle(a, c, 0x88));
    vf_store_lanes(p + 4, 16, vf_shuffle(a, c, 0xdd));
    vf_store_lanes(p + 8, 16, vf_shuffle(b, d, 0x88));
    vf_store_lanes(p + 12, 16, vf_shuffle(b, d, 0xdd));
}

// r g b r | g b r g | b r g b: three registers hold 4 pixels per lane.
HF_INLINE void vf_load_rgb(const float *p, vf out[3])
{
    const vf x0 = vf_load_lanes(p, 12), x1 = vf_load_lanes(p + 4, 12), x2 = vf_load_lanes(p + 8, 12);
    const vf high = vf_shuffle(x1, x2, 0x9e), low = vf_shuffle(x0, x1, 0x49);  // r2 g2 r3 g3, g0 b0 g1 b1
    out[0] = vf_shuffle(x0, high, 0x8c);
    out[1] = vf_shuffle(low, high, 0xd8);
    out[2] = vf_shuffle(low, x2, 0xcd);
}

HF_INLINE void vf_store_rgb(float *p, const vf in[3])
{
    const vf a = vf_shuffle(in[0], in[1], 0x88), b = vf_shuffle(in[1], in[2], 0xdd);
    const vf c = vf_shuffle(in[2], in[0], 0xd8);  // b0 b2 r1 r3
    vf_store_lanes(p, 12, vf_shuffle(a, c, 0x88));
    vf_store_lanes(p + 4, 12, vf_shuffle(b, a, 0xd8));
    vf_store_lanes(p + 8, 12, vf_shuffle(c, b, 0xdd));
}
#endif

HF_INLINE vf truncate_channel(vf v, const int c)
{
    return truncate_small(clamp_unsigned(v, c == 2 ? HF_R10_MAX : HF_R11_MAX), c == 2 ? 5 : 6);
}

// Round channel c to what a buffer's storage holds, as a pass writes it. A second run over the rows took 0.1 ms of a
// frame of 1920x1080, in Computation and Fill each.
HF_INLINE vf round_stored(enum hf_storage storage, vf v, const int c)
{
    if (storage == HF_STORAGE_PACKED && c < 3)
        return truncate_channel(v, c);
    return storage == HF_STORAGE_HALF ? round_half_vf(v) : v;
}

HF_INLINE uint8_t *plane_at(const struct hf_image *m, int plane, int bpp, int x, int y)
{
    return (uint8_t *)m->data[plane] + (ptrdiff_t)y * m->stride[plane] + (size_t)x * 2 * bpp;
}

// ---- blocks of 2 VF_N pixels ----

// Both return the lanes that are not finite.
HF_INLINE vm not_small(vf v)
{
    return vm_not(vf_lt(vf_abs(v), vf_set1(65536.0f)));
}

HF_INLINE vm not_finite(vf v)
{
    return vm_not(vf_lt(vf_abs(v), vf_set1(__builtin_inff())));
}

HF_INLINE vm load_block(const int format, const uint8_t *p, vf even[4], vf odd[4])
{
    if (format >= HF_FORMAT_RGBA8) {
        unorm_load_block(format & ~UNORM_SRGB, format & UNORM_SRGB, p, even, odd);
        return vf_gt(vf_zero(), vf_zero());
    }
    vf a[4], b[4];
    vm bad = vf_gt(vf_zero(), vf_zero());
    if (format == HF_FORMAT_R11G11B10F) {
        vf e, o;
        vf_unzip(vf_load(p), vf_load(p + 4 * VF_N), &e, &o);
        vi most = vi_set1(0);
        r11_unpack(vf_as_vi(e), even, &most);
        r11_unpack(vf_as_vi(o), odd, &most);
        return vm_not(vi_le(most, vi_set1((31 << 23) - 1)));
    } else if (format == HF_FORMAT_PLANAR32F) {  // one plane per call
        vf_unzip(vf_load(p), vf_load(p + 4 * VF_N), &even[0], &odd[0]);
    } else {
        if (format == HF_FORMAT_RGBA32F) {
            vf_load_rgba((const float *)(const void *)p, a);
            vf_load_rgba((const float *)(const void *)p + 4 * VF_N, b);
        } else if (format == HF_FORMAT_RGB32F) {
            vf_load_rgb((const float *)(const void *)p, a);
            vf_load_rgb((const float *)(const void *)p + 3 * VF_N, b);
        } else {
            float pixels[8 * VF_N];
            for (int i = 0; i < 8; i++)
                vf_store(pixels + i * VF_N, vf_load_half(p + 2 * i * VF_N));
            vf_load_rgba(pixels, a);
            vf_load_rgba(pixels + 4 * VF_N, b);
        }
        for (int c = 0; c < (format == HF_FORMAT_RGB32F ? 3 : 4); c++)
            vf_unzip(a[c], b[c], &even[c], &odd[c]);
    }
    const int small = format == HF_FORMAT_RGBA16F;
    const int channels = format == HF_FORMAT_PLANAR32F ? 1 : format == HF_FORMAT_RGB32F ? 3 : 4;
    for (int c = 0; c < channels; c++)
        bad = vm_or(bad, small ? vm_or(not_small(even[c]), not_small(odd[c]))
                               : vm_or(not_finite(even[c]), not_finite(odd[c])));
    return bad;
}

HF_INLINE void store_block(const int format, uint8_t *p, const vf even[4], const vf odd[4], vi *clamped)
{
    if (format >= HF_FORMAT_RGBA8) {
        unorm_store_block(format & ~UNORM_SRGB, format & UNORM_SRGB, p, even, odd, clamped);
        return;
    }
    vf a[4], b[4];
    if (format == HF_FORMAT_R11G11B10F) {
        const vf in[2][4] = {{even[0], even[1], even[2]}, {odd[0], odd[1], odd[2]}};
        vi u[2];
        r11_pack(in, u, clamped);
        vf_zip(vi_as_vf(u[0]), vi_as_vf(u[1]), &a[0], &b[0]);
        vf_store(p, a[0]);
        vf_store(p + 4 * VF_N, b[0]);
        return;
    }
    if (format == HF_FORMAT_PLANAR32F) {
        vf_zip(even[0], odd[0], &a[0], &b[0]);
        vf_store(p, a[0]);
        vf_store(p + 4 * VF_N, b[0]);
        return;
    }
    for (int c = 0; c < (format == HF_FORMAT_RGB32F ? 3 : 4); c++) {
        vf e = even[c], o = odd[c];
        if (format == HF_FORMAT_RGBA16F) {
            e = clamp_half(e);
            o = clamp_half(o);
            *clamped = vi_count(vi_count(*clamped, vf_ne(e, even[c])), vf_ne(o, odd[c]));
        }
        vf_zip(e, o, &a[c], &b[c]);
    }
    if (format == HF_FORMAT_RGBA32F) {
        vf_store_rgba((float *)(void *)p, a);
        vf_store_rgba((float *)(void *)p + 4 * VF_N, b);
    } else if (format == HF_FORMAT_RGB32F) {
        vf_store_rgb((float *)(void *)p, a);
        vf_store_rgb((float *)(void *)p + 3 * VF_N, b);
    } else {
        float pixels[8 * VF_N];
        vf_store_rgba(pixels, a);
        vf_store_rgba(pixels + 4 * VF_N, b);
        for (int i = 0; i < 8; i++)
            vf_store_half(p + 2 * i * VF_N, vf_load(pixels + i * VF_N));
    }
}

// ---- rows ----

enum { FORMAT_MAX_BYTES = 16 };

#endif
