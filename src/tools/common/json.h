// SPDX-License-Identifier: BSD-3-Clause
// Writes JSON: commas, indentation and escapes are its business, so that no caller can get them wrong.
#ifndef HF_TOOL_JSON_H
#define HF_TOOL_JSON_H

#include <stdio.h>

struct tool_json {
    FILE *out;
    int depth;
    int line;  // the depth from which all stands on one line
    struct {
        char kind;  // '{' or '['
        int count;  // of what is in it
    } level[16];
};

// Begin the outermost object; on_line: all of it on one line.
void tool_json_begin(struct tool_json *j, FILE *out, int on_line);
// End it, and the line.
void tool_json_end(struct tool_json *j);

// A member; in an array, name is NULL. kind is '{' or '['. A row is an object or an array that stands on one line.
void tool_json_open(struct tool_json *j, const char *name, char kind);
void tool_json_row(struct tool_json *j, const char *name, char kind);
void tool_json_close(struct tool_json *j);
// NULL is null. Bytes that are no UTF-8, which file names may hold, become U+FFFD; < is escaped, so that the whole
// may stand in a page.
void tool_json_text(struct tool_json *j, const char *name, const char *text);
// NaN and infinity are null.
void tool_json_number(struct tool_json *j, const char *name, double number);
// Milliseconds, to whole nanoseconds: rows add up in print as they do in memory.
void tool_json_ms(struct tool_json *j, const char *name, double ms);
void tool_json_count(struct tool_json *j, const char *name, long long count);
void tool_json_flag(struct tool_json *j, const char *name, int flag);
// A command line as one text, in which words that a shell would not take as they are stand in single quotes.
void tool_json_command(struct tool_json *j, const char *name, int argc, char *const *argv);
// What every report says of the run: "cpu", "version", and "options", the words of its line.
void tool_json_machine(struct tool_json *j, int count, char *const *words);

#endif
