// SPDX-License-Identifier: BSD-3-Clause
// Writes JSON. It makes the commas, indentation and escapes, so no caller can get them wrong.
#ifndef HF_TOOL_JSON_H
#define HF_TOOL_JSON_H

#include <stdio.h>

struct tool_json {
    FILE *out;
    int depth;
    int line;  // from this depth on everything is on one line
    struct {
        char kind;  // '{' or '['
        int count;  // of members
    } level[16];
};

// Begin the outermost object. on_line: all of it on one line.
void tool_json_begin(struct tool_json *j, FILE *out, int on_line);
// End it, and the line.
void tool_json_end(struct tool_json *j);

// Open a member; in an array, name is NULL. kind is '{' or '['. A row is an object or an array on one line.
void tool_json_open(struct tool_json *j, const char *name, char kind);
void tool_json_row(struct tool_json *j, const char *name, char kind);
void tool_json_close(struct tool_json *j);
// NULL is written as null. Bytes that are not UTF-8, which file names may contain, become U+FFFD. < is escaped, so that
// the JSON may be embedded in a web page.
void tool_json_text(struct tool_json *j, const char *name, const char *text);
// NaN and infinity are null.
void tool_json_number(struct tool_json *j, const char *name, double number);
// Milliseconds rounded to whole nanoseconds, so that printed rows add up exactly.
void tool_json_ms(struct tool_json *j, const char *name, double ms);
void tool_json_count(struct tool_json *j, const char *name, long long count);
void tool_json_flag(struct tool_json *j, const char *name, int flag);
// A command line as one text; words that a shell would change are put in single quotes.
void tool_json_command(struct tool_json *j, const char *name, int argc, char *const *argv);
// What every report says about the run: "cpu", "version", and "options", the words of its command line.
void tool_json_machine(struct tool_json *j, int count, char *const *words);

#endif
