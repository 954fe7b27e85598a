// SPDX-License-Identifier: BSD-3-Clause
// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.
//
// Settings worth having, cheapest first. Each takes longer than the one before and errs less, on the mean and on every
// scene where either may be chosen. Those of the gaussian engine are for blur that is no wider than theirs; for a lens the
// list begins below them.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-22, Intel(R) Xeon(R) Processor, avx512, 2 threads"
// options; display-encoded root mean square error, geometric mean of the scenes and of the worst; milliseconds of a
// megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.542f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.553f}, \
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 1.614f}, \
    {"--engine gather", 0.037081f, 0.078433f, 31.04f}, \
    {"--engine layers --spacing 8", 0.025957f, 0.039993f, 54.96f}, \
    {"--engine layers", 0.025169f, 0.037854f, 61.64f}, \
    {"--engine layers --layers-quality best", 0.023613f, 0.037747f, 184.6f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 4, 6, 6
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 31.04f, 55.89f, 115.3f, 3.820f, 61.64f
// clang-format on
