// SPDX-License-Identifier: BSD-3-Clause
// The data of a frame in the layers engine.
//
// Every pixel is one sample, or two where an anti-aliased edge mixes two surfaces (unmix.c). Samples of what surfaces
// hide are guessed at half resolution (hidden.c). Slices lie at fixed radii, and each sample is shared by the two
// around its own radius (slices.c). A slice is blurred as a whole (blur.c). The slices are composited from front to
// back, each within the coverage that the slices before it leave open (cell.c, composite.c).
//
// Radii are signed, in full-resolution pixels, negative in front of the focus. Colours of samples are not multiplied by
// their weights.
#ifndef HF_LAYERS_H
#define HF_LAYERS_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "base/mem.h"
#include "base/stop.h"
#include "engine/layers/shape.h"
#include "pass/known.h"

enum {
    HF_LAYERS_TILE = 16,     // pixels; each tile keeps its least and largest radius
    HF_LAYERS_LEVELS = 7,    // of hidden samples, at most
    HF_LAYERS_PARTS = 4,     // radii of shares from one slice to the next, at most
    HF_LAYERS_COARSEST = 3,  // log2 of a slice's largest pixel size
    // Samples exist for this many pixels beyond the frame: a tile, the rest of the last whole tile, and vectors.
    HF_LAYERS_BORDER = 3 * HF_LAYERS_TILE
};

// Only radii above this can have shares at full resolution (highlights).
#define HF_LAYERS_FINE 4

// Weights and alphas are rounded separately. An alpha this close to 1 counts as opaque.
#define HF_LAYERS_OPAQUE 2e-6f
// From this coverage on, the far stack fills all that the nearer slices leave open. The tail of a far disc that just
// reaches behind an object has less. It then shares the open part with the nearer slices; otherwise thin objects before
// a sharp one would be filled with the sky far beside it. Without hidden samples only that tail lies behind them.
#define HF_LAYERS_FAINT 0.5f
#define HF_LAYERS_FAINT_ALONE 1e-3f
// A pixel that nothing covers, with nothing filled in behind it, stays as it was. One that is covered by less than this does so
// in part: a thin ring has gaps, and at their ends pixels jumped by 28 codes.
#define HF_LAYERS_SEEN 1e-3f

// Planes of samples or sums; each points to pixel (0, 0).
struct hf_layers_set {
    float *colour[4], *weight, *radius;
    ptrdiff_t stride;
};

// Least and largest radius of a tile's samples; low > high if it has none.
struct hf_layers_range {
    float low, high;
};

// How much of a tile hides something, 0 to 1, and the largest radius of what hides or is hidden: how far that shows.
struct hf_layers_crossing {
    float much, reach;
};

// A row of a disc: weight 1 up to n pixels from its middle, f at n + 1. n may be -1.
struct hf_disc_row {
    int n;
    float f;
};

struct hf_slice {
    float radius;
    int level;                                               // log2 of its pixel size
    float before, after;                                     // radii of its neighbours, or -+ HUGE_VALF
    float square, before_square, before_scale, after_scale;  // for its part of a sample, see weigh
    // The disc has rows 0 to rows - 1 on either side; scale is what one full-resolution pixel adds to a sum.
    int rows, reach;
    float scale;
    const struct hf_disc_row *row;
    const struct hf_shape *shape;  // instead of the disc, or NULL
    int sparse;                    // few of its pixels have sources
    int empty;                     // the slice is left out
    int shine;                     // for visible samples: its index among the slices of shares
};

// What a quality stands for.
struct hf_layers_settings {
    float spacing;  // of the slices, at most; small radii are at most 1 apart
    int fine;       // 0 to 2: how much closer slices lie, see slices.c
    int unmix, hidden, highlights;
    int patterns;  // hidden samples copy the colour of places that look alike
    // Rays cross at the plane in focus, so a near object occludes what is hidden behind it, not what is visible beside
    // it. This share of near coverage is withheld from visible far samples and kept for hidden ones. Better guesses
    // deserve a larger one.
    float held;
    int views;  // from how many points of the lens the picture is made where near and far cross, see views.h; 0: none
    int near_only;                // views make the near stack, where a near surface hides another, and slices the rest
    float half, quarter, eighth;  // a slice of at least this radius has this resolution
};

struct hf_layers {
    struct hf_layers_settings set;
    struct hf_block tables, tiles;  // slices and discs; ranges of the tiles
    float wide;                     // a disc's width is its height times this
    int shaped;                     // the aperture is not a disc
    struct hf_shape_key key;        // describes the aperture
    int turned;                     // in front of the focus the aperture is another one: half a turn shows
    // [in front of the focus, if turned]: at the slices' radii, at larger and at smaller ones (chromatic aberration).
    struct hf_shapes shapes[2][3];
    int most_windows, most_rows;   // of a shape
    float chromatic;               // relative difference of the radii of red and blue
    float nearest, farthest;       // radii in the frame, 0 included
    int mostly_blurred;            // at most a third of its pixels are sharp
    int edges;                     // pixels may be mixed
    int most_tiles;                // from which a slice's blur reaches a cell, on each side
    int around;                    // a cell reads samples up to this many pixels away
    const struct hf_known *given;  // known surfaces, or NULL
    int guessed;                   // samples have 1 for a colour that is known and 0 for a guess
    struct hf_shapes lens;         // the shape of an aperture that is not a disc, to place points in
    struct hf_block views;         // points and shifts
    // Of each group: where views are made from, in an aperture of radius 1, not widened; and what a cat's eye leaves of such a
    // point (0 to 1) that lies on the second circle's rim.
    float (*point[3])[3];
    int16_t (*shift[3])[2];  // of each group, slice and view: from a pixel to the one that it shows
    float *view_part;        // of each view, as in struct hf_view_row; or NULL
    double lens_reach;       // the farthest point from the middle, in radii, at least 1
    int group_used;          // the group that hf_layers_use_group() chose last
    int known;               // hidden samples have full resolution, as surfaces are known

    int width, height;                // of the frame
    atomic_int *stop;                 // the setup's
    int channels;                     // of colour, 3 or 4 with alpha
    float largest;                    // value of a sample; larger ones are clamped to it
    int slices, levels;               // levels of the search for hidden samples; 0: none are looked for
    int focus;                        // the slice of radius 0
    struct hf_slice *slice, *behind;  // of visible samples, of hidden samples
    // A sample between slice `last`, the last of the middle stack, and the next slice lies partly in the far stack.
    // These two pseudo-slices, for visible and for hidden samples, draw the part that the middle holds. last < 0: there
    // is no far stack.
    struct hf_slice *cover;
    int last;
    // Slices that draw shares at full resolution, `parts` of them per ordinary slice, so that a highlight's rim lies
    // close to its own radius.
    struct hf_slice *shine;
    int shines, parts;
    // Channels with discs of their own: red, green with alpha, blue. With groups 1 all channels have the first's.
    int groups;
    struct hf_slice *group[3];  // the slices of one

    int columns, rows;  // of tiles
    struct hf_layers_range *seen_range, *mixed_range;
    struct hf_layers_crossing *crossing;  // of each tile
    // The slices that have samples in a tile, one bit each: visible, mixed, hidden, second hidden samples, and shares.
    struct hf_block marks;
    atomic_uchar *repaired;     // whether samples of the colour were repaired or clamped
    atomic_uchar *transparent;  // whether alpha is anywhere other than 1
    int words, share_words;     // 64-bit words of bits per tile
    uint64_t *seen_marks, *mixed_marks, *hidden_marks, *beyond_marks, *share_marks;
};

// The samples of a frame.
struct hf_samples {
    struct hf_layers_set seen;   // one sample per pixel
    struct hf_layers_set mixed;  // the back sample of a mixed pixel; without weight its other planes are undefined
    float *share;                // the part of a visible sample's weight that is drawn as a highlight; stride of seen
    struct hf_layers_set hidden, beyond;  // at half resolution: the first hidden surface, and the one behind it
};

// The channels to search and draw once the whole frame is loaded. An alpha that is 1 everywhere stays 1, and no other
// channel depends on it.
static inline int hf_layers_drawn(const struct hf_layers *l)
{
    return l->channels == 4 && !atomic_load_explicit(l->transparent, memory_order_relaxed) ? 3 : l->channels;
}

static inline float *hf_layers_at(const struct hf_layers_set *set, float *plane, int x, int y)
{
    return plane + (ptrdiff_t)y * set->stride + x;
}

// A row of pixels and the rows that un-mixing reads around it: row i of the arrays is row y - 3 + i.
struct hf_unmix_row {
    int channels;
    const float *radius[7], *colour[7][4], *sure[7], *middle, *slope;
    float *seen[6], *mixed[6];  // colour, weight (4), radius (5)
    uint8_t *any;               // [i] becomes 1 where any of pixels 16 i to 16 i + 15 is mixed
    // Scratch of the vector bodies, kept from row to row: an eighth of the brightness, the sum of the colour's squares, and
    // done[][1 + i], whether vector i has both. 49 pixels look at each.
    float *light[7], *square[7];
    uint8_t *done[7];
};

// A row of the sums of a stack. weight is the coverage by all slices so far, colour the sum of their colours times
// their coverage, and open is 1 minus the coverage. behind is the coverage that hidden samples may still add. A pixel
// has one hidden surface at most. So the hidden samples of all slices cover a pixel at most once, together with the
// visible samples of the same surface. held is used in the middle stack: the coverage still to be withheld from visible
// samples behind the focus, and left to hidden ones.
struct hf_stack_row {
    float *colour[4], *weight, *open, *behind, *held;
};

#endif
