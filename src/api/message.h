// SPDX-License-Identifier: BSD-3-Clause
// What the library says: to the log, and to who asks why a call failed.
#ifndef HF_MESSAGE_H
#define HF_MESSAGE_H

#include "frame/context.h"

// Log a warning or a note; argument may be NULL (pass/check.h).
void hf_say(const struct hf_config *config, enum hf_log_level level, const char *argument, const char *format, ...)
    HF_PRINTF(4, 5);
// Log an error.
void hf_say_error(const struct hf_config *config, int error, const char *argument, const char *format, ...)
    HF_PRINTF(4, 5);
// Log why a call fails, and keep it for hf_get_problem. Returns message->error.
int hf_fail(struct hf_context *c, const struct hf_message *message);

#endif
