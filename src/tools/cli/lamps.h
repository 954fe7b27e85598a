// SPDX-License-Identifier: BSD-3-Clause
// --highlight-gain for lamps alone. The library gives light back to every pixel above the threshold; in a photograph those
// are bright walls and skies, too. So the command looks for lamps, which are small and much brighter than what is around,
// gives light to these, and has the library blur the picture as it then is.
#ifndef HF_CLI_LAMPS_H
#define HF_CLI_LAMPS_H

#include "tools/cli/frame.h"

// The pixels that were raised, and what they were.
struct cli_lamps {
    size_t count;  // of pixels
    size_t *at;
    float *given, *raised;  // three channels each
    float white;            // luminance of the brightest pixel of the picture, at least 1
};

// Find the lamps of a view and raise them in its planes. Sets v->highlights and v->lamps. Returns 0, or an exit code with
// *error filled.
int cli_lamps_raise(struct cli_lamps *lamps, struct cli_view *v, struct tool_error *error);
// After the blur: cut off light at the picture's white, and give pixels that were not blurred their own bits.
void cli_lamps_lower(struct cli_lamps *lamps, struct cli_view *v);
void cli_lamps_free(struct cli_lamps *lamps);

#endif
