// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/depth.h"

#include <math.h>

static const float NO_SURFACE = 1e10f;  // this distance and beyond it: no surface, as in the library

const char *cli_depth_type_name(const struct cli_args *args)
{
    return args->normalized > 0   ? "normalized"
           : args->normalized < 0 ? "normalized-inverted"
                                  : hf_name(HF_NAMES_DEPTH_TYPE, (int)args->depth_type);
}

// A stored number becomes scale * number + offset, and then the distance between the planes.
static void map(const struct cli_args *args, float *depth, size_t n)
{
    const float near_plane = args->near_plane, far_plane = args->far_plane;
    float scale = isnan(args->depth_scale) ? 1 : args->depth_scale;
    float offset = isnan(args->depth_offset) ? 0 : args->depth_offset;
    float from = 0, span = 1;
    if (args->normalized) {
        from = args->normalized > 0 ? near_plane : far_plane;
        span = (far_plane - near_plane) * (float)args->normalized;
    } else if (args->depth_type == HF_DEPTH_INVERSE && !isnan(near_plane)) {
        from = isfinite(far_plane) ? 1 / far_plane : 0;
        span = 1 / near_plane - from;
    }
    if (scale == 1 && offset == 0 && from == 0 && span == 1)
        return;
    for (size_t i = 0; i < n; i++)
        depth[i] = from + span * (depth[i] * scale + offset);
}

// A camera that looks along -z gives negative distances. If all samples are negative, their sign is dropped. If only
// some are, those count as no surface.
static void turn_round(float *depth, size_t n, struct cli_depth_found *found)
{
    uint64_t positive = 0, negative = 0;
    for (size_t i = 0; i < n; i++) {
        positive += depth[i] > 0 && depth[i] < NO_SURFACE;
        negative += depth[i] < 0 && depth[i] > -NO_SURFACE;
    }
    found->flipped = negative > 0 && positive == 0;
    found->negative = positive ? negative : 0;
    for (size_t i = 0; i < n && found->flipped; i++)
        depth[i] = depth[i] < 0 ? -depth[i] : INFINITY;
}

void cli_depth_prepare(const struct cli_args *args, float *depth, size_t n, struct cli_depth_found *found)
{
    *found = (struct cli_depth_found){0};
    map(args, depth, n);
    if (args->depth_type == HF_DEPTH_VIEW || args->depth_type == HF_DEPTH_RAY)
        turn_round(depth, n, found);
}
