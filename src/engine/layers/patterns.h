// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_PATTERNS_H
#define HF_LAYERS_PATTERNS_H

#include "engine/layers/kernels.h"

// A sample around a place, of what lies as far as what is hidden there.
struct hf_pattern_tap {
    ptrdiff_t at;  // from the place, in the level's planes
    float weight;
    float colour[4];
};

// What patterns are compared by: radii that count as one surface, from 1 at that of the place to 0.
struct hf_pattern_place {
    float radius, slope;
};

// How much a sample of weight w and radius r lies on the surface of the place.
static inline float hf_pattern_known(struct hf_pattern_place p, float w, float r)
{
    const float d = r > p.radius ? r - p.radius : p.radius - r;
    return hf_saturate(2 - d * p.slope) * hf_saturate(9 * w);
}

// Floats of scratch that the pass needs for a band of half-resolution rows.
size_t hf_layers_patterns_floats(const struct hf_layers *l, int width, int height);
// How far around a pixel patterns are looked for, half-resolution pixels.
int hf_layers_patterns_reach(const struct hf_layers *l);

#endif
