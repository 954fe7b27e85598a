// SPDX-License-Identifier: BSD-3-Clause
// --aperture FILE: the picture that every highlight becomes.
#ifndef HF_CLI_APERTURE_H
#define HF_CLI_APERTURE_H

#include "tools/cli/args.h"

struct cli_aperture {
    struct hf_image image;
    float *samples;  // owns its pixels
};

// Read the file, if one was given, and point args->params at its picture. Returns 0 or an exit status with *error
// filled.
int cli_aperture_load(struct cli_aperture *aperture, struct cli_args *args, struct tool_error *error);
void cli_aperture_free(struct cli_aperture *aperture);

#endif
