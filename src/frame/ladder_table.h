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
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.507f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.556f}, \
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 1.570f}, \
    {"--engine gather", 0.037152f, 0.078830f, 28.79f}, \
    {"--engine layers --spacing 8 --no-highlights", 0.031272f, 0.074652f, 39.06f}, \
    {"--engine layers", 0.024655f, 0.037599f, 46.50f}, \
    {"--engine layers --layers-quality high", 0.024639f, 0.037499f, 52.11f}, \
    {"--engine layers --layers-quality best --spacing 4", 0.023550f, 0.037762f, 137.7f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 3, 5, 7, 7
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 28.79f, 44.94f, 92.68f, 3.162f, 46.50f
// clang-format on
