// SPDX-License-Identifier: BSD-3-Clause
// The progress of a shot on stderr: a bar on a terminal, else a line for each frame. Any thread may call these.
#ifndef HF_CLI_PROGRESS_H
#define HF_CLI_PROGRESS_H

#include <stdatomic.h>

#include "tools/cli/frame.h"

struct cli_progress {
    int total;
    int quiet, bar;  // bar: stderr is a terminal
    double start;
    atomic_int done, skipped, failed;
    atomic_int rendered;          // frames done that this run rendered; it skipped the others
    atomic_llong us[CLI_STAGES];  // microseconds in each stage, summed over the frames
};

void cli_progress_begin(struct cli_progress *p, int total, int quiet);
// Count a finished frame, and print its name with a text about it, such as "0.21 s, focus 4.4".
void cli_progress_frame(struct cli_progress *p, const char *name, const char *text);
void cli_progress_end(struct cli_progress *p);

#endif
