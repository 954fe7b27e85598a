// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_HIGHLIGHTS_H
#define HF_LAYERS_HIGHLIGHTS_H

#include "layers/kernels.h"

enum { HF_LAYERS_BRIGHT_REACH = 13 };  // half-resolution pixels around a sample that are looked at

// Floats of scratch for a cell of half-resolution pixels.
size_t hf_layers_highlight_floats(int width, int height);
// The shares of a cell's pixels, from their samples.
void hf_layers_highlights(const struct hf_frame *f, struct hf_rect r);

#endif
