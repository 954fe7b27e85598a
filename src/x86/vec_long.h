// SPDX-License-Identifier: BSD-3-Clause
// Four 64-bit integers in 256 bits, for AVX2 and AVX-512 alike.
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
// a * b for any a, low 64 bits.
static inline vl vl_times(vl a, uint32_t b)
{
    const vl m = _mm256_set1_epi64x(b);
    return _mm256_add_epi64(_mm256_mul_epu32(a, m),
                            _mm256_slli_epi64(_mm256_mul_epu32(_mm256_srli_epi64(a, 32), m), 32));
}

// As floats, each times its scale. The integer's upper part, made a double by its exponent's bits, and its lower 48 bits
// are both exact: one rounding, as that of a conversion.
static inline v4 vl_scaled(vl a, const double scale[4])
{
    const __m256d magic = _mm256_set1_pd(442721857769029238784.0), all = _mm256_set1_pd(442726361368656609280.0);
    const vl upper = _mm256_blend_epi16(_mm256_srai_epi32(a, 16), _mm256_setzero_si256(), 0x33);
    const vl lower = _mm256_blend_epi16(a, _mm256_castpd_si256(_mm256_set1_pd(0x1p52)), 0x88);
    const __m256d d = _mm256_sub_pd(_mm256_castsi256_pd(_mm256_add_epi64(upper, _mm256_castpd_si256(magic))), all);
    const __m256d v = _mm256_add_pd(d, _mm256_castsi256_pd(lower));
    return _mm256_cvtpd_ps(_mm256_mul_pd(v, _mm256_loadu_pd(scale)));
}

#endif
