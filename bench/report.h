// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_BENCH_REPORT_H
#define HF_BENCH_REPORT_H

#include "args.h"
#include "measure.h"

#include <stdio.h>

// What a report states besides the numbers.
struct bench_run {
    const char *command;  // "passes"
    const struct bench_args *args;
    int width, height;  // of the scene
    int threads;        // used for the run
    enum hf_isa isa;
    const struct bench_result *result;
};

// Measure what the options of `passes` ask for, with_uses the other uses of the library too. Fills *result, and *run, which
// points at it. Returns 0, or -1 with *error filled.
int bench_passes_measure(struct bench_args *args, int with_uses, struct bench_run *run, struct bench_result *result,
                         struct tool_error *error);

// A table for people.
void bench_report_table(FILE *out, const struct bench_run *run);
// One JSON object.
void bench_report_json(FILE *out, const struct bench_run *run);

#endif
