// SPDX-License-Identifier: BSD-3-Clause
#include "cli/error.h"

#include <stdarg.h>
#include <stdio.h>

atomic_int cli_bar_shown;

int cli_fail(struct cli_error *error, int code, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(error->text, sizeof(error->text), format, list);
    va_end(list);
    return code;
}

static void hide_controls(char *text)
{
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
}

const char *cli_shown(const char *text, char buf[CLI_SHOWN])
{
    snprintf(buf, CLI_SHOWN, "%s", text);
    hide_controls(buf);
    return buf;
}

void cli_print_line(const char *format, ...)
{
    char line[sizeof(((struct cli_error *)0)->text)];
    va_list list;
    va_start(list, format);
    vsnprintf(line, sizeof(line), format, list);
    va_end(list);
    hide_controls(line);
    fprintf(stderr, "%shyperfocal: %s\n", atomic_exchange(&cli_bar_shown, 0) ? "\r\033[K" : "", line);
}
