// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_BENCH_SIMULATE_H
#define HF_BENCH_SIMULATE_H

#include "args.h"
#include "tools/common/error.h"

// Print what frames are expected to take on 1 to 128 threads, for each engine at 1080p and 4K, and what limits them. Returns 0,
// or -1 with *error filled.
int bench_simulate(const struct bench_args *args, struct tool_error *error);

#endif
