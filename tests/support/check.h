// SPDX-License-Identifier: BSD-3-Clause
// Counting checks for the test programs. A failure prints its place and message, and the program goes on; main ends
// with `return check_report();`. Exit status: 0 all passed; 1 some failed or nothing was checked; 77 the test could not
// run (meson: skipped).
#ifndef HF_TESTS_CHECK_H
#define HF_TESTS_CHECK_H

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

enum { CHECK_SKIP = 77, CHECK_PRINTED = 40 };

// One pair of counters for all files of a program.
__attribute__((weak)) atomic_int check_passed, check_failed;

// One check from any thread. The message is printed for the first CHECK_PRINTED failures only.
__attribute__((format(printf, 4, 5))) static inline int check_that(int ok, const char *file, int line,
                                                                   const char *format, ...)
{
    if (ok) {
        atomic_fetch_add(&check_passed, 1);
        return 1;
    }
    if (atomic_fetch_add(&check_failed, 1) < CHECK_PRINTED) {
        va_list args;
        va_start(args, format);
        fprintf(stderr, "%s:%d: ", file, line);
        vfprintf(stderr, format, args);
        fputc('\n', stderr);
        va_end(args);
    }
    return 0;
}

// Check a condition, optionally with a printf message that gives the values.
#define CHECK(ok) check_that((ok) != 0, __FILE__, __LINE__, "%s", #ok)
#define CHECK_MSG(ok, ...) check_that((ok) != 0, __FILE__, __LINE__, __VA_ARGS__)
#define CHECK_INT(got, want) check_int((long long)(got), (long long)(want), __FILE__, __LINE__, #got)

static inline int check_int(long long got, long long want, const char *file, int line, const char *what)
{
    return check_that(got == want, file, line, "%s is %lld, expected %lld", what, got, want);
}

// Tests with many cases usually try a fixed selection; with HF_LONG in the environment they try all.
static inline int check_long(void)
{
    return getenv("HF_LONG") != NULL;
}

static inline int check_report(void)
{
    const int failed = atomic_load(&check_failed);
    if (failed > CHECK_PRINTED)
        fprintf(stderr, "(%d more failures not printed)\n", failed - CHECK_PRINTED);
    const int passed = atomic_load(&check_passed);
    if (!passed && !failed)
        fprintf(stderr, "nothing was checked\n");
    printf("%d passed, %d failed\n", passed, failed);
    return failed || !passed ? 1 : 0;
}

#endif
