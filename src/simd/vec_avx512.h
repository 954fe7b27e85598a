// SPDX-License-Identifier: BSD-3-Clause
// Vector operations of 16 floats: AVX-512 F, BW, DQ, VL.
#ifndef HF_VEC_AVX512_H
#define HF_VEC_AVX512_H

#include <immintrin.h>
#include <stdint.h>

#include "simd/vec_long.h"

typedef __m512 vf;
typedef __m512i vi;
typedef __mmask16 vm;
enum { VF_N = 16 };
#define VF_ALIGNED_ONLY 1  // an unaligned load crosses a cache line and costs two loads

static inline vf vf_load(const void *p) { return _mm512_loadu_ps(p); }
static inline void vf_store(void *p, vf a) { _mm512_storeu_ps(p, a); }
// Store past the caches; p is aligned to the vector. vf_stream_end must follow.
static inline void vf_stream(void *p, vf a) { _mm512_stream_ps((float *)p, a); }
static inline void vf_stream_end(void) { _mm_sfence(); }
static inline vf vf_set1(float a) { return _mm512_set1_ps(a); }
static inline vf vf_zero(void) { return _mm512_setzero_ps(); }
static inline vf vf_add(vf a, vf b) { return _mm512_add_ps(a, b); }
static inline vf vf_sub(vf a, vf b) { return _mm512_sub_ps(a, b); }
static inline vf vf_mul(vf a, vf b) { return _mm512_mul_ps(a, b); }
static inline vf vf_div(vf a, vf b) { return _mm512_div_ps(a, b); }
static inline vf vf_reciprocal(vf a) { return _mm512_rcp14_ps(a); }  // 14 bits
static inline vf vf_sqrt(vf a) { return _mm512_sqrt_ps(a); }
static inline vf vf_floor(vf a) { return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
static inline vf vf_abs(vf a) { return _mm512_abs_ps(a); }
// a > b ? a : b and a < b ? a : b, so b if either is NaN.
static inline vf vf_max(vf a, vf b) { return _mm512_max_ps(a, b); }
static inline vf vf_min(vf a, vf b) { return _mm512_min_ps(a, b); }
static inline vf vf_muladd_fused(vf a, vf b, vf c) { return _mm512_fmadd_ps(a, b, c); }
static inline vf vf_mulsub_fused(vf a, vf b, vf c) { return _mm512_fnmadd_ps(a, b, c); }

static inline vm vf_gt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ); }
static inline vm vf_lt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
static inline vm vf_le(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
static inline vm vf_eq(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_EQ_OQ); }
static inline vm vf_ne(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_NEQ_UQ); }  // true for NaN
static inline vm vf_unordered(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_UNORD_Q); }  // either is NaN
static inline vm vm_and(vm a, vm b) { return (vm)(a & b); }
static inline vm vm_or(vm a, vm b) { return (vm)(a | b); }
static inline vm vm_not(vm a) { return (vm)~a; }
static inline int vm_any(vm a) { return a != 0; }
static inline vf vf_select(vm m, vf a, vf b) { return _mm512_mask_blend_ps(m, b, a); }
static inline vf vf_keep(vm m, vf a) { return _mm512_maskz_mov_ps(m, a); }  // 0 where not
// Lanes of m get a + c or a * b + c, the others c.
static inline vf vf_add_where(vm m, vf a, vf c) { return _mm512_mask_add_ps(c, m, a, c); }
static inline vf vf_muladd_where_fused(vm m, vf a, vf b, vf c) { return _mm512_mask3_fmadd_ps(a, b, c, m); }
// Adds 1 to the lanes of m.
static inline vi vi_count(vi count, vm m) { return _mm512_mask_add_epi32(count, m, count, _mm512_set1_epi32(1)); }

static inline vi vi_load(const void *p) { return _mm512_loadu_si512(p); }
static inline void vi_store(void *p, vi a) { _mm512_storeu_si512(p, a); }
static inline vi vi_set1(int32_t a) { return _mm512_set1_epi32(a); }
static inline vi vi_add(vi a, vi b) { return _mm512_add_epi32(a, b); }
static inline vi vi_sub(vi a, vi b) { return _mm512_sub_epi32(a, b); }
static inline vi vi_and(vi a, vi b) { return _mm512_and_si512(a, b); }
static inline vi vi_or(vi a, vi b) { return _mm512_or_si512(a, b); }
static inline vi vi_xor(vi a, vi b) { return _mm512_xor_si512(a, b); }
static inline vi vi_or_and(vi a, vi b, vi c) { return _mm512_ternarylogic_epi32(a, b, c, 0xf8); }  // a | (b & c)
static inline vi vi_or_xor(vi a, vi b, vi c) { return _mm512_ternarylogic_epi32(a, b, c, 0xf6); }  // a | (b ^ c)
static inline vi vi_max(vi a, vi b) { return _mm512_max_epu32(a, b); }  // unsigned
static inline int vi_any(vi a) { return _mm512_test_epi32_mask(a, a) != 0; }
static inline vm vi_le(vi a, vi b) { return _mm512_cmple_epu32_mask(a, b); }
static inline vm vi_eq(vi a, vi b) { return _mm512_cmpeq_epi32_mask(a, b); }
#define vi_shl(a, n) _mm512_slli_epi32(a, n)
#define vi_shr(a, n) _mm512_srli_epi32(a, n)
static inline vi vf_as_vi(vf a) { return _mm512_castps_si512(a); }
static inline vf vi_as_vf(vi a) { return _mm512_castsi512_ps(a); }
static inline vi vf_to_vi(vf a) { return _mm512_cvttps_epi32(a); }
static inline vf vi_to_vf(vi a) { return _mm512_cvtepi32_ps(a); }

// As 64 bytes and as 32 words, unsigned.
static inline vi vi_max8(vi a, vi b) { return _mm512_max_epu8(a, b); }
static inline vi vi_max16(vi a, vi b) { return _mm512_max_epu16(a, b); }
static inline vi vi_set16(uint16_t a) { return _mm512_set1_epi16((short)a); }
static inline vi vi_add16(vi a, vi b) { return _mm512_add_epi16(a, b); }
static inline vi vi_sub16(vi a, vi b) { return _mm512_sub_epi16(a, b); }
static inline vi vi_mulhi16(vi a, vi b) { return _mm512_mulhi_epu16(a, b); }
#define vi_shl16(a, n) _mm512_slli_epi16(a, n)
#define vi_shr16(a, n) _mm512_srli_epi16(a, n)
// 64 bytes from byte n on of a followed by b; n < 64 must be a multiple of 4, or below 16.
#define vi_align(a, b, n)                                                                                            \
    ((n) % 4 == 0 ? _mm512_alignr_epi32(b, a, (n) / 4 & 15)                                                          \
                  : _mm512_alignr_epi8(_mm512_alignr_epi64(b, a, 2), a, (n) & 15))
// Load 16 bytes as numbers, and store them.
static inline vi vi_load_u8(const void *p) { return _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)p)); }
static inline void vi_store_u8(void *p, vi a) { _mm_storeu_si128((__m128i *)p, _mm512_cvtepi32_epi8(a)); }

// Split 32 numbers into even and odd ones, and join them: one two-source permute each.
static inline void vf_unzip(vf a, vf b, vf *even, vf *odd)
{
    const __m512i e = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    *even = _mm512_permutex2var_ps(a, e, b);
    *odd = _mm512_permutex2var_ps(a, _mm512_add_epi32(e, _mm512_set1_epi32(1)), b);
}

static inline void vf_zip(vf even, vf odd, vf *a, vf *b)
{
    const __m512i i = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    *a = _mm512_permutex2var_ps(even, i, odd);
    *b = _mm512_permutex2var_ps(even, _mm512_add_epi32(i, _mm512_set1_epi32(8)), odd);
}

// Load 16 numbers, four each from p, p + step, p + 2 step, p + 3 step.
static inline vf vf_load_lanes(const float *p, int step)
{
    __m512 v = _mm512_castps128_ps512(_mm_loadu_ps(p));
    v = _mm512_insertf32x4(v, _mm_loadu_ps(p + step), 1);
    v = _mm512_insertf32x4(v, _mm_loadu_ps(p + 2 * step), 2);
    return _mm512_insertf32x4(v, _mm_loadu_ps(p + 3 * step), 3);
}

static inline void vf_store_lanes(float *p, int step, vf a)
{
    _mm_storeu_ps(p, _mm512_castps512_ps128(a));
    _mm_storeu_ps(p + step, _mm512_extractf32x4_ps(a, 1));
    _mm_storeu_ps(p + 2 * step, _mm512_extractf32x4_ps(a, 2));
    _mm_storeu_ps(p + 3 * step, _mm512_extractf32x4_ps(a, 3));
}

// The first half of a vector from a, the second from b; and the two halves of v to a and b.
static inline vf vf_load_halves(const float *a, const float *b)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(a)), _mm256_loadu_ps(b), 1);
}

static inline void vf_store_halves(float *a, float *b, vf v)
{
    _mm256_storeu_ps(a, _mm512_castps512_ps256(v));
    _mm256_storeu_ps(b, _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(v), 1)));
}

// 16 numbers from number n on of a followed by b; 0 <= n < 16.
#define vf_align(a, b, n) _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(b), _mm512_castps_si512(a), n))

#define vf_shuffle(a, b, imm) _mm512_shuffle_ps(a, b, imm)

static inline vf vf_load_half(const void *p) { return _mm512_cvtph_ps(_mm256_loadu_si256((const __m256i *)p)); }
static inline void vf_store_half(void *p, vf a)
{
    _mm256_storeu_si256((__m256i *)p, _mm512_cvtps_ph(a, _MM_FROUND_TO_NEAREST_INT));
}

// Shift by one lane: the last lane of prev, then all lanes of cur except the last.
static inline vf vf_back(vf prev, vf cur)
{
    return _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(cur), _mm512_castps_si512(prev), 15));
}

// p[index] in each lane.
static inline vf vf_gather(const float *p, vi index) { return _mm512_i32gather_ps(index, p, 4); }

// Vectors of half as many doubles: conversion from floats and back, loads and stores.
typedef __m512d vd;
enum { VD_N = 8 };
static inline vd vd_load(const float *p) { return _mm512_cvtps_pd(_mm256_loadu_ps(p)); }
static inline void vd_store(float *p, vd a) { _mm256_storeu_ps(p, _mm512_cvtpd_ps(a)); }
static inline vd vd_sum(const double *p) { return _mm512_loadu_pd(p); }
static inline void vd_keep_sum(double *p, vd a) { _mm512_storeu_pd(p, a); }
static inline vd vd_set1(double a) { return _mm512_set1_pd(a); }
static inline vd vd_add(vd a, vd b) { return _mm512_add_pd(a, b); }
static inline vd vd_mul(vd a, vd b) { return _mm512_mul_pd(a, b); }

#endif
