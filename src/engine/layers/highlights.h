// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_HIGHLIGHTS_H
#define HF_LAYERS_HIGHLIGHTS_H

#include "engine/layers/kernels.h"

enum { HF_LAYERS_BRIGHT_REACH = 13 };  // half-resolution pixels around a sample that are looked at

// By how much more roots of brightness must differ from what lies beside a sample than from what is around it: edges of
// patterns, up to eighteen times as bright as what is next to them, are none.
#define HF_LAYERS_BESIDE 3

// Floats of scratch for a cell of half-resolution pixels.
size_t hf_layers_highlight_floats(int width, int height);
// What is around a cell's pixels, into scratch.
void hf_layers_highlight_means(const struct hf_frame *f, struct hf_rect cell, float *scratch);
// The shares of rows of its pixels, from their samples.
void hf_layers_highlights(const struct hf_frame *f, struct hf_rect cell, struct hf_rect rows, const float *scratch);

#endif
