// SPDX-License-Identifier: BSD-3-Clause
// --log: one JSON object per line. The first says what the run is, one for each frame what became of it, the last sums
// up.
#ifndef HF_CLI_LOG_H
#define HF_CLI_LOG_H

#include <stdatomic.h>

#include "tools/cli/progress.h"
#include "tools/cli/resume.h"
#include "tools/common/report.h"

enum cli_frame_status { CLI_FRAME_DONE, CLI_FRAME_SKIPPED, CLI_FRAME_FAILED };

struct cli_log {
    int fd;            // meaningless without a path
    const char *path;  // NULL: no log
    atomic_int error;  // errno of the first line that was lost
    atomic_int torn;   // the last line was written in part, so the next write starts a new line
};

// What became of a frame.
struct cli_record {
    enum cli_frame_status status;
    const struct cli_job *job;
    const struct cli_frame *frame;
    const struct cli_stamp *stamp;
    const struct tool_report *report;  // of the last view; NULL unless done
    const char *why;                   // of a failure
    double ms, waited_ms;              // from beginning to end; of that, waiting for memory
};

// path NULL: no log. Returns 0, or an exit code with *error filled.
int cli_log_open(struct cli_log *log, const char *path, int argc, char **argv, int frames, struct tool_error *error);
void cli_log_frame(struct cli_log *log, const struct cli_record *record);
void cli_log_end(struct cli_log *log, const struct cli_progress *progress, int at_once, int budget_missed,
                 double peak_memory);
// Returns 0, or an exit code with *error filled if not all of it could be written.
int cli_log_close(struct cli_log *log, struct tool_error *error);

#endif
