// SPDX-License-Identifier: BSD-3-Clause
// A band of half-resolution rows in which hidden samples are sought, and the levels that the search reads.
#ifndef HF_LAYERS_BAND_H
#define HF_LAYERS_BAND_H

#include "engine/layers/hidden.h"
#include "pass/frame.h"

// Samples that are searched at once; floats around a row; size of the blocks that are known to need a search or not.
enum { HF_HIDDEN_STEP = 128, HF_HIDDEN_PAD = 32, HF_HIDDEN_BLOCK = 16 };
#define HF_HIDDEN_ROUNDED 0.01f  // rounding may put a mean of radii this far above the largest of them

// Rows of samples in a ring: row y takes the place of row y - turn. All planes of a row lie side by side.
struct hf_hidden_ring {
    struct hf_layers_set set;
    int first, turn;  // row `first` has place 0
};

// All levels advance together, row by row, and the search follows them. So a ring keeps the few rows of a level that are
// still to be read, and these stay in a core's cache. At 1280 x 720 and four levels, whole levels are eight times as much.
struct hf_hidden_band {
    const struct hf_frame *f;
    const struct hf_layers *l;
    struct hf_rect r;
    int reach;
    struct hf_layers_set quads;                     // level 0
    struct hf_hidden_ring level[HF_LAYERS_LEVELS],  // from 1 on
        merged[HF_LAYERS_LEVELS];                   // rows of the level before, merged along rows
    int next;                                       // the row of level 0 that all levels take up next
    // Blocks; (0, 0) is the band's first, and there are more around it. farthest: largest radius in a block; within:
    // largest radius within the search's reach; needed: how many levels are searched; made: whether each level is made.
    int columns, rows, around, stride;
    float *farthest, *within;
    uint8_t *needed, *wide, *made[HF_LAYERS_LEVELS];  // wide: scratch
};

static inline void hf_hidden_planes(const struct hf_layers_set *s, int channels, int x, int row, float *out[6])
{
    const ptrdiff_t at = row * s->stride + x;
    for (int c = 0; c < channels; c++)
        out[c] = s->colour[c] + at;
    out[4] = s->weight + at;
    out[5] = s->radius + at;
}

// The place of row y.
static inline int hf_hidden_ring_row(const struct hf_hidden_ring *ring, int y)
{
    return (y - ring->first) % ring->turn;
}

// Room for `turn` rows of a band, from *memory on.
struct hf_hidden_ring hf_hidden_ring(const struct hf_hidden_band *b, int turn, float **memory);
// The floats of such a row.
size_t hf_hidden_row_floats(const struct hf_layers *l, int width);
// Place a band in memory, and find which levels are needed where. Returns what is left of the memory.
float *hf_hidden_begin(struct hf_hidden_band *b, float *memory);
// The floats that this takes for a band of a width and height.
size_t hf_hidden_band_floats(const struct hf_layers *l, int width, int height);
// Make what the search of row y reads of all levels. The rows of a band are searched one after the other.
void hf_hidden_advance(struct hf_hidden_band *b, int y);
// The samples of a level (0 on) for row y, from column x on.
void hf_hidden_level(const struct hf_hidden_band *b, int level, int x, int y, float *out[6]);
// The range of radii in a block; without weights all samples count.
struct hf_layers_range hf_hidden_range(const struct hf_hidden_band *b, const float *radius, const float *weight,
                                       ptrdiff_t stride, int n, int rows);

#endif
