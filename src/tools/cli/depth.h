// SPDX-License-Identifier: BSD-3-Clause
// What the numbers of a depth become before the library sees them: --depth-scale, --depth-offset, maps from 0 to 1,
// distances that are negative.
#ifndef HF_CLI_DEPTH_H
#define HF_CLI_DEPTH_H

#include <stddef.h>
#include <stdint.h>

#include "tools/cli/args.h"

// What was found in the numbers.
struct cli_depth_found {
    int flipped;        // all were negative: the camera looks along -z
    uint64_t negative;  // some were, and count as no surface
};

// "view", "normalized", and so on.
const char *cli_depth_type_name(const struct cli_args *args);

// Turn n numbers, in place, into what the library is told that they are: args->depth_type.
void cli_depth_prepare(const struct cli_args *args, float *depth, size_t n, struct cli_depth_found *found);

#endif
