// SPDX-License-Identifier: BSD-3-Clause
// Vector operations of 4 floats: NEON of AArch64.
#ifndef HF_VEC_NEON_H
#define HF_VEC_NEON_H

#include <arm_neon.h>
#include <stdint.h>

typedef float32x4_t vf;
typedef uint32x4_t vi;
typedef uint32x4_t vm;  // lanes all ones or all zeros
enum { VF_N = 4 };

// Loads that need no alignment: rows of images need not be aligned to floats.
static inline vf vf_load(const void *p) { return vreinterpretq_f32_u8(vld1q_u8((const uint8_t *)p)); }
static inline void vf_store(void *p, vf a) { vst1q_u8((uint8_t *)p, vreinterpretq_u8_f32(a)); }
// On other machines this stores past the caches; here there is no intrinsic for it.
static inline void vf_stream(void *p, vf a) { vf_store(p, a); }
static inline void vf_stream_end(void) {}
static inline vf vf_set1(float a) { return vdupq_n_f32(a); }
static inline vf vf_zero(void) { return vdupq_n_f32(0); }
static inline vf vf_add(vf a, vf b) { return vaddq_f32(a, b); }
static inline vf vf_sub(vf a, vf b) { return vsubq_f32(a, b); }
static inline vf vf_mul(vf a, vf b) { return vmulq_f32(a, b); }
static inline vf vf_div(vf a, vf b) { return vdivq_f32(a, b); }
static inline vf vf_reciprocal(vf a) { return vrecpeq_f32(a); }  // 8 bits
static inline vf vf_sqrt(vf a) { return vsqrtq_f32(a); }
static inline vf vf_floor(vf a) { return vrndmq_f32(a); }
static inline vf vf_abs(vf a) { return vabsq_f32(a); }
// a > b ? a : b and a < b ? a : b, so b if either is NaN. NEON's own max and min would return the NaN.
static inline vf vf_max(vf a, vf b) { return vbslq_f32(vcgtq_f32(a, b), a, b); }
static inline vf vf_min(vf a, vf b) { return vbslq_f32(vcltq_f32(a, b), a, b); }
static inline vf vf_muladd_fused(vf a, vf b, vf c) { return vfmaq_f32(c, a, b); }
static inline vf vf_mulsub_fused(vf a, vf b, vf c) { return vfmsq_f32(c, a, b); }

static inline vm vf_gt(vf a, vf b) { return vcgtq_f32(a, b); }
static inline vm vf_lt(vf a, vf b) { return vcltq_f32(a, b); }
static inline vm vf_le(vf a, vf b) { return vcleq_f32(a, b); }
static inline vm vf_eq(vf a, vf b) { return vceqq_f32(a, b); }
static inline vm vf_ne(vf a, vf b) { return vmvnq_u32(vceqq_f32(a, b)); }  // true for NaN
static inline vm vf_unordered(vf a, vf b) { return vorrq_u32(vf_ne(a, a), vf_ne(b, b)); }  // either is NaN
static inline vm vm_and(vm a, vm b) { return vandq_u32(a, b); }
static inline vm vm_or(vm a, vm b) { return vorrq_u32(a, b); }
static inline vm vm_not(vm a) { return vmvnq_u32(a); }
static inline int vm_any(vm a) { return vmaxvq_u32(a) != 0; }
static inline vf vf_select(vm m, vf a, vf b) { return vbslq_f32(m, a, b); }
static inline vf vf_keep(vm m, vf a) { return vreinterpretq_f32_u32(vandq_u32(m, vreinterpretq_u32_f32(a))); }
// Lanes of m get a + c or a * b + c, the others c.
static inline vf vf_add_where(vm m, vf a, vf c) { return vf_select(m, vf_add(a, c), c); }
static inline vf vf_muladd_where_fused(vm m, vf a, vf b, vf c) { return vf_select(m, vf_muladd_fused(a, b, c), c); }
// Adds 1 to the lanes of m.
static inline vi vi_count(vi count, vm m) { return vsubq_u32(count, m); }

static inline vi vi_load(const void *p) { return vreinterpretq_u32_u8(vld1q_u8((const uint8_t *)p)); }
static inline void vi_store(void *p, vi a) { vst1q_u8((uint8_t *)p, vreinterpretq_u8_u32(a)); }
static inline vi vi_set1(int32_t a) { return vdupq_n_u32((uint32_t)a); }
static inline vi vi_add(vi a, vi b) { return vaddq_u32(a, b); }
static inline vi vi_sub(vi a, vi b) { return vsubq_u32(a, b); }
static inline vi vi_and(vi a, vi b) { return vandq_u32(a, b); }
static inline vi vi_or(vi a, vi b) { return vorrq_u32(a, b); }
static inline vi vi_xor(vi a, vi b) { return veorq_u32(a, b); }
static inline vi vi_or_and(vi a, vi b, vi c) { return vi_or(a, vi_and(b, c)); }
static inline vi vi_or_xor(vi a, vi b, vi c) { return vi_or(a, vi_xor(b, c)); }
static inline vi vi_max(vi a, vi b) { return vmaxq_u32(a, b); }  // unsigned
static inline int vi_any(vi a) { return vmaxvq_u32(a) != 0; }
static inline vm vi_le(vi a, vi b) { return vcleq_u32(a, b); }
static inline vm vi_eq(vi a, vi b) { return vceqq_u32(a, b); }
#define vi_shl(a, n) vshlq_n_u32(a, n)
#define vi_shr(a, n) vshrq_n_u32(a, n)
static inline vi vf_as_vi(vf a) { return vreinterpretq_u32_f32(a); }
static inline vf vi_as_vf(vi a) { return vreinterpretq_f32_u32(a); }
static inline vi vf_to_vi(vf a) { return vreinterpretq_u32_s32(vcvtq_s32_f32(a)); }
static inline vf vi_to_vf(vi a) { return vcvtq_f32_s32(vreinterpretq_s32_u32(a)); }

// As 16 bytes and as 8 words, unsigned.
#define VI_8(a) vreinterpretq_u8_u32(a)
#define VI_16(a) vreinterpretq_u16_u32(a)
static inline vi vi_max8(vi a, vi b) { return vreinterpretq_u32_u8(vmaxq_u8(VI_8(a), VI_8(b))); }
static inline vi vi_max16(vi a, vi b) { return vreinterpretq_u32_u16(vmaxq_u16(VI_16(a), VI_16(b))); }
static inline vi vi_set16(uint16_t a) { return vreinterpretq_u32_u16(vdupq_n_u16(a)); }
static inline vi vi_add16(vi a, vi b) { return vreinterpretq_u32_u16(vaddq_u16(VI_16(a), VI_16(b))); }
static inline vi vi_sub16(vi a, vi b) { return vreinterpretq_u32_u16(vsubq_u16(VI_16(a), VI_16(b))); }
static inline vi vi_mulhi16(vi a, vi b)
{
    const vi low = vmull_u16(vget_low_u16(VI_16(a)), vget_low_u16(VI_16(b)));
    const vi high = vmull_high_u16(VI_16(a), VI_16(b));
    return vreinterpretq_u32_u16(vuzp2q_u16(VI_16(low), VI_16(high)));
}
#define vi_shl16(a, n) vreinterpretq_u32_u16(vshlq_n_u16(VI_16(a), n))
#define vi_shr16(a, n) vreinterpretq_u32_u16(vshrq_n_u16(VI_16(a), n))
// 16 bytes from byte n on of a followed by b; 0 <= n < 16.
#define vi_align(a, b, n) vreinterpretq_u32_u8(vextq_u8(VI_8(a), VI_8(b), n))
// Load 4 bytes as numbers, and store them.
static inline vi vi_load_u8(const void *p)
{
    uint32_t u;
    __builtin_memcpy(&u, p, 4);
    return vmovl_u16(vget_low_u16(vmovl_u8(vcreate_u8(u))));
}

static inline void vi_store_u8(void *p, vi a)
{
    const uint16x4_t words = vmovn_u32(a);
    const uint32_t u = vget_lane_u32(vreinterpret_u32_u8(vmovn_u16(vcombine_u16(words, words))), 0);
    __builtin_memcpy(p, &u, 4);
}

// Split 8 numbers into even and odd ones, and join them.
static inline void vf_unzip(vf a, vf b, vf *even, vf *odd)
{
    *even = vuzp1q_f32(a, b);
    *odd = vuzp2q_f32(a, b);
}

static inline void vf_zip(vf even, vf odd, vf *a, vf *b)
{
    *a = vzip1q_f32(even, odd);
    *b = vzip2q_f32(even, odd);
}

// 4 numbers from number n on of a followed by b; 0 <= n < 4.
#define vf_align(a, b, n) vextq_f32(a, b, n)

// NEON has instructions for interleaved pixels.
#define VF_OWN_INTERLEAVE 1
static inline void vf_load_rgba(const float *p, vf out[4])
{
    const float32x4x4_t v = vld4q_f32(p);
    for (int i = 0; i < 4; i++)
        out[i] = v.val[i];
}

static inline void vf_store_rgba(float *p, const vf in[4])
{
    vst4q_f32(p, (float32x4x4_t){{in[0], in[1], in[2], in[3]}});
}

static inline void vf_load_rgb(const float *p, vf out[3])
{
    const float32x4x3_t v = vld3q_f32(p);
    for (int i = 0; i < 3; i++)
        out[i] = v.val[i];
}

static inline void vf_store_rgb(float *p, const vf in[3])
{
    vst3q_f32(p, (float32x4x3_t){{in[0], in[1], in[2]}});
}

static inline vf vf_load_half(const void *p)
{
    return vcvt_f32_f16(vreinterpret_f16_u8(vld1_u8((const uint8_t *)p)));
}

static inline void vf_store_half(void *p, vf a)
{
    vst1_u8((uint8_t *)p, vreinterpret_u8_f16(vcvt_f16_f32(a)));
}

// The first half of a vector from a, the second from b; and the two halves of v to a and b.
static inline vf vf_load_halves(const float *a, const float *b)
{
    return vcombine_f32(vld1_f32(a), vld1_f32(b));
}

static inline void vf_store_halves(float *a, float *b, vf v)
{
    vst1_f32(a, vget_low_f32(v));
    vst1_f32(b, vget_high_f32(v));
}

// Shift by one lane: the last lane of prev, then all lanes of cur except the last.
static inline vf vf_back(vf prev, vf cur) { return vextq_f32(prev, cur, 3); }

// p[index] in each lane.
static inline vf vf_gather(const float *p, vi index)
{
    const float v[4] = {p[(int32_t)vgetq_lane_u32(index, 0)], p[(int32_t)vgetq_lane_u32(index, 1)],
                        p[(int32_t)vgetq_lane_u32(index, 2)], p[(int32_t)vgetq_lane_u32(index, 3)]};
    return vld1q_f32(v);
}

// Vectors of half as many doubles: conversion from floats and back, loads and stores.
typedef float64x2_t vd;
enum { VD_N = 2 };
static inline vd vd_load(const float *p) { return vcvt_f64_f32(vld1_f32(p)); }
static inline void vd_store(float *p, vd a) { vst1_f32(p, vcvt_f32_f64(a)); }
static inline vd vd_sum(const double *p) { return vld1q_f64(p); }
static inline void vd_keep_sum(double *p, vd a) { vst1q_f64(p, a); }
static inline vd vd_set1(double a) { return vdupq_n_f64(a); }
static inline vd vd_add(vd a, vd b) { return vaddq_f64(a, b); }
static inline vd vd_mul(vd a, vd b) { return vmulq_f64(a, b); }

// Four 64-bit integers, and four floats, whatever the vector size.
typedef struct { int64x2_t a, b; } vl;
typedef float32x4_t v4;
static inline void v4_store(float *p, v4 a) { vst1q_f32(p, a); }
static inline void v4_transpose(v4 a[4])
{
    const float32x4x2_t x = vtrnq_f32(a[0], a[1]), y = vtrnq_f32(a[2], a[3]);
    for (int i = 0; i < 2; i++) {
        a[i] = vcombine_f32(vget_low_f32(x.val[i]), vget_low_f32(y.val[i]));
        a[i + 2] = vcombine_f32(vget_high_f32(x.val[i]), vget_high_f32(y.val[i]));
    }
}

static inline vl vl_load(const int64_t *p) { return (vl){vld1q_s64(p), vld1q_s64(p + 2)}; }
static inline void vl_store(int64_t *p, vl a)
{
    vst1q_s64(p, a.a);
    vst1q_s64(p + 2, a.b);
}

static inline vl vl_set1(int64_t a) { return (vl){vdupq_n_s64(a), vdupq_n_s64(a)}; }
static inline vl vl_add(vl a, vl b) { return (vl){vaddq_s64(a.a, b.a), vaddq_s64(a.b, b.b)}; }
static inline vl vl_sub(vl a, vl b) { return (vl){vsubq_s64(a.a, b.a), vsubq_s64(a.b, b.b)}; }
static inline vl vl_shl8(vl a) { return (vl){vshlq_n_s64(a.a, 8), vshlq_n_s64(a.b, 8)}; }

static inline int64x2_t vl_product_half(int64x2_t a, int64x2_t b)
{
    const uint64x2_t u = vreinterpretq_u64_s64(a);
    const uint32x2_t m = vmovn_u64(vreinterpretq_u64_s64(b));
    const uint64x2_t high = vmull_u32(vshrn_n_u64(u, 32), m);
    return vreinterpretq_s64_u64(vaddq_u64(vmull_u32(vmovn_u64(u), m), vshlq_n_u64(high, 32)));
}

// a * b for a and b from 0 to 2^32 - 1; the low 64 bits.
static inline vl vl_product(vl a, vl b) { return (vl){vl_product_half(a.a, b.a), vl_product_half(a.b, b.b)}; }
// The low 8 bits of *p, in every lane.
static inline vl vl_low8(const int32_t *p) { return vl_set1(*p & 255); }
static inline v4 v4_load(const float *p) { return vld1q_f32(p); }
static inline v4 v4_mul(v4 a, v4 b) { return vmulq_f32(a, b); }
static inline v4 v4_sub(v4 a, v4 b) { return vsubq_f32(a, b); }
static inline v4 v4_set1(float a) { return vdupq_n_f32(a); }

// a times scale, truncated to integers.
static inline vl vl_from(v4 a, const double scale[4])
{
    return (vl){vcvtq_s64_f64(vmulq_f64(vcvt_f64_f32(vget_low_f32(a)), vld1q_f64(scale))),
                vcvtq_s64_f64(vmulq_f64(vcvt_high_f64_f32(a), vld1q_f64(scale + 2)))};
}

// The sum of n vectors, each times its scale, as floats, from the last one on.
static inline v4 vl_scaled(const vl *a, int n, const double (*scale)[4])
{
    float64x2_t low = vdupq_n_f64(0), high = low;
    for (int i = n - 1; i >= 0; i--) {
        low = vaddq_f64(low, vmulq_f64(vcvtq_f64_s64(a[i].a), vld1q_f64(scale[i])));
        high = vaddq_f64(high, vmulq_f64(vcvtq_f64_s64(a[i].b), vld1q_f64(scale[i] + 2)));
    }
    return vcombine_f32(vcvt_f32_f64(low), vcvt_f32_f64(high));
}

#endif
