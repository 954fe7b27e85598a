// SPDX-License-Identifier: BSD-3-Clause
#include "peak.h"

#include <immintrin.h>

// Two pipes with a latency of 4 need 8 chains. There are 32 registers.
enum { CHAINS = 16, LANES = 16 };

static float run(long n)
{
    const __m512 factor = _mm512_set1_ps(BENCH_PEAK_FACTOR), term = _mm512_set1_ps(BENCH_PEAK_TERM);
    __m512 x[CHAINS];
    for (int i = 0; i < CHAINS; i++)
        x[i] = _mm512_set1_ps(1 + (float)i);
    for (; n > 0; n--) {
#pragma GCC unroll 16
        for (int i = 0; i < CHAINS; i++)
            x[i] = _mm512_fmadd_ps(x[i], factor, term);
    }
    __m512 sum = x[0];
    for (int i = 1; i < CHAINS; i++)
        sum = _mm512_add_ps(sum, x[i]);
    return _mm512_cvtss_f32(sum);
}

const struct bench_peak bench_peak_avx512 = {"avx512", 2 * LANES *CHAINS, run};
