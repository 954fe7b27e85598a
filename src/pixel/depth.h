// SPDX-License-Identifier: BSD-3-Clause
// What the samples of a depth buffer mean: how each becomes a distance or a radius.
#ifndef HF_PIXEL_DEPTH_H
#define HF_PIXEL_DEPTH_H

#include "pass/frame.h"

// The view depth (INFINITY: no surface), or for HF_FORM_COC the radius, of depth sample d at pixel (x, y). NaN gives
// NaN.
float hf_depth_decode(const struct hf_setup *s, float d, int x, int y);
// The same for pixel (x, y) of a depth buffer. A NaN is repaired, and *repaired is set.
float hf_depth_surface(const struct hf_setup *s, const struct hf_depth *depth, int x, int y, int *repaired);
// Fill the depth members of a setup (form, e_a .. ray_sy), which is all that hf_depth_decode needs.
void hf_setup_depth(struct hf_setup *s, const struct hf_depth *depth, float pixel_aspect);

#endif
