// SPDX-License-Identifier: BSD-3-Clause
// How many multiply-adds a processor can do at most: independent chains in registers, without memory. Each instruction
// set has a file of its own, because it needs its own compiler flags.
#ifndef HF_BENCH_PEAK_H
#define HF_BENCH_PEAK_H

struct bench_peak {
    const char *name;
    int flops;             // of one iteration: 2 per multiply-add and lane
    float (*run)(long n);  // n iterations; the result exists so that the compiler keeps them
};

extern const struct bench_peak bench_peak_c, bench_peak_avx2, bench_peak_avx512, bench_peak_neon;

// That of the widest instruction set of this CPU, whichever one the library was told to use.
const struct bench_peak *bench_peak_widest(void);

// x = x * FACTOR + TERM stays near 1, without overflow, and without denormals, which could be slow.
#define BENCH_PEAK_FACTOR 0.999f
#define BENCH_PEAK_TERM 0.001f

#endif
