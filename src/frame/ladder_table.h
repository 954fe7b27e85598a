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
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.870f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.887f}, \
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 1.960f}, \
    {"--engine gather", 0.045834f, 0.091190f, 24.56f}, \
    {"--engine layers --spacing 8 --no-unmix --no-highlights", 0.033730f, 0.079202f, 43.18f}, \
    {"--engine layers --spacing 1 --half-from 4", 0.026221f, 0.039381f, 59.08f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 5, 5, 5
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 24.56f, 38.75f, 87.58f, 3.938f, 53.30f
// clang-format on
