// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that a frame's picture does not show, and whose samples are known.
#ifndef HF_KNOWN_H
#define HF_KNOWN_H

#include <stddef.h>

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

#endif
