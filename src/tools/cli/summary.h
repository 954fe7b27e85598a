// SPDX-License-Identifier: BSD-3-Clause
// What was done with a view, or would be in a dry run, as text.
#ifndef HF_CLI_SUMMARY_H
#define HF_CLI_SUMMARY_H

#include "tools/cli/frame.h"

// 1 if radii of a lens or of a coc depth were limited to the largest allowed radius.
int cli_is_limited(const struct cli_view *v);

// Print a line on stderr for each view: with --verbose, or on a terminal unless --quiet.
void cli_print_summary(const struct cli_frame *frame, int warnings);

// Print to stdout how the library resolves a view's settings. Returns 0, or an exit code with *error filled.
int cli_print_resolved(const struct cli_view *v, struct tool_error *error);
// Did the view take longer than --budget-ms?
int cli_missed_budget(const struct cli_view *v);

// Formats other than EXR are read in a sandbox. If it could not forbid everything, print on stderr what it did not.
void cli_print_sandbox(void);

#endif
