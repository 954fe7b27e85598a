// SPDX-License-Identifier: BSD-3-Clause
// What is known of a shot before its frames are made: each frame's arguments, and how many frames go at once.
#ifndef HF_CLI_PLAN_H
#define HF_CLI_PLAN_H

#include "tools/cli/args.h"
#include "tools/cli/frame.h"
#include "tools/cli/keys.h"
#include "tools/cli/shot.h"

struct cli_plan {
    const struct cli_args *args;
    const struct cli_shot *shot;
    struct cli_keys keys;
    float *focus;  // of each job, by a focus that follows; NULL: none
};

// Reads --keys, and looks at the pictures where the focus follows them. Returns 0, or an exit code with *error filled;
// close it in either case.
int cli_plan_open(struct cli_plan *plan, const struct cli_args *args, const struct cli_shot *shot,
                  struct tool_error *error);
void cli_plan_close(struct cli_plan *plan);

// The arguments of job number i: nothing in them to be freed.
void cli_plan_args(const struct cli_plan *plan, int i, struct cli_args *args);

// Threads to work on.
int cli_plan_threads(const struct cli_args *args);
// Bytes that a frame in work takes, by its pixels and what the library holds for it.
double cli_plan_frame_bytes(const struct cli_frame *frame, double library);
// Bytes that --memory-limit allows.
double cli_plan_memory_limit(const struct cli_args *args);
// How many of some frames go at once: one for two threads; where a frame waits for the disk (wait: that time over its time
// of computing on one thread) one for each and more; fewer where memory is short, base bytes being in use for other things.
int cli_plan_workers(const struct cli_args *args, int frames, double wait, double base, double frame_bytes);

#endif
