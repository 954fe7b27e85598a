// SPDX-License-Identifier: BSD-3-Clause
// The frames of a shot, several at once: while one is read or written, others are computed.
#ifndef HF_CLI_BATCH_H
#define HF_CLI_BATCH_H

#include "tools/cli/args.h"
#include "tools/cli/shot.h"

// 1 if the arguments ask for a shot, or for an option that only shots have.
int cli_batch_wanted(const struct cli_args *args, const struct cli_shot *shot);

// Make all frames of the shot. Says what happens on stderr. Returns an exit code; with CLI_BAD_ARGUMENTS or when no
// frame was begun, *error is filled, else its text is empty.
int cli_batch(int argc, char **argv, const struct cli_args *args, const struct cli_shot *shot,
              struct tool_error *error);

#endif
