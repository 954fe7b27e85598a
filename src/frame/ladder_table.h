// SPDX-License-Identifier: BSD-3-Clause
// Rough: put down by hand after --quick runs on a busy machine.
// `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h` makes this file anew.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-22, Intel(R) Xeon(R) Processor, avx512, 2 threads, busy: rough"
// options, mean and worst error, milliseconds of a megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083176f, 0.136615f, 2.5f}, \
    {"--engine gaussian --resolution quarter", 0.059020f, 0.075423f, 3.5f}, \
    {"--engine layers", 0.027542f, 0.040879f, 80.0f}, \
    {"--engine layers --spacing 1 --half-from 4", 0.027102f, 0.039355f, 100.0f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 2, 2, 3
// of a megapixel, by engine
#define HF_LADDER_ENGINES 14.0f, 50.0f, 60.0f, 10.0f, 80.0f
// clang-format on
