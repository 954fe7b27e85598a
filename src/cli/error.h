// SPDX-License-Identifier: BSD-3-Clause
// One error, one sentence: functions fill it, main prints it.
#ifndef HF_CLI_ERROR_H
#define HF_CLI_ERROR_H

#include <stdatomic.h>
#include <stddef.h>

struct cli_error {
    char text[4096];
};

// Sets the sentence and returns code, so that a caller can `return cli_fail(...)`.
int cli_fail(struct cli_error *error, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));

enum { CLI_SHOWN = 1024 };
// A name as it may be shown on a terminal: control characters become '?'. Returns buf.
const char *cli_shown(const char *text, char buf[CLI_SHOWN]);

// "hyperfocal: TEXT" as one line on stderr; control characters, which names may hold, are shown as '?'.
void cli_print_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

// Set while a progress bar is on the terminal's line: what is printed next takes its place.
extern atomic_int cli_bar_shown;

#endif
