// SPDX-License-Identifier: BSD-3-Clause
// The layers engine in double precision, pixel by pixel, over the whole frame: no cells, tiles, spans or windows.
#ifndef HF_TESTS_LAYERS_REFERENCE_H
#define HF_TESTS_LAYERS_REFERENCE_H

#include "support/image.h"

// radius: signed, one a pixel. params: resolved; a picture of the aperture is RGB32F.
struct picture layers_reference(const struct picture *colour, const float *radius, const struct hf_params *params);

#endif
