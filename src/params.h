// SPDX-License-Identifier: BSD-3-Clause
// From the arguments of a render call to the numbers that the passes need.
#ifndef HF_SETUP_H
#define HF_SETUP_H

#include "frame/frame.h"

enum { HF_MESSAGE = 256 };

// Check the arguments. Returns HF_OK, or HF_ERR_ARG with one sentence in message that names argument and value.
int hf_setup_check(const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
                   const struct hf_params *params, char message[HF_MESSAGE]);

// Fill *s from checked arguments, and the engine's own numbers, whose memory that is; its tables are its prepare's.
void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_params *params, void *own);

// View depth (INFINITY: no surface) or for HF_FORM_COC the radius of depth sample d at pixel (x, y). NaN gives NaN.
float hf_depth_decode(const struct hf_setup *s, float d, int x, int y);
// The same for pixel (x, y) of a depth buffer, a NaN repaired: *repaired is set if it was one.
float hf_depth_surface(const struct hf_setup *s, const struct hf_depth *depth, int x, int y, int *repaired);
// Fill the depth fields of a setup (form, e_a .. ray_sy): all that hf_depth_decode needs.
void hf_setup_depth(struct hf_setup *s, const struct hf_depth *depth, float pixel_aspect);
int hf_check_depth(const struct hf_depth *depth, int width, char message[HF_MESSAGE]);

// Autofocus: what the pixel in the middle shows, at infinity if that is nothing.
float hf_focus_of(const struct hf_params *p, const struct hf_depth *depth, int width, int height);
// Does the gaussian engine blend by the distance in depth, as its source does?
int hf_blends_by_depth(const struct hf_params *p, enum hf_depth_type type);
// The planes that bound its depths: those of the depth, else 1 and 100.
void hf_depth_planes(const struct hf_depth *depth, float *near, float *far);

#endif
