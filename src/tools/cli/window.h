// SPDX-License-Identifier: BSD-3-Clause
// Blur that reaches beyond a data window which is smaller than the display window: --grow, or what is cut.
#ifndef HF_CLI_WINDOW_H
#define HF_CLI_WINDOW_H

#include "tools/cli/frame.h"

// Let the windows of all views grow by as far as their blur reaches, and make their pixels anew. The pixels and the
// setup must be there; the setup has to be made again. Returns 0, or an exit code with *error filled.
int cli_window_grow(struct cli_frame *frame, struct tool_error *error);

// By how many pixels the blur of a view reaches beyond its data window where the display window goes on. The radii
// must be those of v->radii.
int cli_window_cut(const struct cli_view *v);

#endif
