// SPDX-License-Identifier: BSD-3-Clause
// A run must not write a file that it reads for another frame: the file's old or new content would be lost.
#ifndef HF_CLI_CLASH_H
#define HF_CLI_CLASH_H

#include "tools/cli/shot.h"

// Compare all outputs of a sequence with all its inputs and with each other, before anything is written. Two existing
// files are the same if device and inode are equal after links were followed. Two files that do not exist yet are the
// same if directory and name are equal. log_file may be NULL. A single picture may be written in place;
// cli_check_targets checks that case. Returns 0, or an exit code with *error filled.
int cli_check_clashes(const struct cli_shot *shot, const char *log_file, struct tool_error *error);

#endif
