// SPDX-License-Identifier: BSD-3-Clause
// Views: the picture from single points of the lens. Slices know how much of the lens a near surface covers, but not
// which part. From one point of the lens each slice is only displaced, by its radius times the point, so what hides
// what is exact. The mean over many points is the lens. Views are made where near and far cross, which is where samples
// are hidden; elsewhere slices show the same. Or they make the near stack alone, which is cheaper (near_only).
#ifndef HF_LAYERS_VIEWS_H
#define HF_LAYERS_VIEWS_H

#include <math.h>

#include "engine/layers/layers.h"
#include "pass/frame.h"

enum {
    HF_LAYERS_VIEWS_SUM = 16,  // views that are summed up before they are added to the others: so rounding stays small
    HF_LAYERS_MOST_VIEWS = 192
};

// Larger radii are not shown: views would lie too far apart, and their planes would be large.
static inline float hf_layers_view_most(const struct hf_layers *l)
{
    return 128 * sqrtf(fminf((float)l->set.views / 96, 1));
}

// How far the blur of radius 1 goes.
static inline double hf_layers_view_width(const struct hf_layers *l)
{
    return l->lens_reach * (1 + fabs((double)l->chromatic));
}

// A slice as views read it: planes of what it holds. x has the resolution of the result, y one coarser by `level`.
struct hf_view_plane {
    // The weight at the block's pixel (0, 0), over the number of views; colours follow, `channel` floats apart.
    const float *at;
    ptrdiff_t row, channel;  // in floats
    int level;
    const uint32_t *held;  // of each row: a bit for each 16 pixels, from `lead` before the block on, that have weight
    int lead;
    const int16_t (*shift)[2];  // of each view: from a pixel to the one that it shows
};

// One over the width of a circle's edge, which is about as wide as that many points of a lens lie apart.
static inline float hf_layers_view_sharp(int views)
{
    return sqrtf((float)views) / 2;
}

// What a cat's eye leaves of the lens, seen from a row of pixels: of each view's point what lies within the circle of
// radius 1 around (x[i], y).
struct hf_view_eye {
    const float *x;
    float y, sharp;           // sharp: hf_layers_view_sharp
    const float (*point)[3];  // as in struct hf_layers
    float *total;             // receives the mean over the views of what is left
};

// Pixels (x, y) to (x + n, y) of a block, and the slices that reach them, nearest first; from `far` on they lie behind the
// focus. n is 16 or 32. near, beyond: means over the views of colours times weights, and of weights (4), of slices before and
// from `far` on.
struct hf_view_row {
    const struct hf_view_plane *plane;
    int planes, far, views, channels, x, y, n;
    float one;                      // 1 / views
    const float *part;              // of each view's point: the aperture's light around it, mean 1; or NULL, all 1
    const struct hf_view_eye *eye;  // or NULL
    float *near[5], *beyond[5];
};

// Make the points of the lens, and where slices lie seen from them. May return HF_ERR_MEMORY or HF_ERR_CANCELLED.
int hf_layers_make_views(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem);
// Floats of scratch that views take in a cell of so many tiles.
size_t hf_layers_views_floats(const struct hf_layers *l, int columns, int rows);

#endif
