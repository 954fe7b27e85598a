// SPDX-License-Identifier: BSD-3-Clause
// No file that a run writes may be one that it reads for another frame: it would be lost, before it is read or after.
#ifndef HF_CLI_CLASH_H
#define HF_CLI_CLASH_H

#include "tools/cli/shot.h"

// Compare all outputs of a sequence with all its inputs, and with each other, before anything is written. Two files that
// exist are the same when device and inode are, links being followed; two that do not exist yet, when directory and name
// are. log_file may be NULL. A single picture may be written in place: cli_check_targets looks after it. Returns 0, or an
// exit code with *error filled.
int cli_check_clashes(const struct cli_shot *shot, const char *log_file, struct tool_error *error);

#endif
