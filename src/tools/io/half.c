// SPDX-License-Identifier: BSD-3-Clause
// Rows of halves. The C is the specification; on x86 the processor's own conversion gives the same numbers.
#include "tools/io/half.h"

#include <string.h>

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#include <stdatomic.h>

#define HALF_TARGET __attribute__((target("avx,f16c,avx2")))

// Returns how many of the n were converted: a multiple of 8.
HALF_TARGET static size_t to_floats_x86(float *to, const uint8_t *from, size_t n)
{
    size_t i = 0;
    for (; i + 8 <= n; i += 8)
        _mm256_storeu_ps(to + i, _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(from + 2 * i))));
    return i;
}

HALF_TARGET static size_t to_halves_x86(uint8_t *to, const float *from, size_t n, uint64_t *clamped)
{
    const __m256 max = _mm256_set1_ps(HF_HALF_MAX), min = _mm256_set1_ps(-HF_HALF_MAX);
    uint64_t outside = 0;
    size_t i = 0;
    for (; i + 8 <= n; i += 8) {
        __m256 v = _mm256_loadu_ps(from + i);
        v = _mm256_and_ps(v, _mm256_cmp_ps(v, v, _CMP_ORD_Q));  // NaN becomes 0
        const __m256 out = _mm256_or_ps(_mm256_cmp_ps(v, max, _CMP_GT_OQ), _mm256_cmp_ps(v, min, _CMP_LT_OQ));
        outside += (uint64_t)__builtin_popcount((unsigned)_mm256_movemask_ps(out));
        v = _mm256_min_ps(_mm256_max_ps(v, min), max);
        _mm_storeu_si128((__m128i *)(to + 2 * i), _mm256_cvtps_ph(v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
    }
    *clamped += outside;
    return i;
}

// Asked only once: under a hypervisor cpuid leaves the guest and takes longer than converting a row.
static int has_f16c(void)
{
    static atomic_int known;  // 0: not asked yet, 1: no, 2: yes
    int answer = atomic_load_explicit(&known, memory_order_relaxed);
    if (!answer) {
        unsigned a, b, c = 0, d;  // clang 14 knows no name for F16C
        answer = __builtin_cpu_supports("avx2") && __get_cpuid(1, &a, &b, &c, &d) && (c & bit_F16C) ? 2 : 1;
        atomic_store_explicit(&known, answer, memory_order_relaxed);
    }
    return answer == 2;
}
#else
static size_t to_floats_x86(float *to, const uint8_t *from, size_t n)
{
    (void)to, (void)from, (void)n;
    return 0;
}

static size_t to_halves_x86(uint8_t *to, const float *from, size_t n, uint64_t *clamped)
{
    (void)to, (void)from, (void)n, (void)clamped;
    return 0;
}

static int has_f16c(void)
{
    return 0;
}
#endif

void hf_io_halves_to_floats(float *to, const uint8_t *from, size_t n)
{
    for (size_t i = has_f16c() ? to_floats_x86(to, from, n) : 0; i < n; i++) {
        uint16_t h;
        memcpy(&h, from + 2 * i, sizeof(h));
        to[i] = hf_io_from_half(h);
    }
}

void hf_io_floats_to_halves(uint8_t *to, const float *from, size_t n, uint64_t *clamped)
{
    for (size_t i = has_f16c() ? to_halves_x86(to, from, n, clamped) : 0; i < n; i++) {
        const uint16_t h = hf_io_to_half(from[i], clamped);
        memcpy(to + 2 * i, &h, sizeof(h));
    }
}
