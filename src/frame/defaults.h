// SPDX-License-Identifier: BSD-3-Clause
// The values of struct hf_params that no one has changed.
#ifndef HF_DEFAULTS_H
#define HF_DEFAULTS_H

#include "hyperfocal/hyperfocal.h"

#define HF_PARAMS_DEFAULTS                                                                                             \
    .size = sizeof(struct hf_params), .engine = HF_ENGINE_GATHER, .model = HF_MODEL_RANGE, .focus = 10,                \
    .range = {.distance = HF_DERIVE,                                                                                   \
              .strength = 1,                                                                                           \
              .near_begin = HF_DERIVE,                                                                                 \
              .near_end = HF_DERIVE,                                                                                   \
              .far_begin = HF_DERIVE,                                                                                  \
              .far_end = HF_DERIVE},                                                                                   \
    .lens = {.f_number = 2.8f, .focal_length_mm = 50, .sensor_width_mm = 36, .world_unit_m = 1},                       \
    .max_radius = HF_DERIVE, .aperture = {.squeeze = 1}, .highlight = {.gain = 1, .threshold = 0.9f},                  \
    .view = {.display_width = HF_DERIVE, .display_height = HF_DERIVE, .pixel_aspect = 1},                              \
    .chapter = {.rings = HF_DERIVE},                                                                                   \
    .layers = {.spacing = HF_DERIVE, .half_from = HF_DERIVE, .quarter_from = HF_DERIVE},                               \
    .gaussian = {.iterations = 3, .sigma = HF_DERIVE, .by_depth = HF_DERIVE}

// What hf_params_init fills in.
extern const struct hf_params hf_params_defaults;

#endif
