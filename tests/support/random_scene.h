// SPDX-License-Identifier: BSD-3-Clause
// Random small pictures with depth. Their CoC is 0 or clearly not, so that comparisons stay away from the threshold.
#ifndef HF_TESTS_RANDOM_SCENE_H
#define HF_TESTS_RANDOM_SCENE_H

#include "support/image.h"

enum scene_kind {
    SCENE_BLOCKS,      // rectangles at random depths before a random wall
    SCENE_NOISE,       // a random depth per pixel
    SCENE_RAMP,        // a floor from near to far, through the focus without steps
    SCENE_FAR,         // all behind the focus
    SCENE_NEAR,        // all in front
    SCENE_SHARP,       // all in focus
    SCENE_HIGHLIGHTS,  // BLOCKS with few pixels of up to 2000
    SCENE_DARK,        // BLOCKS without light but for lamps of a few pixels
    SCENE_NEGATIVE,    // BLOCKS with many negative samples
    SCENE_KINDS
};

// Depths are made for a focus of 20 and a range of 10; view depth. A few pixels have no surface.
struct scene {
    struct picture colour, depth;
};

struct scene scene_new(struct rng *rng, enum scene_kind kind, int width, int height, int channels);
void scene_free(struct scene *s);
const char *scene_name(enum scene_kind kind);

// The depth of a scene as another type: near_plane 1, far_plane 100, optical axis in the middle, focal length 50
// pixels; for HF_DEPTH_COC the radius of the range model with a largest radius rho. Its samples go to *samples.
struct hf_depth scene_depth_as(const struct scene *s, enum hf_depth_type type, float rho, struct picture *samples);

// Matching parameters: defaults with focus 20, range 10, largest radius 12.
struct hf_params scene_params(void);

// A configuration whose memory is filled with NaN: no result may depend on its old contents.
struct hf_config scene_config(enum hf_isa isa, int threads);

#endif
