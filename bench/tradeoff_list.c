// SPDX-License-Identifier: BSD-3-Clause
// The settings that are measured: each knob alone, turned from the default of its engine, then combinations that may lie
// on the front. Options are those of both programs.
#include "tradeoff.h"

const struct trade_setting trade_settings[] = {
    // The engines as they are.
    {"engine", "gather", "--engine gather", 1},
    {"engine", "hexagon", "--engine hexagon", 0},
    {"engine", "scatter", "--engine scatter", 1},
    {"engine", "gaussian", "--engine gaussian", 0},

    {"resolution", "hexagon half", "--engine hexagon --resolution half", 1},
    {"resolution", "scatter half", "--engine scatter --resolution half", 1},
    {"resolution", "gaussian half", "--engine gaussian --resolution half", 0},
    {"resolution", "gaussian quarter", "--engine gaussian --resolution quarter", 1},

    // Taps, all with the same reach: 49 are 3 rings.
    {"taps", "9 taps", "--engine gather --rings 1", 1},
    {"taps", "25 taps", "--engine gather --rings 2", 1},
    {"taps", "49 taps + fill", "--engine gather --rings 3", 1},
    {"taps", "81 taps", "--engine gather --rings 4", 0},
    {"taps", "121 taps", "--engine gather --rings 5", 0},
    {"taps", "225 taps", "--engine gather --rings 7", 0},
    {"taps", "441 taps", "--engine gather --rings 10", 0},
    {"taps", "144 taps, no fill", "--engine gather --fill none", 1},

    {"fill", "fill mean", "--engine gather --fill mean", 1},
    {"storage", "half storage", "--engine gather --storage half", 0},
    {"storage", "packed storage", "--engine gather --storage packed", 0},
    {"upsample", "printed composite", "--engine gather --faithful", 0},
    {"upsample", "bicubic near", "--engine gather --bicubic", 0},
    {"weights", "Karis", "--engine gather --karis", 0},
    {"kernel", "per-pixel kernel", "--engine gather --per-pixel-kernel", 1},
    {"blend", "smoothstep", "--engine gather --blend smoothstep", 0},
    {"bits", "gather deterministic", "--engine gather --deterministic", 0},
    {"bits", "scatter deterministic", "--engine scatter --deterministic", 0},
    {"skipping", "gather no skip", "--engine gather --no-skip", 0},

    {"isa", "gather scalar", "--engine gather --isa scalar", 0},
    {"isa", "gather SSE4.1", "--engine gather --isa sse4.1", 0},
    {"isa", "gather AVX2", "--engine gather --isa avx2", 0},
    {"isa", "gather AVX-512", "--engine gather --isa avx512", 0},
    {"isa", "gather NEON", "--engine gather --isa neon", 0},
    {"isa", "scatter scalar", "--engine scatter --isa scalar", 0},
    {"isa", "scatter AVX2", "--engine scatter --isa avx2", 0},
    {"threads", "gather 1 thread", "--engine gather --threads 1", 0},
    {"threads", "scatter 1 thread", "--engine scatter --threads 1", 0},

    {"gaussian", "gaussian 1 iteration", "--engine gaussian --iterations 1", 0},
    {"gaussian", "gaussian 12 iterations", "--engine gaussian --iterations 12", 0},
    {"gaussian", "gaussian sigma 6", "--engine gaussian --sigma 6", 0},

    // The grid.
    {"grid", "quarter, 1 iteration", "--engine gaussian --resolution quarter --iterations 1", 1},
    {"grid", "quarter, sigma 6", "--engine gaussian --resolution quarter --sigma 6", 1},
    {"grid", "quarter, sigma 12", "--engine gaussian --resolution quarter --sigma 12", 0},
    {"grid", "half, sigma 6", "--engine gaussian --resolution half --sigma 6", 0},
    {"grid", "9 taps, mean", "--engine gather --rings 1 --fill mean", 1},
    {"grid", "25 taps, mean", "--engine gather --rings 2 --fill mean", 1},
    {"grid", "49 taps, mean", "--engine gather --rings 3 --fill mean", 1},
    {"grid", "81 taps, mean", "--engine gather --rings 4 --fill mean", 0},
    {"grid", "225 taps, mean", "--engine gather --rings 7 --fill mean", 0},
    {"grid", "9 taps, mean, per pixel", "--engine gather --rings 1 --fill mean --per-pixel-kernel", 0},
    {"grid", "25 taps, mean, per pixel", "--engine gather --rings 2 --fill mean --per-pixel-kernel", 0},
    {"grid", "49 taps, mean, per pixel", "--engine gather --rings 3 --fill mean --per-pixel-kernel", 1},
    {"grid", "81 taps, mean, per pixel", "--engine gather --rings 4 --fill mean --per-pixel-kernel", 0},
    {"grid", "225 taps, mean, per pixel", "--engine gather --rings 7 --fill mean --per-pixel-kernel", 0},
    {"grid", "mean, per pixel", "--engine gather --fill mean --per-pixel-kernel", 1},
    {"grid", "144 taps, per pixel", "--engine gather --fill none --per-pixel-kernel", 1},
    {"grid", "mean, per pixel, Karis", "--engine gather --fill mean --per-pixel-kernel --karis", 0},
    {"grid", "mean, per pixel, bicubic", "--engine gather --fill mean --per-pixel-kernel --bicubic", 0},
    {"grid", "mean, Karis", "--engine gather --fill mean --karis", 0},
    {"grid", "mean, bicubic", "--engine gather --fill mean --bicubic", 0},
    {"grid", "mean, half storage", "--engine gather --fill mean --storage half", 0},
    {"grid", "hexagon half, 1 thread", "--engine hexagon --resolution half --threads 1", 0},
};

const int trade_setting_count = sizeof trade_settings / sizeof *trade_settings;
_Static_assert(sizeof trade_settings / sizeof *trade_settings <= TRADE_SETTINGS, "room for all");
