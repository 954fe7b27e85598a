// SPDX-License-Identifier: BSD-3-Clause
// Vector operations of 8 floats: AVX2, FMA, F16C.
#ifndef HF_VEC_AVX2_H
#define HF_VEC_AVX2_H

#include <immintrin.h>
#include <stdint.h>

#include "simd/vec_long.h"

typedef __m256 vf;
typedef __m256i vi;
typedef __m256 vm;  // lanes all ones or all zeros
enum { VF_N = 8 };

static inline vf vf_load(const void *p) { return _mm256_loadu_ps((const float *)p); }
static inline void vf_store(void *p, vf a) { _mm256_storeu_ps((float *)p, a); }
// Store past the caches; p is aligned to the vector. vf_stream_end must follow.
static inline void vf_stream(void *p, vf a) { _mm256_stream_ps((float *)p, a); }
static inline void vf_stream_end(void) { _mm_sfence(); }
static inline vf vf_set1(float a) { return _mm256_set1_ps(a); }
static inline vf vf_zero(void) { return _mm256_setzero_ps(); }
static inline vf vf_add(vf a, vf b) { return _mm256_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm256_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm256_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm256_div_ps(a, b); }
static inline vf vf_reciprocal(vf a) { return _mm256_rcp_ps(a); }  // about 12 bits
static inline vf vf_sqrt(vf a) { return _mm256_sqrt_ps(a); }
static inline vf vf_floor(vf a) { return _mm256_floor_ps(a); }
static inline vf vf_abs(vf a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
// a > b ? a : b and a < b ? a : b, so b if either is NaN.
static inline vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
static inline vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
static inline vf vf_muladd_fused(vf a, vf b, vf c) { return _mm256_fmadd_ps(a, b, c); }
static inline vf vf_mulsub_fused(vf a, vf b, vf c) { return _mm256_fnmadd_ps(a, b, c); }

static inline vm vf_gt(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
static inline vm vf_lt(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
static inline vm vf_le(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
static inline vm vf_eq(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_EQ_OQ); }
static inline vm vf_ne(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_NEQ_UQ); }  // true for NaN
static inline vm vf_unordered(vf a, vf b) { return _mm256_cmp_ps(a, b, _CMP_UNORD_Q); }  // either is NaN
static inline vm vm_and(vm a, vm b) { return _mm256_and_ps(a, b); }
static inline vm vm_or(vm a, vm b) { return _mm256_or_ps(a, b); }
static inline vm vm_not(vm a) { return _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1))); }
static inline int vm_any(vm a) { return _mm256_movemask_ps(a) != 0; }
static inline vf vf_select(vm m, vf a, vf b) { return _mm256_blendv_ps(b, a, m); }
static inline vf vf_keep(vm m, vf a) { return _mm256_and_ps(m, a); }  // 0 where not
// Lanes of m get a + c or a * b + c, the others c.
static inline vf vf_add_where(vm m, vf a, vf c) { return vf_select(m, vf_add(a, c), c); }
static inline vf vf_muladd_where_fused(vm m, vf a, vf b, vf c) { return vf_select(m, vf_muladd_fused(a, b, c), c); }
// Adds 1 to the lanes of m.
static inline vi vi_count(vi count, vm m) { return _mm256_sub_epi32(count, _mm256_castps_si256(m)); }

static inline vi vi_load(const void *p) { return _mm256_loadu_si256((const __m256i *)p); }
static inline void vi_store(void *p, vi a) { _mm256_storeu_si256((__m256i *)p, a); }
static inline vi vi_set1(int32_t a) { return _mm256_set1_epi32(a); }
static inline vi vi_add(vi a, vi b) { return _mm256_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm256_sub_epi32(a, b); }
static inline vi vi_and(vi a, vi b) { return _mm256_and_si256(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm256_or_si256(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm256_xor_si256(a, b); }
static inline vi vi_or_and(vi a, vi b, vi c) { return vi_or(a, vi_and(b, c)); }
static inline vi vi_or_xor(vi a, vi b, vi c) { return vi_or(a, vi_xor(b, c)); }
static inline vi vi_max(vi a, vi b) { return _mm256_max_epu32(a, b); }  // unsigned
static inline vm vi_eq(vi a, vi b) { return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)); }
static inline int vi_any(vi a) { return !_mm256_testz_si256(a, a); }
static inline vm vi_le(vi a, vi b) { return vi_eq(vi_max(a, b), b); }
#define vi_shl(a, n) _mm256_slli_epi32(a, n)
#define vi_shr(a, n) _mm256_srli_epi32(a, n)
static inline vi vf_as_vi(vf a) { return _mm256_castps_si256(a); }
static inline vf vi_as_vf(vi a) { return _mm256_castsi256_ps(a); }
static inline vi vf_to_vi(vf a) { return _mm256_cvttps_epi32(a); }
static inline vf vi_to_vf(vi a) { return _mm256_cvtepi32_ps(a); }

// As 32 bytes and as 16 words, unsigned.
static inline vi vi_max8(vi a, vi b) { return _mm256_max_epu8(a, b); }
static inline vi vi_max16(vi a, vi b) { return _mm256_max_epu16(a, b); }
static inline vi vi_set16(uint16_t a) { return _mm256_set1_epi16((short)a); }
static inline vi vi_add16(vi a, vi b) { return _mm256_add_epi16(a, b); }
static inline vi vi_sub16(vi a, vi b) { return _mm256_sub_epi16(a, b); }
static inline vi vi_mulhi16(vi a, vi b) { return _mm256_mulhi_epu16(a, b); }
#define vi_shl16(a, n) _mm256_slli_epi16(a, n)
#define vi_shr16(a, n) _mm256_srli_epi16(a, n)
// 32 bytes from byte n on of a followed by b; 0 <= n < 32.
#define vi_middle(a, b) _mm256_permute2x128_si256(a, b, 0x21)
#define vi_align(a, b, n)                                                                                            \
    ((n) == 0    ? (a)                                                                                               \
     : (n) < 16  ? _mm256_alignr_epi8(vi_middle(a, b), a, (n) & 15)                                                  \
     : (n) == 16 ? vi_middle(a, b)                                                                                   \
                 : _mm256_alignr_epi8(b, vi_middle(a, b), (n) & 15))
// Load 8 bytes as numbers, and store them.
static inline vi vi_load_u8(const void *p) { return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)p)); }
static inline void vi_store_u8(void *p, vi a)
{
    const __m128i words = _mm_packus_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
    _mm_storel_epi64((__m128i *)p, _mm_packus_epi16(words, words));
}

// Split 16 numbers into even and odd ones, and join them.
static inline void vf_unzip(vf a, vf b, vf *even, vf *odd)
{
    const __m256 e = _mm256_shuffle_ps(a, b, 0x88), o = _mm256_shuffle_ps(a, b, 0xdd);
    *even = _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(e), 0xd8));
    *odd = _mm256_castpd_ps(_mm256_permute4x64_pd(_mm256_castps_pd(o), 0xd8));
}

static inline void vf_zip(vf even, vf odd, vf *a, vf *b)
{
    const __m256 lo = _mm256_unpacklo_ps(even, odd), hi = _mm256_unpackhi_ps(even, odd);
    *a = _mm256_permute2f128_ps(lo, hi, 0x20);
    *b = _mm256_permute2f128_ps(lo, hi, 0x31);
}

// Load 8 numbers, four each from p and p + step.
static inline vf vf_load_lanes(const float *p, int step)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p)), _mm_loadu_ps(p + step), 1);
}

static inline void vf_store_lanes(float *p, int step, vf a)
{
    _mm_storeu_ps(p, _mm256_castps256_ps128(a));
    _mm_storeu_ps(p + step, _mm256_extractf128_ps(a, 1));
}

// The first half of a vector from a, the second from b; and the two halves of v to a and b.
static inline vf vf_load_halves(const float *a, const float *b)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1);
}

static inline void vf_store_halves(float *a, float *b, vf v)
{
    _mm_storeu_ps(a, _mm256_castps256_ps128(v));
    _mm_storeu_ps(b, _mm256_extractf128_ps(v, 1));
}

// 8 numbers from number n on of a followed by b; 0 <= n < 8.
#define vf_align(a, b, n) vi_as_vf(vi_align(vf_as_vi(a), vf_as_vi(b), 4 * (n)))

#define vf_shuffle(a, b, imm) _mm256_shuffle_ps(a, b, imm)

static inline vf vf_load_half(const void *p) { return _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)p)); }
static inline void vf_store_half(void *p, vf a)
{
    _mm_storeu_si128((__m128i *)p, _mm256_cvtps_ph(a, _MM_FROUND_TO_NEAREST_INT));
}

// Shift by one lane: the last lane of prev, then all lanes of cur except the last.
static inline vf vf_back(vf prev, vf cur)
{
    const __m256i middle = _mm256_castps_si256(_mm256_permute2f128_ps(prev, cur, 0x21));
    return _mm256_castsi256_ps(_mm256_alignr_epi8(_mm256_castps_si256(cur), middle, 12));
}

// p[index] in each lane.
static inline vf vf_gather(const float *p, vi index) { return _mm256_i32gather_ps(p, index, 4); }

// Vectors of half as many doubles: conversion from floats and back, loads and stores.
typedef __m256d vd;
enum { VD_N = 4 };
static inline vd vd_load(const float *p) { return _mm256_cvtps_pd(_mm_loadu_ps(p)); }
static inline void vd_store(float *p, vd a) { _mm_storeu_ps(p, _mm256_cvtpd_ps(a)); }
static inline vd vd_sum(const double *p) { return _mm256_loadu_pd(p); }
static inline void vd_keep_sum(double *p, vd a) { _mm256_storeu_pd(p, a); }
static inline vd vd_set1(double a) { return _mm256_set1_pd(a); }
static inline vd vd_add(vd a, vd b) { return _mm256_add_pd(a, b); }
static inline vd vd_mul(vd a, vd b) { return _mm256_mul_pd(a, b); }

#endif
