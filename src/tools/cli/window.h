// SPDX-License-Identifier: BSD-3-Clause
// Blur beyond a data window that is smaller than the display window: --grow enlarges the window; without it the blur
// is cut.
#ifndef HF_CLI_WINDOW_H
#define HF_CLI_WINDOW_H

#include "tools/cli/frame.h"

// Enlarge the data windows of all views by the reach of their blur, and move their pixels into new planes. The pixels
// must be loaded and the views set up. The caller has to set the views up again. Returns 0, or an exit code with
// *error filled.
int cli_window_grow(struct cli_frame *frame, struct tool_error *error);

// Enlarge the data window of a view's part to box, which holds it, and move the pixels of all views of that part.
int cli_window_enlarge(struct cli_frame *frame, const struct cli_view *view, const struct hf_io_box *box,
                       struct tool_error *error);

// Pixels that the blur of a view reaches beyond its data window inside the display window. v->radii must be filled.
int cli_window_cut(const struct cli_view *v);

#endif
