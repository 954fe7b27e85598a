// SPDX-License-Identifier: BSD-3-Clause
// Slices: at which radii, how fine, and their discs.
#ifndef HF_LAYERS_SLICES_H
#define HF_LAYERS_SLICES_H

#include "engine/layers/layers.h"
#include "pass/frame.h"

enum { HF_LAYERS_MARGIN = 2 };  // pixels of a slice's own resolution that are made around a cell

// Bytes for the slices of radii up to a limit, on both sides of the focus.
size_t hf_layers_slice_bytes(const struct hf_layers *l, float limit);
// Make the shapes of the frame's slices, if the aperture is not a disc. May return HF_ERR_MEMORY or HF_ERR_CANCELLED.
int hf_layers_make_shapes(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem);
// Make the frame's slices in l->tables, and use those of the first group.
void hf_layers_make_slices(struct hf_layers *l);
void hf_layers_use_group(struct hf_layers *l, int group);
// The slice whose planes hold a slice's samples for views; and by which radius views displace them, with a group's chromatic
// aberration. In the near stack two slices share planes: their points of the lens lie farther apart than the two.
int hf_layers_view_slice(const struct hf_layers *l, int i);
double hf_layers_view_radius(const struct hf_layers *l, int group, int i);
// A row of the place of each visible sample among the slices, from 0 for the nearest: 2.25 is a quarter of the way, by radius,
// from slice 2 to slice 3.
void hf_layers_show_slices(const void *own, const struct hf_frame *f, int y, float *row);
// How many tiles beyond a cell a slice's blur may bring samples from.
int hf_layers_tiles_around(const struct hf_slice *s);

#endif
