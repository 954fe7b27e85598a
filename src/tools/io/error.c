// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/error.h"

#include <stdarg.h>
#include <stdio.h>

int hf_io_fail(struct hf_io_error *err, const char *format, ...)
{
    va_list args;
    if (!err)
        return -1;
    err->may_pass = 0;
    va_start(args, format);
    vsnprintf(err->message, sizeof(err->message), format, args);
    va_end(args);
    for (char *p = err->message; *p; p++)
        if (*p == '\n' || *p == '\r')  // some libraries end their messages with a line break
            *p = p[1] ? ' ' : 0;
        else if ((unsigned char)*p < 0x20 || *p == 0x7f)
            *p = '?';
    return -1;
}

int hf_io_may_pass(struct hf_io_error *err)
{
    if (err)
        err->may_pass = 1;
    return -1;
}
