// SPDX-License-Identifier: BSD-3-Clause
// Mixed pixels, for engines with one flat field. The colour of an anti-aliased edge is a mixture of two surfaces, while
// its depth is that of one. Blurred with that depth, the pixel smears a sharp surface over the background and turns its
// edge into stairs. So the pixel is taken apart into a front and a back, each with its own colour, radius and share;
// the two, weighted by their shares, add up to the pixel.
//
//     struct hf_edges e;
//     hf_edges_start(&e, f, r, f->work);       // hf_edges_floats of it
//     for each full-resolution row y of r, downwards:
//         some = hf_edges_row(&e, y, &sides);
//
// The layers engine (layers/unmix.c) finds mixed pixels and their fronts by these functions, but un-mixes them by
// formulas of its own: means of 7 x 7 pixels in which bright samples count less, variances, alpha, fused multiply-adds.
// The formulas here keep the bits of the result when a picture is mirrored, its channels are permuted or its colours
// are scaled: they add mirrored pairs first, and compare colours by the largest difference of a channel. One formula
// could not do both.
#ifndef HF_EDGES_H
#define HF_EDGES_H

#include "pixel/kernels.h"

// A pixel is mixed where the radii of the 3 x 3 around it differ by more than FROM, wholly from FROM + 1 / GROWS on:
// where radii change by about 1 a pixel, a surface folds under the lens. SIDES: of the range between the least and the
// largest radius, the middle part 1 / SIDES belongs to both sides.
#define HF_EDGES_FROM 0.75f
#define HF_EDGES_GROWS 2
#define HF_EDGES_SIDES 2

// Shares are multiples of 1 / PARTS, so that none is too small for exact sums.
#define HF_EDGES_PARTS (1 << 20)

// The state of un-mixing the rows of a rectangle, downwards.
struct hf_edges {
    const struct hf_frame *f;
    int x0, x1, left, right;  // columns: of the rectangle, and the first and the end of those that are read
    ptrdiff_t stride;         // between rows of scratch
    float *ring, *colour;
    int radii_done, sure_done;  // rows before these are made
    int colours[5];             // the row in each slot of `colour`
};

// Floats of scratch for rectangles `width` half-resolution pixels wide.
size_t hf_edges_floats(int width, int channels);
// r: half-resolution pixels, x0 even. Each row uses the frame's scratch rows (hf_line) 0 to 7.
void hf_edges_start(struct hf_edges *e, const struct hf_frame *f, struct hf_rect r, float *work);
// Write colours, radii and shares of row y. Returns whether any pixel is mixed; if none is, all shares are 0, and
// the backs' colours and radii are not written. Where a back's share is 0, its colour and radius mean nothing. May
// write HF_PAD floats beyond the row.
int hf_edges_row(struct hf_edges *e, int y, const struct hf_sides *out);

// How much of radius r belongs to the front, 0 to 1: a ramp of that slope around the middle of both sides.
static inline float hf_edges_front(float middle, float slope, float r)
{
    return hf_saturate((middle - r) * slope + 0.5f);
}

// Clamp between two colours that exist, so that a misfit makes no new ones.
static inline float hf_edges_between(float v, float a, float b)
{
    const float low = a < b ? a : b, high = a > b ? a : b;
    v = v > low ? v : low;
    return v < high ? v : high;
}

// The first share from i on that is not 0, of n in a row; n if there is none. Blocks of zeros are passed over.
int hf_edges_skip(const float *share, int i, int n);
// The same, and share may be NULL: all are 0.
static inline int hf_edges_next(const float *share, int i, int n)
{
    if (!share)
        return n;
    // Mixed pixels stand side by side, so the next one is looked at before blocks of them.
    return i < n && share[i] > 0 ? i : hf_edges_skip(share, i, n);
}

// 1 / d^4 for 5 x 5 pixels, times HF_EDGES_SCALE; the pixel itself has the weight of its nearest neighbours.
extern const float hf_edges_weights[5][5];
// Added to each pixel's certainty, so that mixed ones, and the middle one, count where a side has no others.
#define HF_EDGES_FAINT (1 / 16.0f)
// Where colours differ by less than this part of the larger, they say little about the share; then depth tells it.
#define HF_EDGES_ALIKE (1 / 16.0f)
// Smaller shares, of the front or the back, are noise: they become 0.
#define HF_EDGES_NOISE (1 / 256.0f)
// Means are of colours times this, so that they do not overflow.
#define HF_EDGES_SCALE 0x1p-6f

#endif
