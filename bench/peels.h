// SPDX-License-Identifier: BSD-3-Clause
// The scenes whose second and third surfaces are known: distance from the truth and time with one, two and three of them.
#ifndef HF_BENCH_PEELS_H
#define HF_BENCH_PEELS_H

#include "args.h"
#include "surfaces.h"

enum { PEEL_SCENES = 16 };

struct bench_peel_scene {
    char name[64];
    int known;  // surfaces, 2 or 3
    struct {
        double psnr, rmse, ms, cpu_ms;
        double ns;  // of processor time for each sample behind the first
    } at[BENCH_SURFACES];
};

struct bench_peels {
    const struct bench_args *args;
    int threads, count;
    struct bench_peel_scene scenes[PEEL_SCENES];
};

// All scenes in args->images that have NAME.exr, NAME.truth.exr and NAME.peel1.exr, by the engine layers; there may be
// none. Returns 0, or -1 with *error filled.
int bench_peels_measure(struct bench_peels *t, const struct bench_args *args, struct tool_error *error);
// `hyperfocal-bench truth --peels`.
int bench_peels(const struct bench_args *args, struct tool_error *error);

#endif
