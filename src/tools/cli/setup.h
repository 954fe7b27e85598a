// SPDX-License-Identifier: BSD-3-Clause
// Turns the command line and a view's header into the library's parameters: the model, the focus, the meaning of the
// depth.
#ifndef HF_CLI_SETUP_H
#define HF_CLI_SETUP_H

#include "hyperfocal/hyperfocal.h"

#include "tools/cli/args.h"
#include "tools/common/error.h"
#include "tools/common/report.h"
#include "tools/io/io.h"

enum cli_model { CLI_MODEL_RANGE, CLI_MODEL_LENS, CLI_MODEL_COC };

// "range", "lens", "coc".
const char *cli_model_name(enum cli_model model);

// Render settings of one view.
struct cli_setup {
    enum cli_model model;
    // "--focus", "--focus-at", "--focus center", "--focus-object", "--focus-point", "header", "the picture's centre"; NULL: none needed (coc).
    const char *focus_from;
    struct hf_params params;
    struct tool_choice choice;  // of --quality or --max-error; inner.options is NULL without them
    bool missed;                // no setting has an error as small as --max-error
    struct hf_depth depth;      // the caller sets data
};

// Describe a view's depth: what its numbers mean; for ray depth also where the camera's axis is and how wide the view is.
void cli_setup_depth(struct hf_depth *depth, const struct cli_args *args, const struct hf_io_view *view,
                     const float *data);

// Fill *setup for a view, except where the focus is an object's: frame.c finds that before. depth: width * height samples, or NULL if they are not needed. label names the file and the
// view in messages. Returns 0, or an exit code with *error filled.
int cli_setup_view(struct cli_setup *setup, const struct cli_args *args, const struct hf_io_view *view,
                   const float *depth, const char *label, struct tool_error *error);

#endif
