// SPDX-License-Identifier: BSD-3-Clause
// Engines on the ray-traced scenes, those of others.h in that order.
#ifndef HF_BENCH_TRUTH_H
#define HF_BENCH_TRUTH_H

#include "args.h"
#include "others.h"
#include "tools/common/report.h"

struct bench_truth {
    const struct bench_args *args;
    int threads, busy;  // busy: how many measurements met a busy machine
    struct {
        double psnr, rmse, ms;
    } at[BENCH_OTHERS][TOOL_ENGINES];
};

// All engines, or with --engine that one. Returns 0, or -1 with *error filled.
int bench_truth_measure(struct bench_truth *t, const struct bench_args *args, struct tool_error *error);

#endif
