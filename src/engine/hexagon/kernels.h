// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's kernels.
#ifndef HF_HEXAGON_KERNELS_H
#define HF_HEXAGON_KERNELS_H

#include "pass/engine.h"
#include "engine/hexagon/hexagon.h"

struct hf_hexagon_kernels {
    struct hf_passes passes;
    hf_kernel *first, *second;  // the two passes of blurs, for a band
    hf_kernel *beyond;          // pass 1 of the far field beyond the frame's edges; the rectangle is in working pixels
};
HF_DECLARE_KERNELS(hf_hexagon_kernels);

static inline const struct hf_hexagon_kernels *hf_hexagon_kernels(const struct hf_frame *f)
{
    return f->kernels;
}

hf_kernel hf_hexagon_load_c, hf_hexagon_1_c, hf_hexagon_2_c, hf_hexagon_beyond_c, hf_hexagon_blur_pass,
    hf_hexagon_behind_pass, hf_hexagon_composite_c;

// Load row y of a rectangle of pixels; mixed pixels become the samples of their blurred part (mixed.c). e is NULL if
// there are none. Uses the frame's scratch rows 0 to 12 and from 18 on. Returns the samples' weights, which colours
// are multiplied by, or NULL if all are 1.
struct hf_edges;
const float *hf_hexagon_row(struct hf_edges *e, const struct hf_frame *f, int y, struct hf_rect r,
                            float *const colour[4], float *radius);

// Load a rectangle row by row, at the working resolution. row gets e NULL if there are no mixed pixels.
typedef void hf_hexagon_load_row(const struct hf_frame *f, int y, struct hf_rect r, struct hf_edges *e);
void hf_hexagon_load_rows(const struct hf_frame *f, struct hf_rect r, hf_hexagon_load_row *row);

extern const struct hf_engine_def hf_hexagon_engine;

#endif
