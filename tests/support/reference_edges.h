// SPDX-License-Identifier: BSD-3-Clause
// Un-mixing in double precision, from its description.
#ifndef HF_TESTS_REFERENCE_EDGES_H
#define HF_TESTS_REFERENCE_EDGES_H

#include "support/image.h"

// [0] is the front; share: the back's. mixed: how mixed the pixel is; is_front: how far its depth belongs to the front;
// front: the front's share if the pixel were fully mixed.
struct edge_reference {
    double colour[2][4], radius[2], share, mixed, is_front, front;
};

// radius: signed, one per pixel; up to `sharp` they count as 0.
struct edge_reference edge_reference(const struct picture *colour, const float *radius, double sharp, int x, int y);

#endif
