// SPDX-License-Identifier: BSD-3-Clause
// Vectors of four 64-bit integers in 256 bits, for AVX2 and AVX-512.
#ifndef HF_VEC_LONG_H
#define HF_VEC_LONG_H

#include <immintrin.h>
#include <stdint.h>

typedef __m256i vl;
typedef __m128 v4;
static inline void v4_store(float *p, v4 a)
{
    _mm_storeu_ps(p, a);
}
static inline void v4_transpose(v4 a[4])
{
    _MM_TRANSPOSE4_PS(a[0], a[1], a[2], a[3]);
}
static inline vl vl_load(const int64_t *p)
{
    return _mm256_loadu_si256((const __m256i *)p);
}
static inline void vl_store(int64_t *p, vl a)
{
    _mm256_storeu_si256((__m256i *)p, a);
}
static inline vl vl_set1(int64_t a)
{
    return _mm256_set1_epi64x(a);
}
static inline vl vl_add(vl a, vl b)
{
    return _mm256_add_epi64(a, b);
}
static inline vl vl_sub(vl a, vl b)
{
    return _mm256_sub_epi64(a, b);
}
static inline vl vl_shl8(vl a)
{
    return _mm256_slli_epi64(a, 8);
}
// a * b for a and b from 0 to 2^32 - 1; the low 64 bits.
static inline vl vl_product(vl a, vl b)
{
#if defined __AVX512DQ__ && defined __AVX512VL__
    return _mm256_mullo_epi64(a, b);
#else
    return _mm256_add_epi64(_mm256_mul_epu32(a, b),
                            _mm256_slli_epi64(_mm256_mul_epu32(_mm256_srli_epi64(a, 32), b), 32));
#endif
}
// The low 8 bits of *p, in every lane.
static inline vl vl_low8(const int32_t *p)
{
    return _mm256_and_si256(_mm256_set1_epi32(*p), _mm256_set1_epi64x(255));
}
static inline v4 v4_load(const float *p)
{
    return _mm_loadu_ps(p);
}
static inline v4 v4_mul(v4 a, v4 b)
{
    return _mm_mul_ps(a, b);
}
static inline v4 v4_sub(v4 a, v4 b)
{
    return _mm_sub_ps(a, b);
}
static inline v4 v4_set1(float a)
{
    return _mm_set1_ps(a);
}
// a times scale, truncated to integers.
static inline vl vl_from(v4 a, const double scale[4])
{
    const __m256d d = _mm256_mul_pd(_mm256_cvtps_pd(a), _mm256_loadu_pd(scale));
#if defined __AVX512DQ__ && defined __AVX512VL__
    return _mm256_cvttpd_epi64(d);
#else
    const __m128d low = _mm256_castpd256_pd128(d), high = _mm256_extractf128_pd(d, 1);
    return _mm256_set_epi64x(_mm_cvttsd_si64(_mm_unpackhi_pd(high, high)), _mm_cvttsd_si64(high),
                             _mm_cvttsd_si64(_mm_unpackhi_pd(low, low)), _mm_cvttsd_si64(low));
#endif
}

// The integer's upper part becomes a double through the exponent bits, and so do its lower 48 bits. Both are exact, so
// their sum rounds once, as a conversion does.
static inline __m256d vl_double(vl a)
{
    const __m256d magic = _mm256_set1_pd(442721857769029238784.0), all = _mm256_set1_pd(442726361368656609280.0);
    const vl upper = _mm256_blend_epi16(_mm256_srai_epi32(a, 16), _mm256_setzero_si256(), 0x33);
    const vl lower = _mm256_blend_epi16(a, _mm256_castpd_si256(_mm256_set1_pd(0x1p52)), 0x88);
    const __m256d d = _mm256_sub_pd(_mm256_castsi256_pd(_mm256_add_epi64(upper, _mm256_castpd_si256(magic))), all);
    return _mm256_add_pd(d, _mm256_castsi256_pd(lower));
}
// The sum of n vectors, each times its scale, as floats, from the last one on.
static inline v4 vl_scaled(const vl *a, int n, const double (*scale)[4])
{
    __m256d sum = _mm256_setzero_pd();
    for (int i = n - 1; i >= 0; i--)
        sum = _mm256_add_pd(sum, _mm256_mul_pd(vl_double(a[i]), _mm256_loadu_pd(scale[i])));
    return _mm256_cvtpd_ps(sum);
}

#endif
