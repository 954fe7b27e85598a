// SPDX-License-Identifier: BSD-3-Clause
// Warnings: what may be wrong with a frame but does not stop the work. The function that makes a sentence also counts
// it, so the count and the sentences agree.
#ifndef HF_CLI_WARN_H
#define HF_CLI_WARN_H

#include "tools/cli/frame.h"
#include "tools/common/json.h"

// How many warnings a view's picture has, those of the library included.
int cli_warnings_of(const struct cli_frame *frame, const struct cli_view *v);
// Print all warnings of a frame on stderr, except the library's, which are there already, and note what the output
// format lost. Returns how many there are, the library's included.
int cli_print_warnings(const struct cli_frame *frame);
// Write the warnings of a frame, the library's included, as an array. After a dry run they are those that planning
// finds.
void cli_json_warnings(struct tool_json *j, const struct cli_frame *frame);

#endif
