// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_CELL_H
#define HF_LAYERS_CELL_H

#include "engine/layers/kernels.h"

// Floats of scratch for a cell of at most width x height pixels, both multiples of HF_LAYERS_TILE.
size_t hf_layers_cell_floats(const struct hf_layers *l, int width, int height);
size_t hf_layers_composite_floats(const struct hf_layers *l, int width, int height);
// Compute the result of a cell. r: pixels, whole tiles. out[c] is pixel (r.x0, r.y0) of a plane.
void hf_layers_cell(const struct hf_layers *l, const struct hf_samples *samples, const struct hf_layers_kernels *k,
                    struct hf_rect r, float *memory, float *const out[4], ptrdiff_t stride);

#endif
