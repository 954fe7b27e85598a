// SPDX-License-Identifier: BSD-3-Clause
// One error, one sentence: functions fill it, main prints it.
#ifndef HF_BENCH_ERROR_H
#define HF_BENCH_ERROR_H

struct bench_error {
    char text[1024];
};

// Sets the sentence and returns -1, so that a caller can `return bench_fail(...)`.
int bench_fail(struct bench_error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
