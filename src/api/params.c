// SPDX-License-Identifier: BSD-3-Clause
// Parameters: their defaults, and what they come to.
#include <stdio.h>

#include "frame/resolve.h"
#include "pass/check.h"

const struct hf_params hf_default_params = {
    .engine = HF_ENGINE_GATHER,
    .model = HF_MODEL_RANGE,
    .focus = 10,
    .range = {.distance = HF_DERIVE,
              .strength = 1,
              .near_begin = HF_DERIVE,
              .near_end = HF_DERIVE,
              .far_begin = HF_DERIVE,
              .far_end = HF_DERIVE},
    .lens = {.f_number = 2.8f, .focal_length_mm = 50, .sensor_width_mm = 36, .world_unit_m = 1},
    .max_radius = HF_DERIVE,
    .aperture = {.squeeze = 1},
    .highlight = {.gain = 1, .threshold = 0.9f},
    .view = {.display_width = HF_DERIVE, .display_height = HF_DERIVE, .pixel_aspect = 1},
    .gather = {.rings = HF_DERIVE, .fill = (enum hf_fill)HF_DERIVE},
    .layers = {.spacing = HF_DERIVE, .half_from = HF_DERIVE, .quarter_from = HF_DERIVE},
    .gaussian = {.iterations = 3, .sigma = HF_DERIVE, .by_depth = HF_DERIVE},
};

int hf_resolve(int width, int height, const struct hf_depth *depth, const struct hf_params *params,
               struct hf_resolved *resolved, char *message, size_t size)
{
    struct hf_resolved r;
    char sentence[HF_MESSAGE] = "";
    const int err = hf_params_resolve(&r, width, height, depth, params ? params : &hf_default_params, sentence);
    if (message && size)
        snprintf(message, size, "%s", sentence);
    if (resolved)
        *resolved = err ? (struct hf_resolved){0} : r;
    return err;
}
