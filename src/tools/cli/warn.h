// SPDX-License-Identifier: BSD-3-Clause
// What may be wrong with a frame but does not stop the work. Each thing is counted where its sentence is made, so that
// there are as many sentences as are counted.
#ifndef HF_CLI_WARN_H
#define HF_CLI_WARN_H

#include "tools/cli/frame.h"
#include "tools/common/json.h"

// How many warnings a view's picture has, those of the library included.
int cli_warnings_of(const struct cli_frame *frame, const struct cli_view *v);
// The same of a frame, each said on stderr (the library's have been), and what was lost in writing it.
int cli_print_warnings(const struct cli_frame *frame);
// The sentences of a frame, those of the library included, as an array. After a dry run they are those that planning knows.
void cli_json_warnings(struct tool_json *j, const struct cli_frame *frame);

#endif
