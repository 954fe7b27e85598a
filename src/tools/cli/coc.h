// SPDX-License-Identifier: BSD-3-Clause
// Which pixels of a picture are near, in focus or far, by the settings of its view.
#ifndef HF_CLI_COC_H
#define HF_CLI_COC_H

#include "tools/cli/frame.h"

// Find the least radius of blur in the view, which says whether anything is in focus. Keep the radii of all pixels if
// --focus-image, --grow or the test for blur beyond the data window needs them. v->depth must be loaded. Returns 0, or
// an exit code with *error filled.
int cli_coc_look(struct cli_view *v, const struct cli_args *args, struct tool_error *error);
// Call after v->report is filled and before v->depth is freed. If nothing is in focus or nothing is blurred, find the
// range of distances that the warning tells. For the gaussian engine, find how much of its blur is mixed in.
void cli_coc_measure(struct cli_view *v);
// Signed radii of a rectangle of a depth's pixels, row after row, infinite distance included. Returns 0, or -1 if hf_resolve
// refuses the parameters.
int cli_coc_radii(const struct hf_depth *depth, int width, int height, const struct hf_params *params,
                  const struct hf_io_box *box, float *radii);
// Largest visible radius of blur in a view, pixels. For the gaussian engine: the radius of a disc as wide as its blur,
// times the largest part of the blur that is mixed in.
float cli_coc_largest(const struct cli_view *v);

#endif
