// SPDX-License-Identifier: BSD-3-Clause
// Slices: at which radii, how fine, and their discs.
#ifndef HF_LAYERS_SLICES_H
#define HF_LAYERS_SLICES_H

#include "engine/layers/layers.h"

enum { HF_LAYERS_MARGIN = 2 };  // pixels of a slice's own that are made around a cell

// Bytes of the slices of radii up to a limit, on both sides.
size_t hf_layers_slice_bytes(const struct hf_layers *l, float limit);
// The shapes of those that the frame's radii lie between, if the aperture is no disc. Returns HF_ERR_MEMORY.
int hf_layers_make_shapes(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem);
// These slices, in l->tables. The first group's are in use.
void hf_layers_make_slices(struct hf_layers *l);
void hf_layers_use_group(struct hf_layers *l, int group);
// Tiles around a cell whose samples a slice's blur may bring into it.
int hf_layers_tiles_around(const struct hf_slice *s);

#endif
