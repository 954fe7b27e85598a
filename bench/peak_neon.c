// SPDX-License-Identifier: BSD-3-Clause
#include "peak.h"

#include <arm_neon.h>

// Up to four pipes with a latency of 4 need 16 chains. There are 32 registers.
enum { CHAINS = 20, LANES = 4 };

static float run(long n)
{
    const float32x4_t factor = vdupq_n_f32(BENCH_PEAK_TERM), term = vdupq_n_f32(BENCH_PEAK_TERM);
    float32x4_t x[CHAINS];
    for (int i = 0; i < CHAINS; i++)
        x[i] = vdupq_n_f32(1 + (float)i);
    // NEON's instruction adds to its first operand, so x grows by a millionth per step, far from overflow.
    for (; n > 0; n--) {
#pragma GCC unroll 20
        for (int i = 0; i < CHAINS; i++)
            x[i] = vfmaq_f32(x[i], factor, term);
    }
    float32x4_t sum = x[0];
    for (int i = 1; i < CHAINS; i++)
        sum = vaddq_f32(sum, x[i]);
    return vgetq_lane_f32(sum, 0);
}

const struct bench_peak bench_peak_neon = {"neon", 2 * LANES *CHAINS, run};
