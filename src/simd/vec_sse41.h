// SPDX-License-Identifier: BSD-3-Clause
// Vector operations of 4 floats: SSE4.1. It has no fused multiply-add and no half floats; both are emulated.
#ifndef HF_VEC_SSE41_H
#define HF_VEC_SSE41_H

#include <smmintrin.h>
#include <stdint.h>

typedef __m128 vf;
typedef __m128i vi;
typedef __m128 vm;  // lanes all ones or all zeros
enum { VF_N = 4 };
#define VF_SOFT_HALF 1  // vf_load_half and vf_store_half are those of pixel/format_vf.h

static inline vf vf_load(const void *p) { return _mm_loadu_ps((const float *)p); }
static inline void vf_store(void *p, vf a) { _mm_storeu_ps((float *)p, a); }
// Store past the caches; p is aligned to the vector. vf_stream_end must follow.
static inline void vf_stream(void *p, vf a) { _mm_stream_ps((float *)p, a); }
static inline void vf_stream_end(void) { _mm_sfence(); }
static inline vf vf_set1(float a) { return _mm_set1_ps(a); }
static inline vf vf_zero(void) { return _mm_setzero_ps(); }
static inline vf vf_add(vf a, vf b) { return _mm_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm_div_ps(a, b); }
static inline vf vf_reciprocal(vf a) { return _mm_rcp_ps(a); }  // about 12 bits
static inline vf vf_sqrt(vf a) { return _mm_sqrt_ps(a); }
static inline vf vf_floor(vf a) { return _mm_floor_ps(a); }
static inline vf vf_abs(vf a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
// a > b ? a : b and a < b ? a : b, so b if either is NaN.
static inline vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }
static inline vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
static inline vf vf_muladd_fused(vf a, vf b, vf c) { return _mm_add_ps(_mm_mul_ps(a, b), c); }
static inline vf vf_mulsub_fused(vf a, vf b, vf c) { return _mm_sub_ps(c, _mm_mul_ps(a, b)); }

static inline vm vf_gt(vf a, vf b) { return _mm_cmpgt_ps(a, b); }
static inline vm vf_lt(vf a, vf b) { return _mm_cmplt_ps(a, b); }
static inline vm vf_le(vf a, vf b) { return _mm_cmple_ps(a, b); }
static inline vm vf_eq(vf a, vf b) { return _mm_cmpeq_ps(a, b); }
static inline vm vf_ne(vf a, vf b) { return _mm_cmpneq_ps(a, b); }  // true for NaN
static inline vm vf_unordered(vf a, vf b) { return _mm_cmpunord_ps(a, b); }  // either is NaN
static inline vm vm_and(vm a, vm b) { return _mm_and_ps(a, b); }
static inline vm vm_or(vm a, vm b) { return _mm_or_ps(a, b); }
static inline vm vm_not(vm a) { return _mm_xor_ps(a, _mm_castsi128_ps(_mm_set1_epi32(-1))); }
static inline int vm_any(vm a) { return _mm_movemask_ps(a) != 0; }
static inline vf vf_select(vm m, vf a, vf b) { return _mm_blendv_ps(b, a, m); }
static inline vf vf_keep(vm m, vf a) { return _mm_and_ps(m, a); }  // 0 where not
// Lanes of m get a + c or a * b + c, the others c.
static inline vf vf_add_where(vm m, vf a, vf c) { return vf_select(m, vf_add(a, c), c); }
static inline vf vf_muladd_where_fused(vm m, vf a, vf b, vf c) { return vf_select(m, vf_muladd_fused(a, b, c), c); }
// Adds 1 to the lanes of m.
static inline vi vi_count(vi count, vm m) { return _mm_sub_epi32(count, _mm_castps_si128(m)); }

static inline vi vi_load(const void *p) { return _mm_loadu_si128((const __m128i *)p); }
static inline void vi_store(void *p, vi a) { _mm_storeu_si128((__m128i *)p, a); }
static inline vi vi_set1(int32_t a) { return _mm_set1_epi32(a); }
static inline vi vi_add(vi a, vi b) { return _mm_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm_sub_epi32(a, b); }
static inline vi vi_and(vi a, vi b) { return _mm_and_si128(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm_or_si128(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm_xor_si128(a, b); }
static inline vi vi_or_and(vi a, vi b, vi c) { return vi_or(a, vi_and(b, c)); }
static inline vi vi_or_xor(vi a, vi b, vi c) { return vi_or(a, vi_xor(b, c)); }
static inline vi vi_max(vi a, vi b) { return _mm_max_epu32(a, b); }  // unsigned
static inline vm vi_eq(vi a, vi b) { return _mm_castsi128_ps(_mm_cmpeq_epi32(a, b)); }
static inline int vi_any(vi a) { return !_mm_testz_si128(a, a); }
static inline vm vi_le(vi a, vi b) { return vi_eq(vi_max(a, b), b); }
#define vi_shl(a, n) _mm_slli_epi32(a, n)
#define vi_shr(a, n) _mm_srli_epi32(a, n)
static inline vi vf_as_vi(vf a) { return _mm_castps_si128(a); }
static inline vf vi_as_vf(vi a) { return _mm_castsi128_ps(a); }
static inline vi vf_to_vi(vf a) { return _mm_cvttps_epi32(a); }
static inline vf vi_to_vf(vi a) { return _mm_cvtepi32_ps(a); }

// As 16 bytes and as 8 words, unsigned.
static inline vi vi_max8(vi a, vi b) { return _mm_max_epu8(a, b); }
static inline vi vi_max16(vi a, vi b) { return _mm_max_epu16(a, b); }
static inline vi vi_set16(uint16_t a) { return _mm_set1_epi16((short)a); }
static inline vi vi_add16(vi a, vi b) { return _mm_add_epi16(a, b); }
static inline vi vi_sub16(vi a, vi b) { return _mm_sub_epi16(a, b); }
static inline vi vi_mulhi16(vi a, vi b) { return _mm_mulhi_epu16(a, b); }
#define vi_shl16(a, n) _mm_slli_epi16(a, n)
#define vi_shr16(a, n) _mm_srli_epi16(a, n)
// 16 bytes from byte n on of a followed by b; 0 <= n < 16.
#define vi_align(a, b, n) _mm_alignr_epi8(b, a, n)
// Load 4 bytes as numbers, and store them.
static inline vi vi_load_u8(const void *p)
{
    int32_t u;
    __builtin_memcpy(&u, p, 4);
    return _mm_cvtepu8_epi32(_mm_cvtsi32_si128(u));
}

static inline void vi_store_u8(void *p, vi a)
{
    const __m128i words = _mm_packus_epi32(a, a);
    const int32_t u = _mm_cvtsi128_si32(_mm_packus_epi16(words, words));
    __builtin_memcpy(p, &u, 4);
}

// Split 8 numbers into even and odd ones, and join them.
static inline void vf_unzip(vf a, vf b, vf *even, vf *odd)
{
    *even = _mm_shuffle_ps(a, b, 0x88);
    *odd = _mm_shuffle_ps(a, b, 0xdd);
}

static inline void vf_zip(vf even, vf odd, vf *a, vf *b)
{
    *a = _mm_unpacklo_ps(even, odd);
    *b = _mm_unpackhi_ps(even, odd);
}

static inline vf vf_load_lanes(const float *p, int step)
{
    (void)step;
    return _mm_loadu_ps(p);
}

static inline void vf_store_lanes(float *p, int step, vf a)
{
    (void)step;
    _mm_storeu_ps(p, a);
}

// The first half of a vector from a, the second from b; and the two halves of v to a and b.
static inline vf vf_load_halves(const float *a, const float *b)
{
    return _mm_castsi128_ps(_mm_unpacklo_epi64(_mm_loadl_epi64((const __m128i *)a), _mm_loadl_epi64((const __m128i *)b)));
}

static inline void vf_store_halves(float *a, float *b, vf v)
{
    _mm_storel_pi((__m64 *)a, v);
    _mm_storeh_pi((__m64 *)b, v);
}

// 4 numbers from number n on of a followed by b; 0 <= n < 4.
#define vf_align(a, b, n) vi_as_vf(vi_align(vf_as_vi(a), vf_as_vi(b), 4 * (n)))

#define vf_shuffle(a, b, imm) _mm_shuffle_ps(a, b, imm)

// 4 halves as the low 16 bits of 4 words, and back.
static inline vi vi_load_u16(const void *p) { return _mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)p)); }
static inline void vi_store_u16(void *p, vi a) { _mm_storel_epi64((__m128i *)p, _mm_packus_epi32(a, a)); }

// Shift by one lane: the last lane of prev, then all lanes of cur except the last.
static inline vf vf_back(vf prev, vf cur)
{
    return _mm_castsi128_ps(_mm_alignr_epi8(_mm_castps_si128(cur), _mm_castps_si128(prev), 12));
}

// p[index] in each lane.
static inline vf vf_gather(const float *p, vi index)
{
    int32_t i[4];
    _mm_storeu_si128((__m128i *)i, index);
    return _mm_setr_ps(p[i[0]], p[i[1]], p[i[2]], p[i[3]]);
}

// Vectors of half as many doubles: conversion from floats and back, loads and stores.
typedef __m128d vd;
enum { VD_N = 2 };
static inline vd vd_load(const float *p)
{
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64((const __m128i *)(const void *)p)));
}

static inline void vd_store(float *p, vd a)
{
    _mm_storel_epi64((__m128i *)(void *)p, _mm_castps_si128(_mm_cvtpd_ps(a)));
}

static inline vd vd_sum(const double *p) { return _mm_loadu_pd(p); }
static inline void vd_keep_sum(double *p, vd a) { _mm_storeu_pd(p, a); }
static inline vd vd_set1(double a) { return _mm_set1_pd(a); }
static inline vd vd_add(vd a, vd b) { return _mm_add_pd(a, b); }
static inline vd vd_mul(vd a, vd b) { return _mm_mul_pd(a, b); }

// Four 64-bit integers, and four floats, whatever the vector size.
typedef struct { __m128i a, b; } vl;
typedef __m128 v4;
static inline void v4_store(float *p, v4 a) { _mm_storeu_ps(p, a); }
static inline void v4_transpose(v4 a[4]) { _MM_TRANSPOSE4_PS(a[0], a[1], a[2], a[3]); }
static inline vl vl_load(const int64_t *p)
{
    return (vl){_mm_loadu_si128((const __m128i *)p), _mm_loadu_si128((const __m128i *)p + 1)};
}

static inline void vl_store(int64_t *p, vl a)
{
    _mm_storeu_si128((__m128i *)p, a.a);
    _mm_storeu_si128((__m128i *)p + 1, a.b);
}

static inline vl vl_set1(int64_t a) { return (vl){_mm_set1_epi64x(a), _mm_set1_epi64x(a)}; }
static inline vl vl_add(vl a, vl b) { return (vl){_mm_add_epi64(a.a, b.a), _mm_add_epi64(a.b, b.b)}; }
static inline vl vl_sub(vl a, vl b) { return (vl){_mm_sub_epi64(a.a, b.a), _mm_sub_epi64(a.b, b.b)}; }
static inline vl vl_shl8(vl a) { return (vl){_mm_slli_epi64(a.a, 8), _mm_slli_epi64(a.b, 8)}; }

static inline __m128i vl_product_half(__m128i a, __m128i m)
{
    return _mm_add_epi64(_mm_mul_epu32(a, m), _mm_slli_epi64(_mm_mul_epu32(_mm_srli_epi64(a, 32), m), 32));
}

// a * b for a and b from 0 to 2^32 - 1; the low 64 bits.
static inline vl vl_product(vl a, vl b) { return (vl){vl_product_half(a.a, b.a), vl_product_half(a.b, b.b)}; }
// The low 8 bits of *p, in every lane.
static inline vl vl_low8(const int32_t *p) { return vl_set1(*p & 255); }
static inline v4 v4_load(const float *p) { return _mm_loadu_ps(p); }
static inline v4 v4_mul(v4 a, v4 b) { return _mm_mul_ps(a, b); }
static inline v4 v4_sub(v4 a, v4 b) { return _mm_sub_ps(a, b); }
static inline v4 v4_set1(float a) { return _mm_set1_ps(a); }

static inline __m128i vl_from_half(__m128d d)
{
    return _mm_set_epi64x(_mm_cvttsd_si64(_mm_unpackhi_pd(d, d)), _mm_cvttsd_si64(d));
}

// a times scale, truncated to integers.
static inline vl vl_from(v4 a, const double scale[4])
{
    return (vl){vl_from_half(_mm_mul_pd(_mm_cvtps_pd(a), _mm_loadu_pd(scale))),
                vl_from_half(_mm_mul_pd(_mm_cvtps_pd(_mm_movehl_ps(a, a)), _mm_loadu_pd(scale + 2)))};
}

// The integer's upper part becomes a double through the exponent bits, and so do its lower 48 bits. Both are exact, so
// their sum rounds once, as a conversion does.
static inline __m128d vl_scaled_half(__m128i a, __m128d scale)
{
    const __m128d magic = _mm_set1_pd(442721857769029238784.0), all = _mm_set1_pd(442726361368656609280.0);
    const __m128i upper = _mm_blend_epi16(_mm_srai_epi32(a, 16), _mm_setzero_si128(), 0x33);
    const __m128i lower = _mm_blend_epi16(a, _mm_castpd_si128(_mm_set1_pd(0x1p52)), 0x88);
    const __m128d d = _mm_sub_pd(_mm_castsi128_pd(_mm_add_epi64(upper, _mm_castpd_si128(magic))), all);
    return _mm_mul_pd(_mm_add_pd(d, _mm_castsi128_pd(lower)), scale);
}

// The sum of n vectors, each times its scale, as floats, from the last one on.
static inline v4 vl_scaled(const vl *a, int n, const double (*scale)[4])
{
    __m128d low = _mm_setzero_pd(), high = low;
    for (int i = n - 1; i >= 0; i--) {
        low = _mm_add_pd(low, vl_scaled_half(a[i].a, _mm_loadu_pd(scale[i])));
        high = _mm_add_pd(high, vl_scaled_half(a[i].b, _mm_loadu_pd(scale[i] + 2)));
    }
    return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
}

#endif
