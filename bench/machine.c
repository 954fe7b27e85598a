// SPDX-License-Identifier: BSD-3-Clause
#include "machine.h"

#include "commit.h"

#include <stdio.h>
#include <time.h>

void bench_machine_date(char *date, size_t size)
{
    const time_t now = time(NULL);
    struct tm tm;
    if (!gmtime_r(&now, &tm) || !strftime(date, size, "%Y-%m-%d", &tm))
        snprintf(date, size, "unknown day");
}

const char *bench_machine_commit(void)
{
    return HF_BENCH_COMMIT;
}
