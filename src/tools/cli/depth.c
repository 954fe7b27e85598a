// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/depth.h"

#include <math.h>
#include <stdlib.h>

static const float NO_SURFACE = 1e10f;  // this distance and beyond it: no surface, as in the library

const char *cli_depth_type_name(const struct cli_args *args)
{
    return !isnan(args->blur)     ? "of no scale"
           : args->normalized > 0 ? "normalized"
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

// How near a stored number is, in units that nobody knows: what blur grows evenly with. For a lens that is 1/distance,
// and so it is in a depth buffer. A map whose grey grows evenly with the distance is taken as it is.
static float nearness(const struct cli_args *args, enum hf_depth_type type, float value)
{
    if (args->blur_normalized)
        return args->blur_normalized > 0 ? -value : value;
    switch (type) {
    case HF_DEPTH_NDC_D3D:
    case HF_DEPTH_NDC_GL:
        return -value;
    case HF_DEPTH_VIEW:
    case HF_DEPTH_RAY:
        value = fabsf(value);
        return value > 0 && value < NO_SURFACE ? 1 / value : 0;
    default:
        return value;
    }
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

int cli_depth_blur(const struct cli_args *args, float *depth, const int size[2], const int at[2], int whole_numbers)
{
    enum { AROUND = 2 };
    const enum hf_depth_type type = args->blur_typed ? args->blur_type
                                    : whole_numbers  ? HF_DEPTH_INVERSE
                                                     : HF_DEPTH_VIEW;
    const size_t n = (size_t)size[0] * (size_t)size[1];
    float near[(2 * AROUND + 1) * (2 * AROUND + 1)], most = 0;
    int count = 0;
    for (size_t i = 0; i < n; i++)
        depth[i] = nearness(args, type, depth[i]);
    for (int y = at[1] - AROUND; y <= at[1] + AROUND; y++)
        for (int x = at[0] - AROUND; x <= at[0] + AROUND; x++)
            if (x >= 0 && x < size[0] && y >= 0 && y < size[1] &&
                isfinite(depth[(size_t)y * (size_t)size[0] + (size_t)x]))
                near[count++] = depth[(size_t)y * (size_t)size[0] + (size_t)x];
    if (at[0] < 0 || at[0] >= size[0] || at[1] < 0 || at[1] >= size[1] || !count)
        return -1;
    qsort(near, (size_t)count, sizeof(*near), by_value);
    const float focus = near[count / 2];
    for (size_t i = 0; i < n; i++)
        if (isfinite(depth[i]))
            most = fmaxf(most, fabsf(depth[i] - focus));
    const float scale = most > 0 ? args->blur / most : 0;
    for (size_t i = 0; i < n; i++)
        depth[i] = (focus - depth[i]) * scale;
    return 0;
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
    if (!isnan(args->blur))
        return;
    map(args, depth, n);
    if (args->depth_type == HF_DEPTH_VIEW || args->depth_type == HF_DEPTH_RAY)
        turn_round(depth, n, found);
}
