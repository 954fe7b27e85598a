// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_TARGET_H
#define HF_CLI_TARGET_H

#include "tools/cli/args.h"
#include "tools/common/error.h"

// See that what is to be written can be: before any work, so that it is not in vain and nothing half done is left.
// Returns 0, or an exit code with *error filled.
int cli_check_targets(const struct cli_args *args, struct tool_error *error);

// The same for one file that turns out to be written later: is it another than all that the arguments name?
int cli_check_overwrite(const struct cli_args *args, const char *option, const char *path, struct tool_error *error);

// Is what INPUT holds lost once OUTPUT is written? Not where they are two names (hard links) of one file: a name is given to
// another then.
int cli_is_in_place(const struct cli_args *args);

#endif
