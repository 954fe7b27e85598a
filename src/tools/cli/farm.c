// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/farm.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>

enum { MAX_PARTS = 1000000 };

static int read_int(const char *text, int *value, const char **end)
{
    char *rest;
    if (!text || !isdigit((unsigned char)text[0]))
        return -1;
    errno = 0;
    const long v = strtol(text, &rest, 10);
    *end = rest;
    *value = (int)v;
    return errno || v > MAX_PARTS ? -1 : 0;
}

static int read_variable(const char *name, int *value)
{
    const char *end;
    return read_int(getenv(name), value, &end) || *end ? -1 : 0;
}

// Tasks of an array are numbered from MIN to MAX by STEP.
static int from_slurm(int *part, int *parts, struct tool_error *error)
{
    int id, first, last, step;
    if (!getenv("SLURM_ARRAY_TASK_ID"))
        return tool_fail(error, -1,
                         "--chunk auto: this is no task of a Slurm array (no SLURM_ARRAY_TASK_ID); "
                         "elsewhere give the part as --chunk 3/8");
    if (read_variable("SLURM_ARRAY_TASK_ID", &id) || read_variable("SLURM_ARRAY_TASK_MIN", &first) ||
        read_variable("SLURM_ARRAY_TASK_MAX", &last))
        return tool_fail(error, -1, "--chunk auto: SLURM_ARRAY_TASK_ID, _MIN and _MAX must be numbers");
    if (read_variable("SLURM_ARRAY_TASK_STEP", &step) || step < 1)
        step = 1;
    if (id < first || id > last || (id - first) % step)
        return tool_fail(error, -1, "--chunk auto: task %d is not one of %d to %d by %d", id, first, last, step);
    *part = (id - first) / step;
    *parts = (last - first) / step + 1;
    return 0;
}

int cli_chunk_parse(const char *text, int *part, int *parts, struct tool_error *error)
{
    const char *end;
    if (text[0] == 'a' && text[1] == 'u' && text[2] == 't' && text[3] == 'o' && !text[4])
        return from_slurm(part, parts, error);
    if (read_int(text, part, &end) || *end != '/' || read_int(end + 1, parts, &end) || *end || *part < 1 ||
        *part > *parts)
        return tool_fail(error, -1, "--chunk: '%s' is not auto or a part such as 3/8", text);
    --*part;
    return 0;
}
