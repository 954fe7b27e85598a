// SPDX-License-Identifier: BSD-3-Clause
// The fields of struct hf_params that steps of the ladder may set: the engine and its knobs. `hyperfocal-bench tradeoff
// --ladder` writes each of them for each step.
#ifndef HF_LADDER_FIELDS_H
#define HF_LADDER_FIELDS_H

// clang-format off
#define HF_LADDER_FIELDS(DO) \
    DO(engine) \
    DO(gather.rings) DO(gather.fill) DO(gather.storage) DO(gather.faithful) DO(gather.karis) DO(gather.bicubic) \
    DO(gather.per_pixel_kernel) DO(gather.downsample) DO(gather.division) \
    DO(hexagon.resolution) DO(scatter.resolution) DO(gaussian.resolution) DO(gaussian.iterations) DO(gaussian.sigma) \
    DO(layers.quality) DO(layers.spacing) DO(layers.half_from) DO(layers.quarter_from) \
    DO(layers.no_unmix) DO(layers.no_hidden) DO(layers.no_highlights) DO(layers.no_patterns)
// clang-format on

#endif
