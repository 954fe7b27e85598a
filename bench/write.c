// SPDX-License-Identifier: BSD-3-Clause
#include "write.h"

#include <errno.h>
#include <string.h>

void bench_json_begin(struct tool_json *j, FILE *out, const char *command, const struct bench_args *args)
{
    tool_json_begin(j, out, 0);
    tool_json_text(j, "command", command);
    tool_json_machine(j, args->word_count, args->words);
}

int bench_write_report(const struct bench_args *args, void (*table)(FILE *out, const void *what),
                       void (*json)(FILE *out, const void *what), const void *what, struct tool_error *error)
{
    const char *path = args->json;
    const int to_stdout = path && !strcmp(path, "-");
    (to_stdout ? json : table)(stdout, what);
    if (fflush(stdout))
        return tool_fail(error, -1, "cannot write to stdout: %s", strerror(errno));
    if (!path || to_stdout)
        return 0;
    FILE *f = fopen(path, "w");
    if (!f)
        return tool_fail(error, -1, "cannot write %s: %s", path, strerror(errno));
    json(f, what);
    const int failed = ferror(f);
    if (fclose(f) || failed)
        return tool_fail(error, -1, "cannot write %s: %s", path, strerror(errno));
    return 0;
}
