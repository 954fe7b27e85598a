// SPDX-License-Identifier: BSD-3-Clause
// --explain-image and --focus-image: a frame's pictures painted by what its tiles and its pixels are. With several
// views each gets a file of its own, its name before the extension.
#ifndef HF_CLI_OVERLAY_H
#define HF_CLI_OVERLAY_H

#include "tools/cli/frame.h"

// Write those that were asked for. 0, or an exit code with *error filled.
int cli_overlay_write(const struct cli_frame *frame, struct tool_error *error);

// Before any work: does one write over another file that the arguments name? 0, or an exit code.
int cli_overlay_check(const struct cli_frame *frame, struct tool_error *error);

#endif
