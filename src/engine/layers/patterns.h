// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_PATTERNS_H
#define HF_LAYERS_PATTERNS_H

#include "engine/layers/kernels.h"

// A visible sample near a place, as far from the camera as the surface hidden there.
struct hf_pattern_tap {
    ptrdiff_t at;  // offset from the place in the level's planes
    float weight;
    float colour[4];
};

// The surface that patterns are compared on: a sample counts fully near this radius, and less with distance times
// slope.
struct hf_pattern_place {
    float radius, slope;
};

// How much a sample of weight w and radius r belongs to the surface of the place.
static inline float hf_pattern_known(struct hf_pattern_place p, float w, float r)
{
    const float d = r > p.radius ? r - p.radius : p.radius - r;
    return hf_saturate(2 - d * p.slope) * hf_saturate(9 * w);
}

// Floats of scratch that the pass needs for a band of half-resolution rows.
size_t hf_layers_patterns_floats(const struct hf_layers *l, int width, int height);
// How far around a pixel patterns are searched, half-resolution pixels.
int hf_layers_patterns_reach(const struct hf_layers *l);

#endif
