// SPDX-License-Identifier: BSD-3-Clause
// Writes a command's numbers.
#ifndef HF_BENCH_WRITE_H
#define HF_BENCH_WRITE_H

#include "args.h"
#include "tools/common/json.h"

// Write a report: as a table to stdout, as JSON to args->json, or both if the latter is a file. Returns 0, or -1 with
// *error filled.
int bench_write_report(const struct bench_args *args, void (*table)(FILE *out, const void *what),
                       void (*json)(FILE *out, const void *what), const void *what, struct tool_error *error);

// Begin the JSON of a command with what all commands write: name, cpu, version, options.
void bench_json_begin(struct tool_json *j, FILE *out, const char *command, const struct bench_args *args);

#endif
