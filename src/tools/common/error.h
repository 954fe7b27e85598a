// SPDX-License-Identifier: BSD-3-Clause
// One error is one sentence: functions fill it in, main prints it.
#ifndef HF_TOOL_ERROR_H
#define HF_TOOL_ERROR_H

#include <stdatomic.h>
#include <stddef.h>

struct tool_error {
    char text[4096];
};

// Sets the sentence and returns code, so that a caller can `return tool_fail(...)`.
int tool_fail(struct tool_error *error, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));

enum { TOOL_SHOWN = 1024 };
// A name as it may be shown on a terminal: control characters become '?'. Returns buf.
const char *tool_shown(const char *text, char buf[TOOL_SHOWN]);

// The program's name, with which its messages begin; main may set it.
extern const char *tool_program;

// "PROGRAM: TEXT" as one line on stderr; control characters, which names may hold, are shown as '?'.
void tool_print_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

// The end of a main: what was printed to stdout is written out, and the error's sentence follows if there is one. Returns the
// program's exit status: the given one, or unwritten if that is 0 and stdout could not be written.
int tool_end(int status, int unwritten, struct tool_error *error);

// Set while a progress bar stands on the terminal's line; the next message replaces the bar.
extern atomic_int tool_bar_shown;

#endif
