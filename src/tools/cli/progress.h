// SPDX-License-Identifier: BSD-3-Clause
// How far a shot is: a bar on a terminal, else a line for each frame. On stderr, from any thread.
#ifndef HF_CLI_PROGRESS_H
#define HF_CLI_PROGRESS_H

#include <stdatomic.h>

#include "tools/cli/frame.h"

struct cli_progress {
    int total;
    int quiet, bar;  // bar: stderr is a terminal
    double start;
    atomic_int done, skipped, failed;
    atomic_int rendered;          // of those done, by this run: the rest was skipped
    atomic_llong us[CLI_STAGES];  // microseconds in each stage, summed over the frames
};

void cli_progress_begin(struct cli_progress *p, int total, int quiet);
// A frame is finished: its name, and a text about it such as "0.21 s, focus 4.4".
void cli_progress_frame(struct cli_progress *p, const char *name, const char *text);
void cli_progress_end(struct cli_progress *p);

#endif
