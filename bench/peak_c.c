// SPDX-License-Identifier: BSD-3-Clause
#include "peak.h"

// Vectors of four, which the compiler maps to instructions that every CPU of the architecture has. Without a fused
// instruction, a multiplication and an addition are two operations and count as such.
typedef float vec4 __attribute__((vector_size(16)));
enum { CHAINS = 12, LANES = 4 };

static float run(long n)
{
    const vec4 factor = {BENCH_PEAK_FACTOR, BENCH_PEAK_FACTOR, BENCH_PEAK_FACTOR, BENCH_PEAK_FACTOR};
    const vec4 term = {BENCH_PEAK_TERM, BENCH_PEAK_TERM, BENCH_PEAK_TERM, BENCH_PEAK_TERM};
    vec4 x[CHAINS];
    for (int i = 0; i < CHAINS; i++)
        x[i] = term + (float)i;
    for (; n > 0; n--) {
#pragma GCC unroll 16
        for (int i = 0; i < CHAINS; i++)
            x[i] = x[i] * factor + term;
    }
    vec4 sum = x[0];
    for (int i = 1; i < CHAINS; i++)
        sum += x[i];
    return sum[0];
}

const struct bench_peak bench_peak_c = {"scalar", 2 * LANES *CHAINS, run};
