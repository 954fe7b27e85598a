// SPDX-License-Identifier: BSD-3-Clause
#include "pass/check.h"

#include <stdarg.h>
#include <stdio.h>

int hf_bad(char *message, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(message, HF_MESSAGE, format, args);
    va_end(args);
    return HF_ERR_ARG;
}

int hf_check_between(const char *name, float value, float least, float most, char *message)
{
    return value >= least && value <= most ? HF_OK
                                           : hf_bad(message, "%s is %g; it must be %g to %g", name, value, least, most);
}

int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest, char *message)
{
    return (unsigned)resolution <= (unsigned)smallest
               ? HF_OK
               : hf_bad(message, "%s.resolution is %d, which the %s engine does not have", engine, (int)resolution,
                        engine);
}
