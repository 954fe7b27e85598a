// SPDX-License-Identifier: BSD-3-Clause
#include "tools/common/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hyperfocal/hyperfocal.h"
#include "tools/common/machine.h"

// The length of the UTF-8 sequence at s, 0 if it is invalid: file names may contain any bytes.
static int utf8_length(const unsigned char *s)
{
    const int n = s[0] < 0x80                   ? 1
                  : s[0] >= 0xc2 && s[0] < 0xe0 ? 2
                  : s[0] >= 0xe0 && s[0] < 0xf0 ? 3
                  : s[0] >= 0xf0 && s[0] < 0xf5 ? 4
                                                : 0;
    for (int i = 1; i < n; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    // Overlong forms, surrogates, and code points beyond the last.
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] >= 0xa0) || (s[0] == 0xf0 && s[1] < 0x90) ||
        (s[0] == 0xf4 && s[1] >= 0x90))
        return 0;
    return n;
}

static void put_escaped(FILE *out, const char *text, size_t length)
{
    const unsigned char *s = (const unsigned char *)text, *end = s + length;
    while (s < end) {
        const int n = utf8_length(s);
        if (*s == '"' || *s == '\\')
            fprintf(out, "\\%c", *s);
        else if (*s < 0x20 || *s == '<')
            fprintf(out, "\\u%04x", *s);
        else if (n)
            fwrite(s, 1, (size_t)n, out);
        else
            fputs("\\ufffd", out);
        s += n ? n : 1;
    }
}

static void new_line(struct tool_json *j)
{
    if (j->depth >= j->line)
        return;
    fprintf(j->out, "\n%*s", 2 * j->depth, "");
}

// Write what precedes a member: a comma, a line break, its name.
static void begin_member(struct tool_json *j, const char *name)
{
    const int first = j->level[j->depth].count++ == 0;
    if (!first)
        fputs(j->depth >= j->line ? ", " : ",", j->out);
    new_line(j);
    if (name)
        fprintf(j->out, "\"%s\": ", name);
}

static void push(struct tool_json *j, char kind)
{
    putc(kind, j->out);
    j->depth++;
    j->level[j->depth].kind = kind;
    j->level[j->depth].count = 0;
}

void tool_json_begin(struct tool_json *j, FILE *out, int on_line)
{
    *j = (struct tool_json){.out = out, .line = on_line ? 0 : 1 << 20};
    push(j, '{');
}

void tool_json_end(struct tool_json *j)
{
    while (j->depth > 0)
        tool_json_close(j);
    putc('\n', j->out);
}

void tool_json_open(struct tool_json *j, const char *name, char kind)
{
    begin_member(j, name);
    push(j, kind);
}

void tool_json_row(struct tool_json *j, const char *name, char kind)
{
    tool_json_open(j, name, kind);
    if (j->depth < j->line)
        j->line = j->depth;
}

void tool_json_close(struct tool_json *j)
{
    const int was_row = j->line == j->depth;
    const char kind = j->level[j->depth].kind;
    const int empty = j->level[j->depth].count == 0, on_line = j->depth >= j->line;
    j->depth--;
    if (!on_line && !empty)
        new_line(j);
    putc(kind == '{' ? '}' : ']', j->out);
    if (was_row)
        j->line = 1 << 20;
}

void tool_json_text(struct tool_json *j, const char *name, const char *text)
{
    begin_member(j, name);
    if (!text) {
        fputs("null", j->out);
        return;
    }
    putc('"', j->out);
    put_escaped(j->out, text, strlen(text));
    putc('"', j->out);
}

void tool_json_number(struct tool_json *j, const char *name, double number)
{
    begin_member(j, name);
    // A number that was a float gets only the digits needed to read it back: 0.8, not 0.800000012.
    int digits = (double)(float)number == number ? 6 : 9;
    char text[40] = "null";
    do {
        if (isfinite(number))
            snprintf(text, sizeof(text), "%.*g", digits, number);
    } while (isfinite(number) && digits++ < 9 && (float)strtod(text, NULL) != (float)number);
    fputs(text, j->out);
}

void tool_json_ms(struct tool_json *j, const char *name, double ms)
{
    begin_member(j, name);
    if (isfinite(ms))
        fprintf(j->out, "%.6f", ms);
    else
        fputs("null", j->out);
}

void tool_json_count(struct tool_json *j, const char *name, long long count)
{
    begin_member(j, name);
    fprintf(j->out, "%lld", count);
}

void tool_json_flag(struct tool_json *j, const char *name, int flag)
{
    begin_member(j, name);
    fputs(flag ? "true" : "false", j->out);
}

void tool_json_command(struct tool_json *j, const char *name, int argc, char *const *argv)
{
    begin_member(j, name);
    putc('"', j->out);
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        const int quote = !*word || word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                                      "-_=+.,:/@%")];
        fputs(i ? " " : "", j->out);
        fputs(quote ? "'" : "", j->out);
        for (const char *part = word;; part++) {
            const size_t n = strcspn(part, "'");
            put_escaped(j->out, part, n);
            part += n;
            if (!*part)
                break;
            fputs("'\\\\''", j->out);
        }
        fputs(quote ? "'" : "", j->out);
    }
    putc('"', j->out);
}

void tool_json_machine(struct tool_json *j, int count, char *const *words)
{
    char cpu[128];
    tool_cpu(cpu, sizeof(cpu));
    tool_json_text(j, "cpu", cpu);
    tool_json_text(j, "version", hf_version());
    tool_json_row(j, "options", '[');
    for (int i = 0; i < count; i++)
        tool_json_text(j, NULL, words[i]);
    tool_json_close(j);
}
