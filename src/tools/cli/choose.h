// SPDX-License-Identifier: BSD-3-Clause
// --quality and --max-error: the engine and its knobs, from the library's ladder of measured settings.
#ifndef HF_CLI_CHOOSE_H
#define HF_CLI_CHOOSE_H

#include <stdio.h>

#include "tools/cli/setup.h"
#include "tools/common/json.h"

// The options that a number of enum hf_quality chooses for blur of 12 pixels at 1080 lines, as words.
const char *cli_quality_words(int quality);
// What cannot be given together with them. Returns 0, or -1 with *error filled.
int cli_choose_check(const struct cli_args *args, const struct tool_parser *p, struct tool_error *error);
// Choose for a view whose model, depth and size are known; does nothing if neither was given.
void cli_choose(struct cli_setup *setup, const struct cli_args *args);
// The option that chose, with its value.
struct cli_word {
    char text[40];
};
struct cli_word cli_choice_option(const struct cli_args *args);
// What was chosen and why, what it is expected to cost and err, and whence that is known. Nothing if nothing was chosen.
void cli_choose_print(FILE *out, const struct cli_args *args, const struct cli_setup *setup, double megapixels);
void cli_choose_json(struct tool_json *j, const struct cli_setup *setup, double megapixels);

#endif
