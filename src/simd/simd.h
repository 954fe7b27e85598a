// SPDX-License-Identifier: BSD-3-Clause
// What the vector bodies share. This file and the *_simd.h bodies are compiled once per instruction set, over the
// vec_*.h that HF_VEC names. HF_FUSED says whether multiply-add may be fused. Loops run in steps of VF_N lanes and may
// compute and write past the end of a row: rows are padded by HF_PAD floats.
#ifndef HF_SIMD_H
#define HF_SIMD_H

#include <stddef.h>
#include <stdint.h>

#include "simd/choose.h"
#include HF_VEC

#define HF_INLINE static inline __attribute__((always_inline))

// Unrolls the loop behind it, which runs at most n times, a number that is known when this is compiled. gcc wants n. clang takes
// no notice of gcc's pragma, and left the gather's sums in memory: a disc took nine times as long.
#if defined __clang__
#define HF_UNROLL(n) _Pragma("clang loop unroll(full)")
#else
#define HF_PRAGMA(words) _Pragma(#words)
#define HF_UNROLL(n) HF_PRAGMA(GCC unroll n)
#endif

// a * b + c
HF_INLINE vf vf_fma(vf a, vf b, vf c)
{
#if HF_FUSED
    return vf_muladd_fused(a, b, c);
#else
    return vf_add(vf_mul(a, b), c);
#endif
}

// c - a * b
HF_INLINE vf vf_fnma(vf a, vf b, vf c)
{
#if HF_FUSED
    return vf_mulsub_fused(a, b, c);
#else
    return vf_sub(c, vf_mul(a, b));
#endif
}

// The vector from lane n on across consecutive vectors v[0], v[1] ...; n is a literal.
#define vf_shift(v, n) vf_align((v)[(n) / VF_N], (v)[(n) / VF_N + 1], (n) % VF_N)

// Marks a value that is used twice and must be loaded once. Otherwise gcc loads it from memory each time.
HF_INLINE vf vf_once(vf a)
{
#if defined __AVX512F__
    __asm__("" : "+v"(a));
#elif defined __AVX2__ || defined __SSE4_1__
    __asm__("" : "+x"(a));
#elif defined __aarch64__
    __asm__("" : "+w"(a));
#endif
    return a;
}

// A call with CHANNELS, which is 3 or 4, a constant, so that loops over channels are unrolled.
#define HF_WITH_CHANNELS(channels, call)                                                                               \
    do {                                                                                                               \
        if ((channels) == 3) {                                                                                         \
            enum { CHANNELS = 3 };                                                                                     \
            call;                                                                                                      \
        } else {                                                                                                       \
            enum { CHANNELS = 4 };                                                                                     \
            call;                                                                                                      \
        }                                                                                                              \
    } while (0)

// v clamped to 0..1; NaN becomes 0.
HF_INLINE vf vf_saturate(vf v)
{
    return vf_min(vf_max(v, vf_zero()), vf_set1(1));
}

// As hf_smoothstep().
HF_INLINE vf vf_smoothstep(vf t)
{
    return vf_mul(vf_mul(t, t), vf_sub(vf_set1(3), vf_mul(vf_set1(2), t)));
}

// v clamped to the range between a and b, in either order.
HF_INLINE vf vf_between(vf v, vf a, vf b)
{
    return vf_min(vf_max(v, vf_min(a, b)), vf_max(a, b));
}

// The sum of a count's lanes.
HF_INLINE uint32_t vi_sum(vi a)
{
    uint32_t lane[VF_N], sum = 0;
    vi_store(lane, a);
    for (int i = 0; i < VF_N; i++)
        sum += lane[i];
    return sum;
}

// The largest lane; none may be NaN.
HF_INLINE float vf_most(vf a)
{
    float lane[VF_N], most;
    vf_store(lane, a);
    most = lane[0];
    for (int i = 1; i < VF_N; i++)
        most = lane[i] > most ? lane[i] : most;
    return most;
}

// Store, or with stream store past the caches: then p is aligned, and vf_stream_end must follow.
HF_INLINE void vf_put(float *p, vf v, const int stream)
{
    if (stream)
        vf_stream(p, v);
    else
        vf_store(p, v);
}

// a + t (b - a), but exactly a's bits for t = 0.
HF_INLINE vf vf_lerp(vf a, vf b, vf t)
{
    const vm m = vf_ne(t, vf_zero());
#if HF_FUSED
    return vf_muladd_where_fused(m, t, vf_sub(b, a), a);
#else
    return vf_add_where(m, vf_mul(t, vf_sub(b, a)), a);
#endif
}

#endif
