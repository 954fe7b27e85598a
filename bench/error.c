// SPDX-License-Identifier: BSD-3-Clause
#include "error.h"

#include <stdarg.h>
#include <stdio.h>

int bench_fail(struct bench_error *error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(error->text, sizeof error->text, format, args);
    va_end(args);
    // Names may hold anything; the sentence stays one line.
    for (char *c = error->text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127)
            *c = '?';
    return -1;
}
