// SPDX-License-Identifier: BSD-3-Clause
// --explain: which passes a frame needed, and why, as a table.
#ifndef HF_CLI_EXPLAIN_H
#define HF_CLI_EXPLAIN_H

#include <stdio.h>

#include "tools/cli/frame.h"

// Copy a context's report and its tiles to the view, as the context overwrites them. Returns 0, or an exit code.
int cli_explain_keep(struct cli_view *v, struct hf_context *context, struct tool_error *error);

// The resolution that the engine uses: its option, or full if it has no such option.
enum hf_resolution cli_explain_resolution(const struct hf_params *params);

// Print the table of all views. ran: the frame was rendered, not only planned.
void cli_explain_print(FILE *out, const struct cli_frame *frame, int ran);

#endif
