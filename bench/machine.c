// SPDX-License-Identifier: BSD-3-Clause
#include "machine.h"

#include "commit.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

void bench_machine_cpu(char *name, size_t size)
{
    snprintf(name, size, "unknown CPU");
    FILE *f = fopen("/proc/cpuinfo", "r");
    if (!f)
        return;
    char line[256];
    while (fgets(line, sizeof line, f)) {
        const char *colon = strchr(line, ':');
        if (colon && !strncmp(line, "model name", 10)) {
            colon += 1 + strspn(colon + 1, " \t");
            snprintf(name, size, "%.*s", (int)strcspn(colon, "\n"), colon);
            break;
        }
    }
    fclose(f);
}

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
