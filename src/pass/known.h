// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that a frame's picture does not show, and whose samples are known.
#ifndef HF_KNOWN_H
#define HF_KNOWN_H

#include <math.h>
#include <stddef.h>

#include "pass/frame.h"

// A surface that the picture hides, and whose samples are known: planes of the picture's size. Colours are multiplied by
// the weight, the part of the pixel that the surface fills. Where the weight is 0 the others are undefined.
struct hf_surface {
    float *colour[4], *weight, *radius;
};

// Known surfaces, front to back. With `edges`, pixels whose front surface has a weight between 0 and 1 need no un-mixing:
// the rest of the pixel is the picture's colour without the front's, at radius rest.
enum { HF_MOST_BEHIND = 2 };
struct hf_known {
    int count, edges;
    ptrdiff_t stride;
    struct hf_surface behind[HF_MOST_BEHIND], front;
    float *rest;
    float radius_min, radius_max;
};

// A colour, which the division by a small weight may make too large.
static inline float hf_known_within(float v, float largest)
{
    return v < -largest ? -largest : v < largest ? v : largest;
}

// How much of the colour of a pixel's known surface, of radius r, is that of what is visible beside an edge in the pixel,
// which has a share above 0 of it and a radius of its own. A peel's colour there is a mixture: where the nearest object
// fills the pixel its second surface, elsewhere what is behind the visible one. If the visible part belongs to the same
// surface, its share of the mixture has the wrong colour. Measured with the layers engine: 44.65 dB for 44.52 on `fence`,
// and no pale lines where near bars ended.
static inline float hf_known_beside(float share, float visible, float r)
{
    return share * hf_saturate(2 - 2 * fabsf(visible - r));
}

#endif
