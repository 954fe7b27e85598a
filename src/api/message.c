// SPDX-License-Identifier: BSD-3-Clause
#include "api/message.h"

static void send(const struct hf_config *config, struct hf_message *message, const char *argument, const char *format,
                 va_list args)
{
    message->size = sizeof *message;
    hf_message_write(message, argument, format, args);
    if (config->log)
        config->log(config->log_cookie, message);
}

void hf_say(const struct hf_config *config, enum hf_log_level level, const char *argument, const char *format, ...)
{
    struct hf_message message = {.level = level};
    va_list args;
    va_start(args, format);
    send(config, &message, argument, format, args);
    va_end(args);
}

void hf_say_error(const struct hf_config *config, int error, const char *argument, const char *format, ...)
{
    struct hf_message message = {.level = HF_LOG_ERROR, .error = error};
    va_list args;
    va_start(args, format);
    send(config, &message, argument, format, args);
    va_end(args);
}

int hf_fail(struct hf_context *c, const struct hf_message *message)
{
    c->problem = *message;
    if (c->config.log)
        c->config.log(c->config.log_cookie, message);
    return message->error;
}
