// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_JSON_H
#define HF_CLI_JSON_H

#include "tools/cli/frame.h"

#include <stdio.h>

#include "tools/common/json.h"

// Of a view's depth file: "depth_sharpened", samples, when it has whole numbers or some were; "depth_smoothed", when some
// were; "depth_scaled_from", width and height, when it was.
void cli_json_map(struct tool_json *j, const struct cli_view *v);

// One JSON object about a frame: what was asked for, what was done, how long it took. Of a --dry-run the first only.
void cli_write_json(FILE *out, int argc, char **argv, const struct cli_frame *frame, struct hf_context *context);

// The same into args->json_file, through a temporary file; a device is written where it is. 0, or an exit code.
int cli_write_json_file(int argc, char **argv, const struct cli_frame *frame, struct hf_context *context,
                        struct tool_error *error);

#endif
