// SPDX-License-Identifier: BSD-3-Clause
// What of a picture is near, in focus and far, pixel by pixel, by the settings of its view.
#ifndef HF_CLI_COC_H
#define HF_CLI_COC_H

#include "tools/cli/frame.h"

// Look whether anything is in focus, and keep the radii for --focus-image, and where blur may reach beyond the data
// window: the depth must be there. Returns 0, or an exit code with *error filled.
int cli_coc_look(struct cli_view *v, const struct cli_args *args, struct tool_error *error);
// Once v->report is there: the range of distances where nothing is in focus or nothing is blurred, as the warnings tell it,
// and how much blur the gaussian engine mixes in. While v->depth is there.
void cli_coc_measure(struct cli_view *v);
// Largest radius of blur that is seen in a view, pixels: of the gaussian engine that of a disc as wide as its blur, as far
// as that is mixed in.
float cli_coc_largest(const struct cli_view *v);

#endif
