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
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.741f}, \
    {"--engine gaussian --resolution quarter", 0.059046f, 0.075406f, 1.837f}, \
    {"--engine gather", 0.045627f, 0.091064f, 26.14f}, \
    {"--engine layers --spacing 8 --no-unmix --no-highlights", 0.033109f, 0.079191f, 48.38f}, \
    {"--engine layers", 0.025618f, 0.037848f, 57.72f}, \
    {"--engine layers --layers-quality best", 0.023929f, 0.037740f, 180.5f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 4, 5, 5
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 26.14f, 50.17f, 90.10f, 3.426f, 57.72f
// clang-format on
