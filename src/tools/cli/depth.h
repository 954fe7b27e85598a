// SPDX-License-Identifier: BSD-3-Clause
// How the stored numbers of a depth become what the library takes: --depth-scale, --depth-offset, maps from 0 to 1,
// negative distances.
#ifndef HF_CLI_DEPTH_H
#define HF_CLI_DEPTH_H

#include <stddef.h>
#include <stdint.h>

#include "tools/cli/args.h"

// What the signs of the numbers were.
struct cli_depth_found {
    int flipped;        // all were negative: the camera looks along -z
    uint64_t negative;  // samples that were negative and count as no surface
};

// "view", "normalized", and so on.
const char *cli_depth_type_name(const struct cli_args *args);

// Convert n stored numbers, in place, to the library's depth of type args->depth_type.
void cli_depth_prepare(const struct cli_args *args, float *depth, size_t n, struct cli_depth_found *found);

#endif
