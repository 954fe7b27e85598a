// SPDX-License-Identifier: BSD-3-Clause
// Slices: at which radii, how fine, and their discs.
#ifndef HF_LAYERS_SLICES_H
#define HF_LAYERS_SLICES_H

#include "layers/layers.h"

enum { HF_LAYERS_MARGIN = 2 };  // pixels of a slice's own that are made around a cell

// Bytes of the slices of radii up to a limit, on both sides.
size_t hf_layers_slice_bytes(const struct hf_layers *l, float limit);
// Those that the frame's radii lie between, in l->tables.
void hf_layers_make_slices(struct hf_layers *l);
// Tiles around a cell whose samples a slice's blur may bring into it; and the most of all slices.
int hf_layers_tiles_around(const struct hf_slice *s);
int hf_layers_most_tiles(const struct hf_layers *l);

#endif
