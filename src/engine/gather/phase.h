// SPDX-License-Identifier: BSD-3-Clause
// Half-resolution fields at full-resolution pixels.
#ifndef HF_PHASE_H
#define HF_PHASE_H

#include "pass/frame.h"

// The half-resolution neighbourhood of a full-resolution pixel: its own half-resolution pixel (x, y) and the
// neighbours on the side where the pixel lies.
struct hf_phase {
    int x, y;    // own
    int nx, ny;  // neighbour's column and row
};

typedef float hf_upsampling(const struct hf_buf *b, int c, struct hf_phase p);
// Sixteen times the bilinear value at a quarter of the way to the neighbour, in x first. Thrice a number and itself are
// four times it, rounded or not: constants stay exact.
hf_upsampling hf_upsample;
// Uniform cubic B-spline there.
hf_upsampling hf_upsample_cubic;

// Put a field over lane i of the colour of the pixel p: of Composite by area.
void hf_area_blend_far(const struct hf_frame *f, struct hf_phase p, float coc, float *const colour[4], int i);
void hf_area_blend_near(const struct hf_frame *f, struct hf_phase p, float *const colour[4], int i);

#endif
