// SPDX-License-Identifier: BSD-3-Clause
// How many multiply-adds a processor can do when nothing holds it up: independent chains in registers, no memory. One
// implementation per instruction set, in a file of its own because it needs the compiler's flags for it.
#ifndef HF_BENCH_PEAK_H
#define HF_BENCH_PEAK_H

struct bench_peak {
    const char *name;
    int flops;             // of one iteration: 2 per multiply-add and lane
    float (*run)(long n);  // n iterations; the result only keeps the compiler from dropping them
};

extern const struct bench_peak bench_peak_c, bench_peak_avx2, bench_peak_avx512, bench_peak_neon;

// The widest of this CPU, whatever instruction set the library was told to use.
const struct bench_peak *bench_peak_widest(void);

// x = x * FACTOR + TERM stays near 1: no overflow, no denormals, which could be slow.
#define BENCH_PEAK_FACTOR 0.999f
#define BENCH_PEAK_TERM 0.001f

#endif
