// SPDX-License-Identifier: BSD-3-Clause
// --guessed: how much of a picture's light rests on guesses, where they lie, and what would show what they stand for.
#ifndef HF_CLI_GUESSED_H
#define HF_CLI_GUESSED_H

#include "tools/cli/frame.h"
#include "tools/common/json.h"

// Find v->guess and v->guesses before the view is rendered, and write --guessed-image. image: the view's colour. Returns 0, or an
// exit code with *error filled.
int cli_guessed_find(struct cli_session *session, const struct cli_frame *frame, struct cli_view *v,
                     const struct hf_image *image, struct tool_error *error);
// "9 % of the picture rests on guesses; overscan of 40 pixels or a second layer would help". about: what is said of it after
// the number, or "". Returns text.
const char *cli_guessed_sentence(const struct cli_guess *g, const char *about, char *text, size_t size);
// Print that about each view of a frame, if it was asked for.
void cli_guessed_print(const struct cli_frame *frame);
// Write it as members of a JSON object.
void cli_guessed_json(struct tool_json *j, const struct cli_frame *frame, const struct cli_view *v);

#endif
