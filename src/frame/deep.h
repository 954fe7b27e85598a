// SPDX-License-Identifier: BSD-3-Clause
// A deep picture becomes what an engine takes: one picture, and two surfaces behind it.
#ifndef HF_FRAME_DEEP_H
#define HF_FRAME_DEEP_H

#include "frame/surfaces.h"

// A deep picture, copied and checked: depth.data are the samples' depths.
struct hf_deep_input {
    struct hf_deep deep;
    struct hf_depth depth;
    uint64_t most_in_pixel, most_in_row;  // samples
};

// Merge each pixel's samples into *merged and *known, as hf_surfaces_merge does. HF_ERR_MEMORY, HF_ERR_CANCELLED.
int hf_deep_merge(struct hf_context *c, const struct hf_setup *s, const struct hf_deep_input *in, int fused,
                  struct hf_merged *merged, struct hf_known *known);

#endif
