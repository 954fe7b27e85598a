// SPDX-License-Identifier: BSD-3-Clause
// What lies behind near pixels, as scatter sees it (behind.c).
#ifndef HF_SCATTER_BEHIND_H
#define HF_SCATTER_BEHIND_H

#include "pixel/behind.h"
#include "engine/scatter/scatter.h"

extern const struct hf_behind_source hf_scatter_behind_source;
int hf_scatter_behind_planes(int channels);

// A row's: how much of what is seen around its pixels is sharp, and far; colour: scratch.
struct hf_scatter_behind {
    const struct hf_frame *f;
    const struct hf_behind *behind;
    float *weight[2], *colour[2];
};
// Returns 0 if none of the row's pixels is near, and none of the radii of backs.
int hf_scatter_behind_begin(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, const float *back,
                            int backs);
// One channel of what lies behind those that are near.
void hf_scatter_behind_row(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, int channel,
                           const float *own, float *out);

#endif
