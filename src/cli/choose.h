// SPDX-License-Identifier: BSD-3-Clause
// --quality and --max-error: the engine and its knobs, from the library's ladder of measured settings.
#ifndef HF_CLI_CHOOSE_H
#define HF_CLI_CHOOSE_H

#include <stdio.h>

#include "cli/args.h"
#include "tool/json.h"

// Choose, once all options are known; does nothing if neither was given. Returns 0, or -1 with *error filled.
int cli_choose(struct cli_args *args, const struct tool_parser *p, struct tool_error *error);
// What was chosen, what it is expected to cost and err, and whence that is known. Nothing if nothing was asked for.
void cli_choose_print(FILE *out, const struct cli_args *args, double megapixels);
void cli_choose_json(struct tool_json *j, const struct cli_args *args, double megapixels);

#endif
