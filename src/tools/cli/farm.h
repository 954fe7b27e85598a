// SPDX-License-Identifier: BSD-3-Clause
// --chunk: which part of the frames this process makes.
#ifndef HF_CLI_FARM_H
#define HF_CLI_FARM_H

#include "tools/common/error.h"

// "3/8", or "auto": a task of a Slurm array, by SLURM_ARRAY_TASK_ID and its relatives. *part counts from 0. Returns 0,
// or -1 with *error filled.
int cli_chunk_parse(const char *text, int *part, int *parts, struct tool_error *error);

#endif
