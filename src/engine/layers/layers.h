// SPDX-License-Identifier: BSD-3-Clause
// What the layers engine knows of a frame.
//
// Every pixel is one sample, or two where an anti-aliased edge mixes two surfaces (unmix.c). What surfaces hide is
// invented at half resolution (hidden.c). Samples go to slices, fixed radii between which each is shared (slices.c); a
// slice is blurred as one (blur.c), and slices are put together from front to back, each where what lies before it
// leaves something open (cell.c, composite.c).
//
// Radii are signed, full-resolution pixels, negative in front of the focus. Colours of samples are not weighted.
#ifndef HF_LAYERS_H
#define HF_LAYERS_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "base/mem.h"
#include "engine/layers/shape.h"

enum {
    HF_LAYERS_TILE = 16,     // pixels; the extremes of the radii are kept for each tile
    HF_LAYERS_LEVELS = 7,    // of the hidden samples, at most
    HF_LAYERS_PARTS = 4,     // of the way from one slice of shares to the next, at most
    HF_LAYERS_COARSEST = 3,  // log2 of the largest pixels of a slice
    // Pixels beyond the frame's border of which there are samples: a tile, what makes the frame whole tiles, and vectors.
    HF_LAYERS_BORDER = 3 * HF_LAYERS_TILE
};

// Radii up to this lie between slices of full resolution, those beyond do not.
#define HF_LAYERS_FINE 4

// Sums of weights and of alphas are rounded apart: what is as near to 1 as this is opaque.
#define HF_LAYERS_OPAQUE 2e-6f
// Coverage of the far stack from which on it fills whatever the nearer slices leave open. The tail of a far disc that
// just reaches behind an object is less: what is open there is shared with the nearer slices, or thin objects before
// a sharp one would be filled with the sky far beside it. Without hidden samples nothing but that tail is behind them.
#define HF_LAYERS_FAINT 0.5f
#define HF_LAYERS_FAINT_ALONE 1e-3f

// Planes of samples or sums; each points to pixel (0, 0).
struct hf_layers_set {
    float *colour[4], *weight, *radius;
    ptrdiff_t stride;
};

// Least and largest radius of the samples of a tile; low > high: there is none.
struct hf_layers_range {
    float low, high;
};

// A row of a disc: weight 1 up to n pixels from its middle and f at n + 1; n may be -1.
struct hf_disc_row {
    int n;
    float f;
};

struct hf_slice {
    float radius;
    int level;                                               // log2 of its pixels
    float before, after;                                     // radii of its neighbours, or -+ HUGE_VALF
    float square, before_square, before_scale, after_scale;  // its share of a sample, see weigh
    // The disc: rows 0..rows-1 on either side; what a pixel at full resolution adds to its sum.
    int rows, reach;
    float scale;
    const struct hf_disc_row *row;
    const struct hf_shape *shape;  // instead of the disc, or NULL
    int sparse;                    // it has few sources
    int empty;                     // it has none
    int shine;                     // of what is seen: its number among the slices of shares
};

// What a quality stands for.
struct hf_layers_settings {
    float spacing;  // of the slices; small radii have it 1 anyway
    int fine;       // 0 to 2: slices lie closer, see slices.c
    int unmix, hidden, highlights;
    int patterns;  // hidden samples take theirs from what looks alike
    // Rays that what is near blocks are those to what is seen beside it, as rays cross between what is before the focus and
    // what is behind it: this part of its coverage is held back of the latter, for hidden samples. The better these are, the
    // more.
    float held;
    float half, quarter, eighth;  // radii from which slices are blurred at these parts of the resolution
};

struct hf_layers {
    struct hf_layers_settings set;
    struct hf_block tables, tiles;  // slices and discs; the ranges of the tiles
    float wide;                     // discs are wider than high by this
    int shaped;                     // the aperture is no disc
    struct hf_shape_key key;        // what it is
    struct hf_shapes shapes[3];     // of radii as they are, and of larger and smaller ones
    int most_windows, most_rows;    // of a shape
    float chromatic;                // by this
    float nearest, farthest;        // radii of the frame, and 0
    int edges;                      // pixels may be mixed
    int most_tiles;                 // around a cell from which a slice reaches it
    int around;                     // how far samples are read around a cell, pixels

    int width, height;                // of the frame
    int channels;                     // of colour, 3 or 4 with alpha
    float largest;                    // sample; larger ones count as this
    int slices, levels;               // levels of hidden samples; 0: none are looked for
    float held;                       // set.held, from 0 on as the range of radii begins to need hidden samples
    float reached;                    // how much the last level counts, 0..1, as the range of radii has reached it
    struct hf_slice *slice, *behind;  // of what is seen, of hidden samples
    // What the middle holds of samples that the far stack holds the rest of, of what is seen and of hidden samples:
    // between slice `last` and the next. last < 0: there are none.
    struct hf_slice *cover;
    int last;
    // Of shares at full resolution: `parts` of them from one slice to the next, so that the rim of a highlight lies where
    // its own radius has it.
    struct hf_slice *shine;
    int shines, parts;
    // Channels whose discs are their own: red, green with alpha, blue; or all are the first's.
    int groups;
    struct hf_slice *group[3];  // the slices of one

    int columns, rows;  // of tiles
    struct hf_layers_range *seen_range, *mixed_range;
    // Which slices have samples in a tile, a bit for each: of what is seen, mixed, hidden, hidden behind
    // that, and of shares.
    struct hf_block marks;
    atomic_uchar *repaired;     // whether the colour had samples to repair or to limit ...
    atomic_uchar *transparent;  // ... and whether its alpha is anywhere other than 1
    int words, share_words;     // of a tile's bits
    uint64_t *seen_marks, *mixed_marks, *hidden_marks, *beyond_marks, *share_marks;
};

// The samples of a frame.
struct hf_samples {
    struct hf_layers_set seen;   // one of each pixel ...
    struct hf_layers_set mixed;  // ... and the one behind it at mixed edges; without weight the rest means nothing
    float *share;  // of a visible sample's weight whose colour is drawn at full resolution; stride of seen
    struct hf_layers_set hidden, beyond;  // at half resolution: behind what is seen, and behind that
};

// Channels that are looked for and drawn once all of the frame is loaded: alpha that is 1 everywhere stays so, and no other
// channel hangs on it.
static inline int hf_layers_drawn(const struct hf_layers *l)
{
    return l->channels == 4 && !atomic_load_explicit(l->transparent, memory_order_relaxed) ? 3 : l->channels;
}

static inline float *hf_layers_at(const struct hf_layers_set *set, float *plane, int x, int y)
{
    return plane + (ptrdiff_t)y * set->stride + x;
}

// A row of pixels and what un-mixing reads around it: row i is that of y - 3 + i.
struct hf_unmix_row {
    int channels;
    const float *radius[7], *colour[7][4], *sure[7], *middle, *slope;
    float *seen[6], *mixed[6];  // colour, weight (4), radius (5)
};

// Sums of a stack: colour, and weight (the coverage that has been seen); open is what is left of 1. behind is what is
// left of 1 for hidden samples alone: a pixel has one at most, so those of all slices, with what is seen of the same surfaces,
// cover it once. held, of the middle: how much of what is seen behind the focus waits for hidden samples.
struct hf_stack_row {
    float *colour[4], *weight, *open, *behind, *held;
};

#endif
