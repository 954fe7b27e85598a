// SPDX-License-Identifier: BSD-3-Clause
// The scatter in double precision, pixel by pixel: discs at full resolution, radii up to 24.
#ifndef HF_TESTS_SCATTER_REFERENCE_H
#define HF_TESTS_SCATTER_REFERENCE_H

#include "support/image.h"

// radius: signed, one per pixel.
struct picture scatter_reference(const struct picture *colour, const float *radius);

#endif
