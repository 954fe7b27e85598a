// SPDX-License-Identifier: BSD-3-Clause
// Numerical stability: the cases of tests/stability as a table.
#include "commands.h"

#include "stability/stability.h"

int bench_stability(struct bench_args *args, struct tool_error *error)
{
    if (args->json)
        return tool_fail(error, -1, "stability prints a table only: --json is not for it");
    const struct stability_options o = {.engine = args->engine_given ? hf_engine_name(args->params.engine) : NULL,
                                        .isa = args->isa,
                                        .full = args->full,
                                        .seed = 1};
    stability_run(&o);
    const int failed = stability_print(stdout);
    printf("\n%d rows keep their bounds, %d are open, %d fail\n", stability_passed(), stability_open(), failed);
    return failed ? tool_fail(error, -1, "%d rows exceed their bounds", failed) : 0;
}
