// SPDX-License-Identifier: BSD-3-Clause
// --explain-image and --focus-image: copies of a frame's pictures, painted by what each tile or each pixel is. With
// several views each copy is a file of its own, with the view's name before the extension.
#ifndef HF_CLI_OVERLAY_H
#define HF_CLI_OVERLAY_H

#include "tools/cli/frame.h"

// Write the copies that were asked for. Returns 0, or an exit code.
int cli_overlay_write(const struct cli_frame *frame, struct tool_error *error);

// Before any work: check that no copy would overwrite a file that the arguments name. Returns 0, or an exit code.
int cli_overlay_check(const struct cli_frame *frame, struct tool_error *error);

#endif
