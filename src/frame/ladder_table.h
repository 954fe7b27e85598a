// SPDX-License-Identifier: BSD-3-Clause
// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-22, Intel(R) Xeon(R) Processor, avx512, 2 threads; errors of layers later that day"
// options, mean and worst error, milliseconds of a megapixel
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 1", 0.083193f, 0.136679f, 1.853f}, \
    {"--engine gaussian --resolution quarter --iterations 2", 0.067721f, 0.094646f, 1.948f}, \
    {"--engine gaussian --resolution quarter --iterations 4", 0.057830f, 0.081377f, 1.986f}, \
    {"--engine layers --layers-quality draft --spacing 8 --no-unmix --no-highlights", 0.048399f, 0.079382f, 23.96f}, \
    {"--engine layers --spacing 8", 0.032657f, 0.073278f, 47.35f}, \
    {"--engine layers --quarter-from 16", 0.027971f, 0.047330f, 49.59f}, \
    {"--engine layers --spacing 1 --half-from 4", 0.026221f, 0.039381f, 58.70f}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 0, 5, 6, 6
// milliseconds of a megapixel of each engine as it is
#define HF_LADDER_ENGINES 14.40f, 39.49f, 104.2f, 4.105f, 56.89f
// clang-format on
