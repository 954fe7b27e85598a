// SPDX-License-Identifier: BSD-3-Clause
// The fields of struct hf_params that steps of the ladder may set: the engine and its knobs. `hyperfocal-bench tradeoff
// --ladder` writes each of them for each step.
#ifndef HF_LADDER_FIELDS_H
#define HF_LADDER_FIELDS_H

// clang-format off
#define HF_LADDER_FIELDS(DO) \
    DO(engine) \
    DO(gather.storage) DO(gather.karis) DO(gather.bicubic) DO(gather.per_pixel_kernel) \
    DO(chapter.storage) DO(chapter.karis) DO(chapter.bicubic) DO(chapter.per_pixel_kernel) DO(chapter.faithful) \
    DO(chapter.rings) DO(chapter.fill) DO(chapter.downsample) DO(chapter.division) \
    DO(hexagon.resolution) DO(scatter.resolution) DO(gaussian.resolution) DO(gaussian.iterations) DO(gaussian.sigma) \
    DO(layers.quality) DO(layers.spacing) DO(layers.half_from) DO(layers.quarter_from) \
    DO(layers.no_unmix) DO(layers.no_hidden) DO(layers.no_highlights) DO(layers.no_patterns) \
    DO(layers.lens_points)
// clang-format on

#endif
