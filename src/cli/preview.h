// SPDX-License-Identifier: BSD-3-Clause
// What would be done with a shot: --dry-run and --print-focus, on stdout.
#ifndef HF_CLI_PREVIEW_H
#define HF_CLI_PREVIEW_H

#include "cli/args.h"
#include "cli/shot.h"

// The frames with their files, and the memory and time that the first lets expect. Returns an exit code.
int cli_preview(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

// A table frame,focus, as --keys reads it. Returns an exit code; frames without a focus are named on stderr.
int cli_print_focus(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error);

#endif
