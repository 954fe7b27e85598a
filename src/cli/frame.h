// SPDX-License-Identifier: BSD-3-Clause
// One frame: open its file, set up its views, render each by its own depth, write them.
#ifndef HF_CLI_FRAME_H
#define HF_CLI_FRAME_H

#include "cli/setup.h"

// The library, kept from frame to frame, and what it said last.
struct cli_session {
    struct hf_context *context;
    struct cli_error log;
    const char *label;  // what is being rendered, for warnings
};

struct cli_view {
    int index;  // in the file
    const struct hf_io_view *view;
    char *label;  // "shot.exr", "shot.exr, view left"
    struct cli_setup setup;
    float *depth;  // NULL: not read yet, or not needed any more
    float *planes[4];
    struct hf_stats stats;
    struct hf_report report;
    uint8_t *tiles;  // of the report; NULL unless asked for
};

struct cli_frame {
    const struct cli_args *args;
    struct hf_io_file *file;
    struct cli_view *views;  // the selected ones, in the order of the file
    int view_count;
    double read_ms, write_ms;
    uint64_t clamped;  // samples that did not fit the output's channels
};

// Start the library. Returns 0, or an exit code with *error filled.
int cli_session_open(struct cli_session *session, const struct cli_args *args, struct cli_error *error);

// The steps, in order; plan, which looks at the pictures but renders nothing, in place of render. Each returns 0, or an
// exit code with *error filled; close after any of them.
int cli_frame_open(struct cli_frame *frame, const struct cli_args *args, struct cli_error *error);
int cli_frame_setup(struct cli_frame *frame, struct cli_error *error);
int cli_frame_plan(struct cli_frame *frame, struct cli_session *session, struct cli_error *error);
int cli_frame_render(struct cli_frame *frame, struct cli_session *session, struct cli_error *error);
int cli_frame_write(struct cli_frame *frame, struct cli_error *error);
void cli_frame_close(struct cli_frame *frame);

#endif
