// SPDX-License-Identifier: BSD-3-Clause
#include "pass/check.h"

#include <stdio.h>
#include <string.h>

void hf_message_write(struct hf_message *message, const char *argument, const char *format, va_list args)
{
    size_t used = 0;
    message->argument[0] = '\0';
    if (argument) {
        snprintf(message->argument, sizeof message->argument, "%s", argument);
        snprintf(message->sentence, sizeof message->sentence, "%s ", message->argument);
        used = strlen(message->sentence);
    }
    vsnprintf(message->sentence + used, sizeof message->sentence - used, format, args);
}

int hf_bad(struct hf_message *message, const char *argument, const char *format, ...)
{
    *message = (struct hf_message){.size = sizeof *message, .level = HF_LOG_ERROR, .error = HF_ERR_ARG};
    va_list args;
    va_start(args, format);
    hf_message_write(message, argument, format, args);
    va_end(args);
    return HF_ERR_ARG;
}

int hf_check_between(const char *argument, float value, float least, float most, struct hf_message *message)
{
    return value >= least && value <= most
               ? HF_OK
               : hf_bad(message, argument, "is %g; it must be %g to %g", value, least, most);
}

int hf_check_value(const char *argument, int value, int first, int last, struct hf_message *message)
{
    return value >= first && value <= last
               ? HF_OK
               : hf_bad(message, argument, "is %d: no such value (%d to %d)", value, first, last);
}

int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest,
                        struct hf_message *message)
{
    char argument[64];
    snprintf(argument, sizeof argument, "%s.resolution", engine);
    return (int)resolution >= 0 && resolution <= smallest
               ? HF_OK
               : hf_bad(message, argument, "is %d, which the %s engine does not have (0 to %d)", (int)resolution,
                        engine, (int)smallest);
}
