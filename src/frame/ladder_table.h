// SPDX-License-Identifier: BSD-3-Clause
// Rough: put down by hand after a --quick run on a busy machine; the times of hexagon and gaussian are guesses.
// `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h` makes this file anew.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-21, Intel(R) Xeon(R) Processor, avx512, 2 threads, busy: rough"
// options, mean and worst error, milliseconds of a megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083176f, 0.136615f, 21.7f}, \
    {"--engine gaussian --resolution quarter --sigma 6", 0.067686f, 0.094624f, 35.0f}, \
    {"--engine scatter", 0.043202f, 0.053580f, 321.0f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 2, 2, 2
// of a megapixel, by engine
#define HF_LADDER_ENGINES 100.0f, 200.0f, 321.0f, 60.0f
// clang-format on
