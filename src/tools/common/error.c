// SPDX-License-Identifier: BSD-3-Clause
#include "tools/common/error.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *tool_program = "hyperfocal";
atomic_int tool_bar_shown;

int tool_fail(struct tool_error *error, int code, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(error->text, sizeof(error->text), format, list);
    va_end(list);
    return code;
}

// Replace control characters: those of ASCII, and U+0080 to U+009F in UTF-8, which some terminals obey too.
static void hide_controls(char *text)
{
    for (unsigned char *c = (unsigned char *)text; *c; c++) {
        if (*c < 0x20 || *c == 0x7f)
            *c = '?';
        if (c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)
            c[0] = c[1] = '?';
    }
}

const char *tool_shown(const char *text, char buf[TOOL_SHOWN])
{
    snprintf(buf, TOOL_SHOWN, "%s", text);
    hide_controls(buf);
    return buf;
}

void tool_print_line(const char *format, ...)
{
    char line[sizeof(((struct tool_error *)0)->text)];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof(line), format, list);
    va_end(list);
    hide_controls(line);
    fprintf(stderr, "%s%s: %s\n", atomic_exchange(&tool_bar_shown, 0) ? "\r\033[K" : "", tool_program, line);
}

int tool_end(int status, int unwritten, struct tool_error *error)
{
    const int failed = ferror(stdout);
    if ((fflush(stdout) || failed) && !status)
        status = tool_fail(error, unwritten, "standard output could not be written: %s", strerror(errno));
    if (status && error->text[0])
        tool_print_line("%s", error->text);
    return status;
}
