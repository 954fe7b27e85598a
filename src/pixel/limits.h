// SPDX-License-Identifier: BSD-3-Clause
// How far a blur may reach, in pixels of radius.
#ifndef HF_LIMITS_H
#define HF_LIMITS_H

#include "hyperfocal/hyperfocal.h"

// The largest radius of a circle of confusion that is drawn.
#define HF_MAX_RADIUS 2048.0f

// The range model's default radius, the chapter's reach: 12 pixels at 1080 lines.
float hf_model_radius(int display_height);

// The largest radius of an aperture picture. All its pixels are drawn, and this bounds their number for wide pictures
// too.
float hf_most_picture_radius(const struct hf_params *p);

// The radius that parameters ask for, independent of the engine: max_radius if given; else the range model's at this
// display height; for a lens, or the caller's own radii, the largest possible one.
float hf_asked_radius(const struct hf_params *p, enum hf_depth_type type, int display_height);

#endif
