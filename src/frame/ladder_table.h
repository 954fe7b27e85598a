// SPDX-License-Identifier: BSD-3-Clause
// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.
//
// Settings worth having, cheapest first. Each takes longer than the one before and errs less, and on no scene where
// either may be chosen by 0.1 dB more. Those of the gaussian engine are for blur that is no wider than theirs; for a
// lens the list begins below them.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-22, Intel(R) Xeon(R) Processor, avx512, 2 threads"
// options; display-encoded root mean square error, geometric mean of the scenes and of the worst; milliseconds of a
// megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.988f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 2.003f}, \
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 2.030f}, \
    {"--engine gather", 0.037152f, 0.078830f, 35.54f}, \
    {"--engine layers", 0.025014f, 0.037648f, 64.61f}, \
    {"--engine layers --layers-quality best", 0.023619f, 0.037659f, 192.9f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 3, 4, 5, 5
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 35.54f, 62.64f, 138.5f, 4.279f, 64.61f
// clang-format on
