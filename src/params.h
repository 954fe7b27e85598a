// SPDX-License-Identifier: BSD-3-Clause
// From the arguments of a render call to the numbers that the passes need.
#ifndef HF_SETUP_H
#define HF_SETUP_H

#include "frame/frame.h"

enum { HF_MESSAGE = 256 };

// Check the arguments. Returns HF_OK, or HF_ERR_ARG with one sentence in message that names argument and value.
int hf_setup_check(const struct hf_image *dst, const struct hf_image *src, const struct hf_depth *depth,
                   const struct hf_params *params, char message[HF_MESSAGE]);

// Fill *s from checked arguments. The engine's own tables, taps among them, are made by its prepare.
void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_params *params, struct hf_taps *taps);

// View depth (INFINITY: no surface) or for HF_FORM_COC the radius of depth sample d at pixel (x, y). NaN gives NaN.
float hf_depth_decode(const struct hf_setup *s, float d, int x, int y);
// The same for pixel (x, y) of a depth buffer, a NaN repaired: *repaired is set if it was one.
float hf_depth_surface(const struct hf_setup *s, const struct hf_depth *depth, int x, int y, int *repaired);
// Fill the depth fields of a setup (form, e_a .. ray_sy): all that hf_depth_decode needs.
void hf_setup_depth(struct hf_setup *s, const struct hf_depth *depth, float pixel_aspect);
int hf_check_depth(const struct hf_depth *depth, int width, char message[HF_MESSAGE]);

// What the gaussian engine compares: z over the far plane, or as its source has it.
static inline float hf_gaussian_depth(const struct hf_setup *s, float z)
{
    z = z > s->plane_near ? z : s->plane_near;
    z = z < s->plane_far ? z : s->plane_far;
    return s->faithful ? (2 * z) / (z + s->plane_far) : z / s->plane_far;
}

#endif
