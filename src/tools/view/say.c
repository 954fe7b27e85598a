// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/say.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void view_say(const char *format, ...)
{
    va_list values;
    if (!getenv("HYPERFOCAL_VIEW_SAY"))
        return;
    va_start(values, format);
    vprintf(format, values);
    va_end(values);
    putchar('\n');
    fflush(stdout);
}
