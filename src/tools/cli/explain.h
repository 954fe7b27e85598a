// SPDX-License-Identifier: BSD-3-Clause
// --explain: what a frame called for, as a table.
#ifndef HF_CLI_EXPLAIN_H
#define HF_CLI_EXPLAIN_H

#include <stdio.h>

#include "tools/cli/frame.h"

// Keep a context's report with its view, tiles included, which the context overwrites. 0, or an exit code.
int cli_explain_keep(struct cli_view *v, struct hf_context *context, struct tool_error *error);

// Of the engine in use; full where it has none to choose.
enum hf_resolution cli_explain_resolution(const struct hf_params *params);

// The table of all views. ran: frames were rendered, not only planned.
void cli_explain_print(FILE *out, const struct cli_frame *frame, int ran);

#endif
