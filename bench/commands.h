// SPDX-License-Identifier: BSD-3-Clause
// The commands of hyperfocal-bench; main.c has the table.
#ifndef HF_BENCH_COMMANDS_H
#define HF_BENCH_COMMANDS_H

#include "args.h"

// Runs a command with the given arguments and prints its report. Returns 0, or -1 with *error filled.
typedef int bench_command(struct bench_args *args, struct tool_error *error);

bench_command bench_batch, bench_cancel, bench_formats, bench_history, bench_passes, bench_score, bench_scaling,
    bench_stability, bench_tradeoff, bench_truth;

#endif
