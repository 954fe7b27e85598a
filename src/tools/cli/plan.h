// SPDX-License-Identifier: BSD-3-Clause
// The plan of a shot, before its frames are made: the arguments of each frame, and how many frames are made at once.
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
    float *focus;  // of each job, if the focus follows the pictures; NULL: it does not
};

// Read --keys, and the depth of the pictures if the focus follows them. Returns 0, or an exit code with *error filled;
// close the plan in either case.
int cli_plan_open(struct cli_plan *plan, const struct cli_args *args, const struct cli_shot *shot,
                  struct tool_error *error);
void cli_plan_close(struct cli_plan *plan);

// The arguments of job i. They own nothing that has to be freed.
void cli_plan_args(const struct cli_plan *plan, int i, struct cli_args *args);

// Threads to work on.
int cli_plan_threads(const struct cli_args *args);
// Bytes that a frame takes while it is made: those of its pixels, and `library` for the library.
double cli_plan_frame_bytes(const struct cli_frame *frame, double library);
// Bytes that --memory-limit allows.
double cli_plan_memory_limit(const struct cli_args *args);
// How many frames are made at once: one for every two threads; one for every thread if another process reads or writes
// them; one or more for every thread if frames wait for the disk; fewer if memory is short. helped: hf_io_is_helped of the
// frames. wait: the time in which a frame waits for the disk, over the time in which one thread computes it. base: bytes in
// use for other things.
int cli_plan_workers(const struct cli_args *args, int frames, int helped, double wait, double base, double frame_bytes);

#endif
