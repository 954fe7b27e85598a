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

// Peak signal-to-noise ratio of n samples of two pictures clamped to 0..1 with the sRGB curve, dB, and root mean square error of
// the linear ones.
void bench_truth_distance(const float *a, const float *b, size_t n, double *psnr, double *rmse);

// All engines, or with --engine that one. Returns 0, or -1 with *error filled.
int bench_truth_measure(struct bench_truth *t, const struct bench_args *args, struct tool_error *error);

#endif
