// SPDX-License-Identifier: BSD-3-Clause
// Checks of single arguments, and the sentences that report a failure.
#ifndef HF_CHECK_H
#define HF_CHECK_H

#include "hyperfocal/hyperfocal.h"

enum { HF_MESSAGE = 256, HF_MAX_SIZE = 65536 };  // bytes of a sentence; pixels of a side

// Let the compiler check formats as those of C11's printf. mingw has that printf because of _GNU_SOURCE, but its gcc
// takes the name printf for Microsoft's.
#ifdef __MINGW32__
#define HF_PRINTF(format_at, first) __attribute__((format(gnu_printf, format_at, first)))
#else
#define HF_PRINTF(format_at, first) __attribute__((format(printf, format_at, first)))
#endif

// Write a sentence into message, which has HF_MESSAGE bytes, as in all these functions. Returns HF_ERR_ARG.
int hf_bad(char *message, const char *format, ...) HF_PRINTF(2, 3);

// Return HF_OK, or HF_ERR_ARG with one sentence that names the argument and its value.
int hf_check_between(const char *name, float value, float least, float most, char *message);
// engine: its name, which its parameters' names begin with.
int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest, char *message);

#endif
