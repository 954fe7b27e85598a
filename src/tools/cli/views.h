// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_VIEWS_H
#define HF_CLI_VIEWS_H

#include "tools/cli/frame.h"

// Make frame->views from the file and --views: names and labels. Checks that each view has a depth, and windows of a
// size that the library takes. Returns 0, or an exit code with *error filled.
int cli_select_views(struct cli_frame *frame, struct tool_error *error);
// Check that OUTPUT can hold all of frame->views.
int cli_check_single(const struct cli_frame *frame, struct tool_error *error);

#endif
