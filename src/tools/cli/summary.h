// SPDX-License-Identifier: BSD-3-Clause
// What was done with a view, in words: a line on stderr, and what it comes to in a dry run.
#ifndef HF_CLI_SUMMARY_H
#define HF_CLI_SUMMARY_H

#include "tools/cli/frame.h"

// 1 if radii of the lens or of a coc depth were cut to the largest that there may be.
int cli_is_limited(const struct cli_view *v);

// A line on stderr for each view: with --verbose, or on a terminal unless --quiet.
void cli_print_summary(const struct cli_frame *frame, int warnings);

// What the library makes of a view's settings, to stdout. Returns 0, or an exit code with *error filled.
int cli_print_resolved(const struct cli_view *v, struct tool_error *error);
// Did the view take longer than --budget-ms?
int cli_missed_budget(const struct cli_view *v);

// On stderr, in a line: what the sandbox in which formats other than EXR were read did not forbid, if anything.
void cli_print_sandbox(void);

#endif
