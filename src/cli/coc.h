// SPDX-License-Identifier: BSD-3-Clause
// What of a picture is near, in focus and far, pixel by pixel, by the settings of its view.
#ifndef HF_CLI_COC_H
#define HF_CLI_COC_H

#include "cli/frame.h"

// Look whether anything is in focus, and keep the radii for --focus-image, and where blur may reach beyond the data
// window: the depth must be there. Returns 0, or an exit code with *error filled.
int cli_coc_look(struct cli_view *v, const struct cli_args *args, struct tool_error *error);

#endif
