// SPDX-License-Identifier: BSD-3-Clause
// From the arguments of a render call to the numbers that the passes need.
#ifndef HF_SETUP_H
#define HF_SETUP_H

#include "frame/frame.h"

enum { HF_MESSAGE = 256, HF_MAX_SIZE = 65536 };  // pixels of a side

// Put a sentence into message, which holds HF_MESSAGE bytes as all of these do. Returns HF_ERR_ARG.
int hf_bad(char *message, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Checks of one argument each. Return HF_OK, or HF_ERR_ARG with one sentence that names argument and value.
int hf_check_images(const struct hf_image *dst, const struct hf_image *src, char *message);
int hf_check_depth(const struct hf_depth *d, int width, char *message);
int hf_check_between(const char *name, float value, float least, float most, char *message);
// engine: its name, which is that of its parameters.
int hf_check_resolution(const char *engine, enum hf_resolution resolution, enum hf_resolution smallest, char *message);

// hf_resolve for an engine's and the library's own use: params must not be NULL.
int hf_params_resolve(struct hf_resolved *r, int width, int height, const struct hf_depth *depth,
                      const struct hf_params *params, char *message);
// The radius that the range model has unless told otherwise, the chapter's reach: 12 pixels at 1080 lines.
float hf_model_radius(int display_height);

// The largest radius of an aperture's picture, every pixel of which is drawn: one much wider than high has no more of them.
float hf_most_picture_radius(const struct hf_params *p);

// The radius that parameters ask for, whatever engine makes it: max_radius if it is given, else that of the range model at
// this height of the display, or for a lens and radii of one's own the largest that there can be.
float hf_asked_radius(const struct hf_params *p, enum hf_depth_type type, int display_height);

// Fill *s from resolved parameters, to which it will point, and the engine's own numbers, whose memory own is; its tables
// are its prepare's.
void hf_setup_make(struct hf_setup *s, const struct hf_image *src, const struct hf_image *dst,
                   const struct hf_depth *depth, const struct hf_resolved *r, void *own);

// View depth (INFINITY: no surface) or for HF_FORM_COC the radius of depth sample d at pixel (x, y). NaN gives NaN.
float hf_depth_decode(const struct hf_setup *s, float d, int x, int y);
// The same for pixel (x, y) of a depth buffer, a NaN repaired: *repaired is set if it was one.
float hf_depth_surface(const struct hf_setup *s, const struct hf_depth *depth, int x, int y, int *repaired);
// Fill the depth fields of a setup (form, e_a .. ray_sy): all that hf_depth_decode needs.
void hf_setup_depth(struct hf_setup *s, const struct hf_depth *depth, float pixel_aspect);

#endif
