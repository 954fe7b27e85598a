// SPDX-License-Identifier: BSD-3-Clause
// Mixed pixels in two parts, in double precision, from their description.
#ifndef HF_TESTS_REFERENCE_EDGES_H
#define HF_TESTS_REFERENCE_EDGES_H

#include "support/image.h"

// [0] the front; share: the back's. mixed: how far it is; is_front: how far its depth is the front's; front: the front's
// share where it is wholly mixed.
struct edge_reference {
    double colour[2][4], radius[2], share, mixed, is_front, front;
};

// radius: signed, one a pixel; up to `sharp` they count as none.
struct edge_reference edge_reference(const struct picture *colour, const float *radius, double sharp, int x, int y);

#endif
