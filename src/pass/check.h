// SPDX-License-Identifier: BSD-3-Clause
// Checks of one argument each, and the sentence of one that fails.
#ifndef HF_CHECK_H
#define HF_CHECK_H

#include <stdarg.h>

#include "hyperfocal/hyperfocal.h"

enum { HF_MAX_SIZE = 65536 };  // pixels of a side

// The compiler checks formats as those of C11's printf. mingw's has that since _GNU_SOURCE asks for it, but gcc there takes
// the name for Microsoft's.
#ifdef __MINGW32__
#define HF_PRINTF(format_at, first) __attribute__((format(gnu_printf, format_at, first)))
#else
#define HF_PRINTF(format_at, first) __attribute__((format(printf, format_at, first)))
#endif

// Fill the texts of *message: argument is its name in C, or NULL, and format the rest of the sentence: "is %d; ...".
void hf_message_write(struct hf_message *message, const char *argument, const char *format, va_list args);

// Fill *message with an error about an argument. Returns HF_ERR_ARG.
int hf_bad(struct hf_message *message, const char *argument, const char *format, ...) HF_PRINTF(3, 4);

// Return HF_OK, or HF_ERR_ARG with the message filled.
int hf_check_between(const char *argument, float value, float least, float most, struct hf_message *message);
// An enumerator, first to last.
int hf_check_value(const char *argument, int value, int first, int last, struct hf_message *message);
// engine: its name, which is that of its parameters.
int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest,
                        struct hf_message *message);

#endif
