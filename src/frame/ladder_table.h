// SPDX-License-Identifier: BSD-3-Clause
// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.
//
// Settings worth having, cheapest first. Each takes longer than the one before and errs less, and on no scene where
// either may be chosen by 0.1 dB more. Those of the gaussian engine are for blur that is no wider than theirs; for a
// lens the list begins below them.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-23, Intel(R) Xeon(R) Processor, avx512, 2 threads"
// options; display-encoded root mean square error, geometric mean of the scenes and of the worst; milliseconds of a
// megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.528f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.544f}, \
    {"--engine gaussian --resolution quarter", 0.059046f, 0.075406f, 1.574f}, \
    {"--engine gather", 0.036734f, 0.077205f, 31.91f}, \
    {"--engine layers --spacing 8 --quarter-from 16", 0.024755f, 0.039431f, 42.49f}, \
    {"--engine layers --spacing 8", 0.024735f, 0.039340f, 44.70f}, \
    {"--engine layers --spacing 4", 0.024493f, 0.037945f, 45.93f}, \
    {"--engine layers", 0.024470f, 0.037510f, 48.45f}, \
    {"--engine layers --layers-quality best --spacing 4", 0.023425f, 0.037687f, 137.5f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 3, 4, 8, 8
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 31.91f, 44.09f, 120.9f, 3.138f, 48.45f
// clang-format on
