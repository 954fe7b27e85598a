// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_VIEWS_H
#define HF_CLI_VIEWS_H

#include "tools/cli/frame.h"

// Make frame->views from the file and --views: names, labels, and a check that each has depth and windows that can be
// worked with. Returns 0, or an exit code with *error filled.
int cli_select_views(struct cli_frame *frame, struct tool_error *error);

#endif
