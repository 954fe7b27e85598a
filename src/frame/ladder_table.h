// SPDX-License-Identifier: BSD-3-Clause
// Made by `hyperfocal-bench tradeoff --ladder src/frame/ladder_table.h`. Do not edit.
//
// Settings worth having, cheapest first. Each takes a fifth longer than the one before and errs less by 0.2 dB or more on
// average; on no scene where both may be chosen does it err by 0.1 dB more. Those of the gaussian engine are for blur
// no wider than theirs; for a lens the list begins below them.
// clang-format off
#define HF_LADDER_MEASURED "2026-11-27, AMD EPYC, avx512, 2 threads"
// The command's words; display-encoded root mean square error, geometric mean of the scenes and of the worst;
// milliseconds of a megapixel; the parameters that the words stand for.
#define HF_LADDER_STEPS \
    {"--engine gaussian --resolution quarter --iterations 4", 0.058137f, 0.078830f, 1.550f, \
     {HF_PARAMS_DEFAULTS, .engine = HF_ENGINE_GAUSSIAN, .hexagon.resolution = 2, .scatter.resolution = 2, .gaussian.resolution = 2, .gaussian.iterations = 4}}, \
    {"--engine gather", 0.029366f, 0.050115f, 17.98f, \
     {HF_PARAMS_DEFAULTS}}, \
    {"--engine layers", 0.021675f, 0.027726f, 47.14f, \
     {HF_PARAMS_DEFAULTS, .engine = HF_ENGINE_LAYERS}}, \
    {"--engine layers --layers-quality best", 0.020454f, 0.027763f, 182.3f, \
     {HF_PARAMS_DEFAULTS, .engine = HF_ENGINE_LAYERS, .layers.quality = 3}}
// steps of draft, standard, high and best
#define HF_LADDER_QUALITIES 1, 2, 3, 3
// milliseconds per megapixel of each engine with its default settings
#define HF_LADDER_ENGINES 17.98f, 39.37f, 87.36f, 2.957f, 47.14f, 10.71f
// clang-format on
