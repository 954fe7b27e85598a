// SPDX-License-Identifier: BSD-3-Clause
// Scatter's disocclusion fill: what lies behind near pixels (behind.c).
#ifndef HF_SCATTER_BEHIND_H
#define HF_SCATTER_BEHIND_H

#include "pixel/behind.h"
#include "engine/scatter/scatter.h"

// A weight of what is visible that counts half. It is small, so that the visible part has no edge where near pixels do not
// cover it, and large beside the weights that a neighbourhood begins with when a near radius grows by the last place of a
// float.
#define HF_SCATTER_NOTHING 1e-5f

extern const struct hf_behind_source hf_scatter_behind_source;
int hf_scatter_behind_planes(int channels);

// For a row: the weights of the sharp and of the far pixels that are visible around each pixel; colour is scratch.
struct hf_scatter_behind {
    const struct hf_frame *f;
    const struct hf_behind *behind;
    float *weight[2], *colour[2];
};
// Returns 0 if no pixel of the row is near, and no back either.
int hf_scatter_behind_begin(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, const float *back,
                            int backs);
// One channel of what lies behind the near pixels.
void hf_scatter_behind_row(const struct hf_scatter_behind *b, const struct hf_scatter_row *row, int channel,
                           const float *own, float *out);

#endif
