// SPDX-License-Identifier: BSD-3-Clause
// What a report says about the build and the date.
#ifndef HF_BENCH_MACHINE_H
#define HF_BENCH_MACHINE_H

#include <stddef.h>

// "2026-11-21"
void bench_machine_date(char *date, size_t size);
// The commit that was built, with -dirty if the sources differed from it; "unknown" outside a repository.
const char *bench_machine_commit(void);

#endif
