// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_JSON_H
#define HF_CLI_JSON_H

#include "cli/frame.h"

#include <stdio.h>

// A text with quotes, null for NULL; a number, null for NaN and infinity.
void cli_json_text(FILE *out, const char *text);
void cli_json_number(FILE *out, double number);
// The command line as one text, in which words that a shell would not take as they are stand in single quotes.
void cli_json_command(FILE *out, int argc, char **argv);

// One JSON object about a frame: what was asked for, what was done, how long it took. Of a --dry-run the first only.
void cli_write_json(FILE *out, int argc, char **argv, const struct cli_frame *frame, const struct hf_context *context);

// The same into args->json_file, through a temporary file; a device is written where it is. 0, or an exit code.
int cli_write_json_file(int argc, char **argv, const struct cli_frame *frame, const struct hf_context *context,
                        struct cli_error *error);

#endif
