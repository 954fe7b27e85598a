// SPDX-License-Identifier: BSD-3-Clause
// Mixed pixels, for engines of one flat field. The colour of an anti-aliased edge is a mixture of two surfaces, its depth
// that of one: blurred as it is, it smears what is sharp over the background, and its edge becomes stairs. So it is taken
// apart into a front and a back, each of its own colour, radius and share; the two, by their shares, are the pixel again.
//
//     struct hf_edges e;
//     hf_edges_start(&e, f, r, f->work);       // hf_edges_floats of it
//     for each full-resolution row y of r, downwards:
//         some = hf_edges_row(&e, y, &sides);
//
// Layers does the same with more of a neighbourhood (layers/unmix.c). Here sums are of mirrored pairs, and what is seen of
// colours at once is their largest difference: mirrored, permuted and scaled pictures have the bits of the original.
#ifndef HF_EDGES_H
#define HF_EDGES_H

#include "pixel/kernels.h"

// Radii of 3 x 3 pixels that differ by more than FROM are mixed, by 1 / GROWS more wholly so: where they differ by about 1 a
// surface folds under the lens. SIDES: 1 over which part of what they differ by is of both sides.
#define HF_EDGES_FROM 0.75f
#define HF_EDGES_GROWS 2
#define HF_EDGES_SIDES 2

// Shares are whole numbers of 1 / PARTS: no weight is so small that exact sums lose it.
#define HF_EDGES_PARTS (1 << 20)

// Rows of a rectangle and what lies around them, from the images.
struct hf_edges {
    const struct hf_frame *f;
    int x0, x1, left, right;  // pixels; read from left to right
    ptrdiff_t stride;         // of a row of scratch
    float *ring, *colour;
    int radii_done, sure_done;  // rows made before this one
    int colours[5];             // which row is in each place
};

// Floats of scratch for rectangles of that many half-resolution pixels across.
size_t hf_edges_floats(int width, int channels);
// r: half-resolution pixels; x0 even. Scratch rows of the frame (hf_line) from 0 to 7 are used by each row.
void hf_edges_start(struct hf_edges *e, const struct hf_frame *f, struct hf_rect r, float *work);
// Colours, radii and shares of the rectangle's row y. Returns whether a pixel is mixed; if not, nothing of the backs is
// written but shares of 0. Where a back has no share its colour and radius mean nothing. May write HF_PAD floats more.
int hf_edges_row(struct hf_edges *e, int y, const struct hf_sides *out);

// The first of a row of n shares from i on that is not 0; n if there is none. share NULL: none are.
int hf_edges_next(const float *share, int i, int n);

// 1 / d^4 of 5 x 5, and of the pixel itself as of the nearest; times HF_EDGES_SCALE.
extern const float hf_edges_weights[5][5];
// A neighbour that is mixed itself counts by this much where there is no other, and so does the pixel.
#define HF_EDGES_FAINT (1 / 16.0f)
// Colours that differ by less than this part of them say little of a share: then depth says it.
#define HF_EDGES_ALIKE (1 / 16.0f)
// Shares of less than this are noise.
#define HF_EDGES_NOISE (1 / 256.0f)
// Means of this part of colours do not overflow.
#define HF_EDGES_SCALE 0x1p-6f

#endif
