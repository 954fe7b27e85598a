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

// For --blur: make radii of a depth of size[0] x size[1] numbers without a scale, in place. In focus is the median of what
// lies around the pixel `at`, the number farthest from it gets args->blur pixels, and the others are in proportion.
// whole_numbers: of a picture of integers, which depth estimators write with near ones white. Returns 0, or -1 if nothing
// is there to focus on.
int cli_depth_blur(const struct cli_args *args, float *depth, const int size[2], const int at[2], int whole_numbers);

#endif
