// SPDX-License-Identifier: BSD-3-Clause
#include "pass.h"

#define B(name) HF_BIT(name)

// Order, names and buffers of the chapter's figure 3.6 and table 3.1.
const struct hf_pass hf_passes[HF_PASS_COUNT] = {
    [HF_PASS_COC] = {"CoC generation", .writes = B(COC), .sweep = 1},
    [HF_PASS_DOWN] = {"Downsample", .reads = B(COC), .writes = B(COLOR4) | B(COLORFAR4) | B(COC4), .sweep = 1},
    [HF_PASS_MAX_X] = {"Near CoC Max X", .around = B(COC4), .writes = B(MAX_X), .halo = HF_HALO_MAX_X, .sweep = 2},
    [HF_PASS_MAX_Y] = {"Near CoC Max Y", .around = B(MAX_X), .writes = B(MAX), .halo = HF_HALO_MAX_Y, .sweep = 2},
    [HF_PASS_BLUR_X] = {"Near CoC Blur X", .around = B(MAX), .writes = B(BLUR_X), .halo = HF_HALO_MAX_X, .sweep = 2},
    [HF_PASS_BLUR_Y] = {"Near CoC Blur Y", .around = B(BLUR_X), .writes = B(BLUR), .halo = HF_HALO_MAX_Y, .sweep = 2},
    [HF_PASS_GATHER] = {"Computation", .reads = B(BLUR), .around = B(COLOR4) | B(COLORFAR4) | B(COC4),
                        .writes = B(NEAR) | B(FAR), .halo = HF_HALO_TAPS, .sweep = 2},
    [HF_PASS_FILL] = {"Fill", .reads = B(BLUR), .around = B(NEAR) | B(FAR) | B(COC4),
                      .writes = B(NEAR_FILL) | B(FAR_FILL), .halo = HF_HALO_3X3, .sweep = 2},
    [HF_PASS_COMPOSITE] = {"Composite", .around = B(NEAR_FILL) | B(FAR_FILL) | B(BLUR) | B(COC4),
                           .halo = HF_HALO_UPSAMPLE, .sweep = 2},
};

const char *hf_pass_name(enum hf_pass_id pass)
{
    return (unsigned)pass < HF_PASS_COUNT ? hf_passes[pass].name : NULL;
}

struct hf_reach hf_pass_halo(const struct hf_setup *s, enum hf_halo halo)
{
    switch (halo) {
    case HF_HALO_3X3:
        return (struct hf_reach){1, 1};
    case HF_HALO_MAX_X:
        return (struct hf_reach){s->max_x, 0};
    case HF_HALO_MAX_Y:
        return (struct hf_reach){0, s->max_y};
    case HF_HALO_TAPS:
        // One more for the per-pixel kernel, whose bilinear taps read a neighbour even with weight 0.
        return (struct hf_reach){s->taps->rx + s->per_pixel_kernel, s->taps->ry + s->per_pixel_kernel};
    case HF_HALO_UPSAMPLE:
        return s->bicubic ? (struct hf_reach){2, 2} : (struct hf_reach){1, 1};
    case HF_HALO_NONE:
    default:
        return (struct hf_reach){0, 0};
    }
}
