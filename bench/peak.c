// SPDX-License-Identifier: BSD-3-Clause
#include "peak.h"

const struct bench_peak *bench_peak_widest(void)
{
#if HF_BENCH_X86
    if (__builtin_cpu_supports("avx512f"))
        return &bench_peak_avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        return &bench_peak_avx2;
#elif HF_BENCH_ARM
    return &bench_peak_neon;
#endif
    return &bench_peak_c;
}
