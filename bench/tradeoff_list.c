// SPDX-License-Identifier: BSD-3-Clause
// The settings that are measured: each option alone, changed from its engine's default; then combinations that may lie
// on the front. Both programs understand these options.
#include "tradeoff.h"

// clang-format off
const struct trade_setting trade_settings[] = {
    // The plain copy of the picture, and the engines with their defaults.
    {"engine", "no blur", "--engine gaussian --max-radius 0", 1},
    {"engine", "gather", "--engine gather", 1},
    {"engine", "hexagon", "--engine hexagon", 1},
    {"engine", "scatter", "--engine scatter", 1},
    {"engine", "gaussian", "--engine gaussian", 1},
    {"engine", "layers", "--engine layers", 1},
    {"engine", "chapter", "--engine chapter", 0},

    {"resolution", "hexagon half", "--engine hexagon --resolution half", 0},
    {"resolution", "scatter half", "--engine scatter --resolution half", 1},
    {"resolution", "gaussian half", "--engine gaussian --resolution half", 0},
    {"resolution", "gaussian quarter", "--engine gaussian --resolution quarter", 1},

    // Taps, all with the same reach; 49 taps are 3 rings. Fill, downsample and division as in the chapter.
    {"taps", "9 taps", "--engine chapter --rings 1", 0},
    {"taps", "25 taps", "--engine chapter --rings 2", 0},
    {"taps", "49 taps + fill", "--engine chapter --rings 3", 1},
    {"taps", "49 taps, open", "--engine chapter --rings 3 --fill open", 0},
    {"taps", "81 taps", "--engine chapter --rings 4", 0},
    {"taps", "121 taps", "--engine chapter --rings 5", 0},
    {"taps", "225 taps", "--engine chapter --rings 7", 0},
    {"taps", "441 taps", "--engine chapter --rings 10", 0},
    {"taps", "144 taps, no fill", "--engine chapter --fill none", 1},

    {"fill", "fill mean", "--engine chapter --fill mean", 0},
    {"fill", "144 taps, no fill, packed", "--engine chapter --fill none --storage packed", 0},
    {"fill", "fill open", "--engine chapter --fill open", 0},
    {"downsample", "linear downsample", "--engine chapter --downsample linear", 0},
    {"downsample", "point downsample", "--engine chapter --downsample point", 0},
    {"division", "reciprocal estimates", "--engine chapter --division estimate", 0},
    {"division", "and a Newton step", "--engine chapter --division newton", 0},
    {"division", "and two Newton steps", "--engine chapter --division newton2", 0},
    {"storage", "half storage", "--engine gather --storage half", 0},
    {"storage", "packed storage", "--engine gather --storage packed", 0},
    {"upsample", "printed composite", "--engine chapter --faithful", 0},
    {"upsample", "bicubic near", "--engine gather --bicubic", 0},
    {"weights", "Karis", "--engine gather --karis", 0},
    {"kernel", "per-pixel kernel", "--engine gather --per-pixel-kernel", 0},
    {"blend", "smoothstep", "--engine gather --blend smoothstep", 0},

    {"layers", "layers draft", "--engine layers --layers-quality draft", 1},
    {"layers", "layers high", "--engine layers --layers-quality high", 0},
    {"layers", "layers best", "--engine layers --layers-quality best", 1},
    {"layers", "layers, no un-mixing", "--engine layers --no-unmix", 0},
    {"layers", "layers, nothing hidden", "--engine layers --no-hidden", 0},
    {"layers", "layers, no highlights", "--engine layers --no-highlights", 0},
    {"layers", "slices alone", "--engine layers --no-unmix --no-hidden --no-highlights", 0},
    {"layers", "slices every 8", "--engine layers --spacing 8", 0},
    {"layers", "slices every 4", "--engine layers --spacing 4", 0},
    {"layers", "slices every 1", "--engine layers --spacing 1", 0},
    {"layers", "half from 4", "--engine layers --half-from 4", 0},
    {"layers", "half from 16", "--engine layers --half-from 16", 0},
    {"layers", "quarter from 16", "--engine layers --quarter-from 16", 0},
    {"layers", "quarter from 64", "--engine layers --quarter-from 64", 0},
    {"layers", "all at full resolution", "--engine layers --half-from 2048", 0},

    {"bits", "gather deterministic", "--engine gather --deterministic", 0},
    {"bits", "scatter deterministic", "--engine scatter --deterministic", 0},
    {"bits", "layers deterministic", "--engine layers --deterministic", 0},
    {"skipping", "gather no skip", "--engine gather --no-skip", 0},

    {"isa", "gather scalar", "--engine gather --isa scalar", 0},
    {"isa", "gather SSE4.1", "--engine gather --isa sse4.1", 0},
    {"isa", "gather AVX2", "--engine gather --isa avx2", 0},
    {"isa", "gather AVX-512", "--engine gather --isa avx512", 0},
    {"isa", "gather NEON", "--engine gather --isa neon", 0},
    {"isa", "layers SSE4.1", "--engine layers --isa sse4.1", 0},
    {"isa", "layers AVX2", "--engine layers --isa avx2", 0},
    {"threads", "gather 1 thread", "--engine gather --threads 1", 0},
    {"threads", "scatter 1 thread", "--engine scatter --threads 1", 0},
    {"threads", "layers 1 thread", "--engine layers --threads 1", 0},

    {"gaussian", "gaussian 1 iteration", "--engine gaussian --iterations 1", 0},
    {"gaussian", "gaussian 12 iterations", "--engine gaussian --iterations 12", 0},
    {"gaussian", "gaussian sigma 6", "--engine gaussian --sigma 6", 0},

    // The grid. The cheapest settings:
    {"grid", "quarter, 1 iteration", "--engine gaussian --resolution quarter --iterations 1", 1},
    {"grid", "quarter, 2 iterations", "--engine gaussian --resolution quarter --iterations 2", 1},
    {"grid", "quarter, 4 iterations", "--engine gaussian --resolution quarter --iterations 4", 1},
    {"grid", "quarter, 5 iterations", "--engine gaussian --resolution quarter --iterations 5", 0},
    {"grid", "quarter, sigma 6", "--engine gaussian --resolution quarter --sigma 6", 0},
    {"grid", "half, 8 iterations", "--engine gaussian --resolution half --iterations 8", 0},
    {"grid", "gather, half, bicubic", "--engine gather --storage half --bicubic", 0},
    {"grid", "gather, Karis, bicubic", "--engine gather --karis --bicubic", 0},
    {"grid", "144 taps, per pixel", "--engine chapter --fill none --per-pixel-kernel", 0},
    // Layers, from coarse to fine:
    {"grid", "coarse, bare", "--engine layers --layers-quality draft --spacing 8 --no-unmix --no-highlights", 1},
    {"grid", "coarse, un-mixed", "--engine layers --layers-quality draft --spacing 8 --no-highlights", 0},
    {"grid", "coarse, hidden", "--engine layers --spacing 8 --no-unmix --no-highlights", 1},
    {"grid", "coarse, hidden, un-mixed", "--engine layers --spacing 8 --no-highlights", 0},
    {"grid", "hidden, no highlights", "--engine layers --spacing 4 --no-unmix --quarter-from 16", 0},
    {"grid", "every 8, quarter from 16", "--engine layers --spacing 8 --quarter-from 16", 0},
    {"grid", "every 8, half from 4", "--engine layers --spacing 8 --half-from 4", 0},
    {"grid", "every 4, half from 4", "--engine layers --spacing 4 --half-from 4", 0},
    {"grid", "every 1, half from 4", "--engine layers --spacing 1 --half-from 4", 1},
    {"grid", "every 0.5, half from 3", "--engine layers --spacing 0.5 --half-from 3", 0},
    {"grid", "high, half from 4", "--engine layers --layers-quality high --half-from 4", 0},
    {"grid", "high, every 1, half from 4", "--engine layers --layers-quality high --spacing 1 --half-from 4", 0},
    // The most accurate settings: best looks for patterns at any spacing of slices.
    {"grid", "best, no patterns", "--engine layers --layers-quality best --no-patterns", 0},
    {"grid", "best, slices", "--engine layers --layers-quality best --lens-points 1", 0},
    {"grid", "32 views", "--engine layers --lens-points 32", 0},
    {"grid", "best, 32 views", "--engine layers --layers-quality best --lens-points 32", 0},
    {"grid", "best, every 4", "--engine layers --layers-quality best --spacing 4", 0},
    {"grid", "best, every 1, half from 4", "--engine layers --layers-quality best --spacing 1 --half-from 4", 0},
    {"grid", "best, all at full", "--engine layers --layers-quality best --half-from 2048", 0},
};
// clang-format on

const int trade_setting_count = sizeof trade_settings / sizeof *trade_settings;
_Static_assert(sizeof trade_settings / sizeof *trade_settings <= TRADE_SETTINGS, "room for all");
