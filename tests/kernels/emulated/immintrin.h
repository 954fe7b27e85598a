// SPDX-License-Identifier: BSD-3-Clause
// Stands in for the compiler's <immintrin.h> where src/simd/vec_avx512.h is compiled for a CPU without AVX-512: SIMDe does
// each intrinsic in plain C. Only intrinsics, none of the kernels, are written over here: what SIMDe 0.7.4 does not
// have, and what it does with other bits than the instruction.
#ifndef HF_EMULATED_IMMINTRIN_H
#define HF_EMULATED_IMMINTRIN_H

#define SIMDE_ENABLE_NATIVE_ALIASES
#define SIMDE_NO_NATIVE  // plain C: the semantics are those written down in SIMDe, not those of the CPU at hand
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#include <simde/x86/avx512.h>
#pragma GCC diagnostic pop

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef __mmask16
#define __mmask16 simde__mmask16
#endif
#ifndef _MM_FROUND_NO_EXC
#define _MM_FROUND_NO_EXC SIMDE_MM_FROUND_NO_EXC
#endif

// a * b + c rounded once; SIMDe rounds twice.
static inline __m512 emulated_fmadd(__m512 a, __m512 b, __m512 c)
{
    float x[16], y[16], z[16];
    memcpy(x, &a, sizeof x);
    memcpy(y, &b, sizeof y);
    memcpy(z, &c, sizeof z);
    for (int i = 0; i < 16; i++)
        z[i] = fmaf(x[i], y[i], z[i]);
    memcpy(&c, z, sizeof z);
    return c;
}

// 1 / a with a relative error below 2^-14, as the instruction promises; its bits are not those of the instruction.
static inline __m512 emulated_rcp14(__m512 a)
{
    float x[16];
    uint32_t u[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++) {
        x[i] = 1 / x[i];
        memcpy(&u[i], &x[i], sizeof u[i]);
        u[i] &= ~0x1ffu;
    }
    memcpy(&a, u, sizeof u);
    return a;
}

// Towards zero; what no int32 holds becomes the smallest one.
static inline __m512i emulated_cvttps(__m512 a)
{
    float x[16];
    int32_t r[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        r[i] = x[i] >= -0x1p31f && x[i] < 0x1p31f ? (int32_t)x[i] : INT32_MIN;
    __m512i v;
    memcpy(&v, r, sizeof r);
    return v;
}

static inline __m512 emulated_cvtepi32(__m512i a)
{
    int32_t x[16];
    float r[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        r[i] = (float)x[i];
    __m512 v;
    memcpy(&v, r, sizeof r);
    return v;
}

// Denormal halves are exact in float; a NaN keeps sign and payload and becomes quiet.
static inline float emulated_from_half(uint16_t h)
{
    const int exponent = h >> 10 & 31, mantissa = h & 0x3ff;
    uint32_t u = 0x7f800000 | (uint32_t)mantissa << 13 | (mantissa ? 0x400000 : 0);
    if (exponent < 31) {
        const float v = exponent ? ldexpf((float)(1024 + mantissa), exponent - 25) : ldexpf((float)mantissa, -24);
        memcpy(&u, &v, 4);
    }
    u |= (uint32_t)(h & 0x8000) << 16;
    float v;
    memcpy(&v, &u, 4);
    return v;
}

// To nearest even; beyond 65520 infinite.
static inline uint16_t emulated_to_half(float v)
{
    uint32_t u;
    memcpy(&u, &v, 4);
    const uint32_t sign = u >> 16 & 0x8000, magnitude = u & 0x7fffffff;
    if (magnitude > 0x7f800000)
        return (uint16_t)(sign | 0x7e00 | (magnitude >> 13 & 0x1ff));
    if (fabsf(v) >= 65520)
        return (uint16_t)(sign | 0x7c00);
    if (fabsf(v) < 0x1p-14f)  // steps of 2^-24; 1024 of them are the smallest normal half
        return (uint16_t)(sign | (uint32_t)rintf(fabsf(v) * 0x1p24f));
    // The mantissa rounded to 10 bits; its carry belongs into the exponent.
    const uint32_t step = rintf(ldexpf((float)(magnitude & 0x7fffff), -13));
    return (uint16_t)(sign | (((magnitude >> 23) - 112) * 1024 + step));
}

static inline __m512 emulated_cvtph(__m256i a)
{
    uint16_t h[16];
    float r[16];
    memcpy(h, &a, sizeof h);
    for (int i = 0; i < 16; i++)
        r[i] = emulated_from_half(h[i]);
    __m512 v;
    memcpy(&v, r, sizeof r);
    return v;
}

static inline __m256i emulated_cvtps(__m512 a)
{
    float x[16];
    uint16_t h[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        h[i] = emulated_to_half(x[i]);
    __m256i v;
    memcpy(&v, h, sizeof h);
    return v;
}

// The only rounding asked of it: down.
static inline __m512 emulated_floor(__m512 a)
{
    float x[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        x[i] = floorf(x[i]);
    memcpy(&a, x, sizeof x);
    return a;
}

// SIMDe leaves -0 as it is.
static inline __m512 emulated_abs(__m512 a)
{
    float x[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        x[i] = fabsf(x[i]);
    memcpy(&a, x, sizeof x);
    return a;
}

static inline __m512 emulated_gather(__m512i index, const float *p)
{
    int32_t i[16];
    float r[16];
    memcpy(i, &index, sizeof i);
    for (int k = 0; k < 16; k++)
        r[k] = p[i[k]];
    __m512 v;
    memcpy(&v, r, sizeof r);
    return v;
}

static inline __m512i emulated_alignr(__m512i a, __m512i b, int n)
{
    int32_t x[32];
    memcpy(x, &b, sizeof b);
    memcpy(x + 16, &a, sizeof a);
    memcpy(&a, x + n, sizeof a);
    return a;
}

// Of each 128 bits.
static inline __m512i emulated_alignr8(__m512i a, __m512i b, int n)
{
    uint8_t x[64], y[64], lanes[32];
    memcpy(x, &a, sizeof x);
    memcpy(y, &b, sizeof y);
    for (int i = 0; i < 64; i += 16) {
        memcpy(lanes, y + i, 16);
        memcpy(lanes + 16, x + i, 16);
        memcpy(x + i, lanes + n, 16);
    }
    memcpy(&a, x, sizeof a);
    return a;
}

static inline __m512i emulated_mulhi(__m512i a, __m512i b)
{
    uint16_t x[32], y[32];
    memcpy(x, &a, sizeof x);
    memcpy(y, &b, sizeof y);
    for (int i = 0; i < 32; i++)
        x[i] = (uint16_t)((uint32_t)x[i] * y[i] >> 16);
    memcpy(&a, x, sizeof a);
    return a;
}

static inline __m512i emulated_widen(__m128i a)
{
    uint8_t x[16];
    uint32_t r[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        r[i] = x[i];
    __m512i v;
    memcpy(&v, r, sizeof v);
    return v;
}

static inline __m128i emulated_narrow(__m512i a)
{
    uint32_t x[16];
    uint8_t r[16];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 16; i++)
        r[i] = (uint8_t)x[i];
    __m128i v;
    memcpy(&v, r, sizeof v);
    return v;
}

static inline __m512d emulated_to_double(__m256 a)
{
    float x[8];
    double r[8];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 8; i++)
        r[i] = x[i];
    __m512d v;
    memcpy(&v, r, sizeof r);
    return v;
}

static inline __m256 emulated_to_float(__m512d a)
{
    double x[8];
    float r[8];
    memcpy(x, &a, sizeof x);
    for (int i = 0; i < 8; i++)
        r[i] = (float)x[i];
    __m256 v;
    memcpy(&v, r, sizeof r);
    return v;
}

#undef _mm512_cvtps_pd
#define _mm512_cvtps_pd(a) emulated_to_double(a)
#undef _mm512_cvtpd_ps
#define _mm512_cvtpd_ps(a) emulated_to_float(a)
#undef _mm512_fmadd_ps
#define _mm512_fmadd_ps(a, b, c) emulated_fmadd(a, b, c)
#undef _mm512_stream_ps
#define _mm512_stream_ps(p, a) _mm512_storeu_ps(p, a)
#undef _mm512_alignr_epi32
#define _mm512_alignr_epi32(a, b, n) emulated_alignr(a, b, n)
#undef _mm512_alignr_epi64
#define _mm512_alignr_epi64(a, b, n) emulated_alignr(a, b, 2 * (n))
#undef _mm512_alignr_epi8
#define _mm512_alignr_epi8(a, b, n) emulated_alignr8(a, b, n)
#undef _mm512_mulhi_epu16
#define _mm512_mulhi_epu16(a, b) emulated_mulhi(a, b)
#undef _mm512_cvtepu8_epi32
#define _mm512_cvtepu8_epi32(a) emulated_widen(a)
#undef _mm512_cvtepi32_epi8
#define _mm512_cvtepi32_epi8(a) emulated_narrow(a)
#undef _mm512_mask3_fmadd_ps
#define _mm512_mask3_fmadd_ps(a, b, c, m) _mm512_mask_mov_ps(c, m, emulated_fmadd(a, b, c))
#undef _mm512_abs_ps
#define _mm512_abs_ps(a) emulated_abs(a)
#undef _mm512_rcp14_ps
#define _mm512_rcp14_ps(a) emulated_rcp14(a)
#undef _mm512_roundscale_ps
#define _mm512_roundscale_ps(a, rounding) emulated_floor(a)
#undef _mm512_cvttps_epi32
#define _mm512_cvttps_epi32(a) emulated_cvttps(a)
#undef _mm512_cvtepi32_ps
#define _mm512_cvtepi32_ps(a) emulated_cvtepi32(a)
#undef _mm512_cvtph_ps
#define _mm512_cvtph_ps(a) emulated_cvtph(a)
#undef _mm512_cvtps_ph  // the only rounding used is to nearest even
#define _mm512_cvtps_ph(a, rounding) emulated_cvtps(a)
#undef _mm512_i32gather_ps
#define _mm512_i32gather_ps(index, p, scale) emulated_gather(index, p)

#endif
