// SPDX-License-Identifier: BSD-3-Clause
// From the arguments of a render call to the numbers that the passes need.
#ifndef HF_SETUP_H
#define HF_SETUP_H

#include "frame.h"

enum { HF_MESSAGE = 256 };

// Check the arguments. Returns HF_OK, or HF_ERR_ARG with one sentence in message that names argument and value.
int hf_setup_check(const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
                   const struct hf_params *params, char message[HF_MESSAGE]);

// Fill *s from checked arguments. The engine's own tables, taps among them, are made by its prepare.
void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_params *params, struct hf_taps *taps);

// View depth (INFINITY: no surface) or for HF_FORM_COC the radius of depth sample d at pixel (x, y). NaN gives NaN.
float hf_depth_decode(const struct hf_setup *s, float d, int x, int y);
// Fill the depth fields of a setup (form, e_a .. ray_sy): all that hf_depth_decode needs.
void hf_setup_depth(struct hf_setup *s, const struct hf_depth *depth, float pixel_aspect);
int hf_check_depth(const struct hf_depth *depth, int width, char message[HF_MESSAGE]);

#endif
