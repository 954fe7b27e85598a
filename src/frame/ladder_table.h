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
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 1.892f}, \
    {"--engine gather", 0.045835f, 0.091194f, 31.57f}, \
    {"--engine layers", 0.026320f, 0.040952f, 61.27f}, \
    {"--engine layers --layers-quality high", 0.025950f, 0.039822f, 65.15f}, \
    {"--engine layers --layers-quality best", 0.024207f, 0.039229f, 211.8f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 2, 4, 4
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 31.57f, 56.02f, 107.9f, 3.820f, 61.27f
// clang-format on
