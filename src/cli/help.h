// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_CLI_HELP_H
#define HF_CLI_HELP_H

// The text of --help on stdout.
void cli_print_help(int all);

#endif
