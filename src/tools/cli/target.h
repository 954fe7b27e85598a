// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_TARGET_H
#define HF_CLI_TARGET_H

#include "tools/cli/args.h"
#include "tools/common/error.h"

// Check before any work that all files can be written, so that no work is lost and no half of it is left. Returns 0,
// or an exit code with *error filled.
int cli_check_targets(const struct cli_args *args, struct tool_error *error);

// Check that a file whose name is known only later is none of the files that the arguments name.
int cli_check_overwrite(const struct cli_args *args, const char *option, const char *path, struct tool_error *error);

// Does writing OUTPUT destroy the contents of INPUT? Not if both are hard links to one file: OUTPUT becomes a new file
// then.
int cli_is_in_place(const struct cli_args *args);

#endif
