// SPDX-License-Identifier: BSD-3-Clause
// What a report says of the build and the day.
#ifndef HF_BENCH_MACHINE_H
#define HF_BENCH_MACHINE_H

#include <stddef.h>

// "2026-11-21"
void bench_machine_date(char *date, size_t size);
// The commit that was built, with -dirty if the sources were not as committed; "unknown" outside a repository.
const char *bench_machine_commit(void);

#endif
