// SPDX-License-Identifier: BSD-3-Clause
// A shot: from names with places for a number, or lists of names, to the files of each frame.
#ifndef HF_CLI_SHOT_H
#define HF_CLI_SHOT_H

#include "tools/common/error.h"
#include "tools/cli/frames.h"

// What was asked for; NULL what was not.
struct cli_shot_request {
    const char *const *inputs;
    int input_count;
    const char *output, *depth_file, *frames, *chunk;
    const char *views;     // names with commas, for %V
    const char *log_file;  // which is to be none of the shot's files
};

// One frame, or one view of it where views are files of their own.
struct cli_job {
    int frame, numbered;                // numbered: the frame has a number
    int place;                          // among the frames; the views of one frame have the same
    int view_file;                      // a view that is a file of its own:
    int view;                           // which
    char *input, *output, *depth_file;  // NULL: none
};

struct cli_jobs {
    struct cli_job *list;
    int count;
};

struct cli_shot {
    struct cli_jobs jobs;    // those of this process, in the order in which they are to be made
    struct cli_jobs around;  // every frame that there is, without output: what a focus that follows looks at
    int sequence;            // INPUT was a pattern or a list, also if that is one frame
    int missing;             // frames that were asked for, or lie between the first and the last, and are not there
    char gaps[1024];         // which
};

// Returns 0, or an exit code with *error filled; free it in either case.
int cli_shot_make(struct cli_shot *shot, const struct cli_shot_request *request, struct tool_error *error);
void cli_shot_free(struct cli_shot *shot);

#endif
