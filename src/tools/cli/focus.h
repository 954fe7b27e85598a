// SPDX-License-Identifier: BSD-3-Clause
// The focus, read from a frame's depth where one pixel is not enough.
#ifndef HF_CLI_FOCUS_H
#define HF_CLI_FOCUS_H

#include "tools/cli/frame.h"

// The nearness, 1/distance, of what lies around the pixel to focus on. Blur grows evenly with it.
enum { CLI_AROUND = 8, CLI_AROUND_PIXELS = (2 * CLI_AROUND + 1) * (2 * CLI_AROUND + 1) };
struct cli_around {
    int count;                      // of near
    float near[CLI_AROUND_PIXELS];  // of the pixels with a surface, in no order
    float own;                      // of the surface that the pixel itself is of; NAN: none
};

// Gather what lies around pixel x, y, EXR coordinates, of a view whose depth is read.
void cli_focus_around(struct cli_around *around, const struct cli_args *args, const struct cli_view *v, int x, int y);

// The median of those numbers that differ from `from` by at most `part` of it, and how many there are (NULL: not asked
// for); NAN if there are none.
float cli_focus_median(const struct cli_around *around, float from, float part, int *count);

// Focus on args->focus_object: replace that in *args by the median of its distances. Returns 0, or an exit code with
// *error filled.
int cli_focus_object(struct cli_args *args, const struct cli_frame *frame, const struct cli_view *v,
                     struct tool_error *error);

#endif
