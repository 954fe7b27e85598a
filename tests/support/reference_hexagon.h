// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_TESTS_REFERENCE_HEXAGON_H
#define HF_TESTS_REFERENCE_HEXAGON_H

#include "support/image.h"

// A picture with signed radii r, as the hexagon engine blurs it.
struct picture hexagon_reference(const struct picture *colour, const struct picture *r, const struct hf_params *p);

#endif
