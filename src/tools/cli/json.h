// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_JSON_H
#define HF_CLI_JSON_H

#include "tools/cli/frame.h"

#include <stdio.h>

#include "tools/common/json.h"

// Write "surfaces", the names of the further pictures of a view's scene, if there are some.
void cli_json_surfaces(struct tool_json *j, const struct cli_view *v);

// Write what was done to a view's depth file: "depth_sharpened", samples, if it has whole numbers or any were
// sharpened; "depth_smoothed", if any were; "depth_scaled_from", width and height, if it was scaled.
void cli_json_map(struct tool_json *j, const struct cli_view *v);

// Write one JSON object about a frame: what was asked for, what was done, how long it took. A --dry-run has only the
// first of these.
void cli_write_json(FILE *out, int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session);

// The same into args->json_file, through a temporary file unless it is a device. Returns 0, or an exit code.
int cli_write_json_file(int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session,
                        struct tool_error *error);

#endif
