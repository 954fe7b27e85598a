// SPDX-License-Identifier: BSD-3-Clause
// Numerical stability: runs the cases of tests/stability and prints a table.
#include "commands.h"
#include "write.h"

#include "stability/stability.h"

static void count_failed(void *cookie, const struct stability_row *row)
{
    *(int *)cookie += !row->within;
}

static void table(FILE *out, const void *args)
{
    (void)args;
    const int failed = stability_print(out);
    fprintf(out, "\n%d rows keep their bounds, %d fail\n", stability_passed(), failed);
}

static void json_row(void *cookie, const struct stability_row *row)
{
    struct tool_json *j = cookie;
    tool_json_row(j, NULL, '{');
    tool_json_text(j, "subject", row->subject);
    tool_json_text(j, "case", row->what);
    tool_json_text(j, "bound_from", row->why);
    tool_json_number(j, "value", row->value);
    tool_json_number(j, "bound", row->bound);
    tool_json_text(j, "where", row->where);
    tool_json_flag(j, "within", row->within);
    tool_json_close(j);
}

static void json(FILE *out, const void *args)
{
    struct tool_json j;
    bench_json_begin(&j, out, "stability", args);
    tool_json_open(&j, "rows", '[');
    stability_each(json_row, &j);
    tool_json_end(&j);
}

int bench_stability(struct bench_args *args, struct tool_error *error)
{
    const struct stability_options o = {.engine = args->engine_given ? hf_engine_name(args->params.engine) : NULL,
                                        .isa = args->isa,
                                        .full = args->full,
                                        .seed = 1};
    stability_run(&o);
    if (bench_write_report(args, table, json, args, error))
        return -1;
    int failed = 0;
    stability_each(count_failed, &failed);
    return failed ? tool_fail(error, -1, "%d rows exceed their bounds", failed) : 0;
}
