// SPDX-License-Identifier: BSD-3-Clause
// Checks of one argument each, and the sentence of one that fails.
#ifndef HF_CHECK_H
#define HF_CHECK_H

#include "hyperfocal/hyperfocal.h"

enum { HF_MESSAGE = 256, HF_MAX_SIZE = 65536 };  // bytes of a sentence, pixels of a side

// The compiler checks formats as those of C11's printf. mingw's has that since _GNU_SOURCE asks for it, but gcc there takes
// the name for Microsoft's.
#ifdef __MINGW32__
#define HF_PRINTF(format_at, first) __attribute__((format(gnu_printf, format_at, first)))
#else
#define HF_PRINTF(format_at, first) __attribute__((format(printf, format_at, first)))
#endif

// Put a sentence into message, which holds HF_MESSAGE bytes as all of these do. Returns HF_ERR_ARG.
int hf_bad(char *message, const char *format, ...) HF_PRINTF(2, 3);

// Return HF_OK, or HF_ERR_ARG with one sentence that names argument and value.
int hf_check_between(const char *name, float value, float least, float most, char *message);
// engine: its name, which is that of its parameters.
int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest, char *message);

#endif
