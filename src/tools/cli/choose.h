// SPDX-License-Identifier: BSD-3-Clause
// --quality and --max-error: the engine and its knobs, from the library's ladder of measured settings.
#ifndef HF_CLI_CHOOSE_H
#define HF_CLI_CHOOSE_H

#include <stdio.h>

#include "tools/cli/setup.h"
#include "tools/common/json.h"

// The options that a word of --quality, by its number in the help, chooses for blur of 12 pixels at 1080 lines, as words.
const char *cli_quality_words(int word);
// Refuse options that cannot be combined with --quality or --max-error. Returns 0, or -1 with *error filled.
int cli_choose_check(const struct cli_args *args, const struct tool_parser *p, struct tool_error *error);
// Choose the settings of a view whose model, depth and size are known. Does nothing without --quality and --max-error.
void cli_choose(struct cli_setup *setup, const struct cli_args *args);
// --quality or --max-error, whichever was given, with its value.
struct cli_word {
    char text[40];
};
struct cli_word cli_choice_option(const struct cli_args *args);
// Print the chosen settings, the reason, their expected time and error, and where these were measured. Prints nothing
// if nothing was chosen.
void cli_choose_print(FILE *out, const struct cli_args *args, const struct cli_setup *setup, double megapixels);
void cli_choose_json(struct tool_json *j, const struct cli_setup *setup, double megapixels);

#endif
