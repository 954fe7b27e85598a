// SPDX-License-Identifier: BSD-3-Clause
// How far a blur may reach, in pixels of radius.
#ifndef HF_LIMITS_H
#define HF_LIMITS_H

#include "hyperfocal/hyperfocal.h"

// No circle of confusion is drawn with a larger radius.
#define HF_MAX_RADIUS 2048.0f

// The radius that the range model has unless told otherwise, the chapter's reach: 12 pixels at 1080 lines.
float hf_model_radius(int display_height);

// The largest radius of an aperture's picture, every pixel of which is drawn: one much wider than high has no more of them.
float hf_most_picture_radius(const struct hf_params *p);

// The radius that parameters ask for, whatever engine makes it: max_radius if it is given, else that of the range model at
// this height of the display, or for a lens and radii of one's own the largest that there can be.
float hf_asked_radius(const struct hf_params *p, enum hf_depth_type type, int display_height);

#endif
