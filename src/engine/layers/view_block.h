// SPDX-License-Identifier: BSD-3-Clause
// What the files that make views share: the tiles for which views are made at once, and the planes that they read.
#ifndef HF_LAYERS_VIEW_BLOCK_H
#define HF_LAYERS_VIEW_BLOCK_H

#include "engine/layers/parts.h"
#include "engine/layers/views.h"

enum {
    HF_LAYERS_BLOCK_ROWS = 12,  // of tiles, at most
    HF_LAYERS_VIEW_RUN = 32     // pixels of a row that are made together
};

// Planes of a slice, under construction.
struct hf_slice_plane {
    float *at;
    ptrdiff_t row, channel;
    int level, around;  // around: tiles on each side of the block
    int any;            // the slice reaches the block
    // Of each row of tiles, from `around` before the block on: a bit for each tile, likewise, that is cleared and may be read.
    uint64_t *cleared;
    // Of each row of its own pixels, from `around` tiles before the block on: as in struct hf_view_plane.
    uint32_t *held;
    struct hf_rect filled;  // the part that holds samples, in its own pixels
    uint64_t *reached;      // of each row of tiles, from one before the block on: a bit for each tile, likewise
};

struct hf_view_block {
    struct hf_cell c;  // only what hf_layers_place_sources() places, and `blend`
    // Pixels of the result have the frame's size, or that of the near stack: log2 of it; `tile` of them are a tile's side.
    int unit, tile;
    struct hf_rect made;  // the pixels that are made
    uint64_t *blended;    // of each row of tiles, from one before the block on: a bit for each tile where views count
    struct hf_slice_plane *plane;
    struct hf_view_plane *list;
    float *memory;  // of planes
    // Means of the views as in hf_view_row, and what a cat's eye leaves of them. The first is pixel (made.x0, made.y0).
    float *near[5], *beyond[5], *total;
    ptrdiff_t stride;
    float *across;  // where the pixels of a row lie for a cat's eye, from pixel 0 on
};

// view_planes.c
// Place planes of all slices that views show.
void hf_layers_place_planes(struct hf_view_block *b, struct hf_scratch *m);
// Make the planes of all slices that reach the block.
void hf_layers_make_planes(struct hf_view_block *b);
// The planes that reach some tiles, nearest first. Returns how many; *far: of those before the focus.
int hf_layers_list_planes(const struct hf_view_block *b, struct hf_rect tiles, struct hf_view_plane *to, int *far);

#endif
