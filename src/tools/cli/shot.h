// SPDX-License-Identifier: BSD-3-Clause
// A shot: turns names with places for a number, or lists of names, into the files of each frame.
#ifndef HF_CLI_SHOT_H
#define HF_CLI_SHOT_H

#include "tools/common/error.h"
#include "tools/cli/frames.h"

// What the command line asks for; NULL what it does not give.
struct cli_shot_request {
    const char *const *inputs;
    int input_count;
    const char *output, *depth_file, *frames, *chunk;
    const char *const *others;  // further pictures of each frame
    int other_count;
    const char *other_option;  // that named them
    const char *views;         // names with commas, for %V
    const char *log_file;      // must not be one of the shot's files
};

// One frame, or one view of it if each view is a file of its own.
struct cli_job {
    int frame, numbered;                // numbered: the frame has a number
    int place;                          // index among the frames; the views of a frame share it
    int view_file;                      // 1: each view is a file of its own
    int view;                           // which view this file holds; -1: all
    char *input, *output, *depth_file;  // NULL: none
    char **others;                      // other_count of the shot
};

struct cli_jobs {
    struct cli_job *list;
    int count;
};

struct cli_shot {
    int other_count;           // further pictures of each frame
    const char *other_option;  // that named them
    struct cli_jobs jobs;      // the jobs of this process, in the order in which they are made
    struct cli_jobs around;    // all existing frames, without output: a focus that follows the pictures reads these
    int sequence;              // INPUT was a pattern or a list, even one of a single frame
    int missing;      // how many frames do not exist that were asked for, or lie between the first and the last
    char gaps[1024];  // their numbers
};

// Returns 0, or an exit code with *error filled; free it in either case.
int cli_shot_make(struct cli_shot *shot, const struct cli_shot_request *request, struct tool_error *error);
void cli_shot_free(struct cli_shot *shot);

#endif
