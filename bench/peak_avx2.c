// SPDX-License-Identifier: BSD-3-Clause
#include "peak.h"

#include <immintrin.h>

// Two pipes with a latency of 4 or 5 need 8 or 10 chains. 12 chains and two constants fit the 16 registers.
enum { CHAINS = 12, LANES = 8 };

static float run(long n)
{
    const __m256 factor = _mm256_set1_ps(BENCH_PEAK_FACTOR), term = _mm256_set1_ps(BENCH_PEAK_TERM);
    __m256 x[CHAINS];
    for (int i = 0; i < CHAINS; i++)
        x[i] = _mm256_set1_ps(1 + (float)i);
    for (; n > 0; n--) {
#pragma GCC unroll 16
        for (int i = 0; i < CHAINS; i++)
            x[i] = _mm256_fmadd_ps(x[i], factor, term);
    }
    __m256 sum = x[0];
    for (int i = 1; i < CHAINS; i++)
        sum = _mm256_add_ps(sum, x[i]);
    return _mm256_cvtss_f32(sum);
}

const struct bench_peak bench_peak_avx2 = {"avx2", 2 * LANES *CHAINS, run};
