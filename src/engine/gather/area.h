// SPDX-License-Identifier: BSD-3-Clause
// An aperture as weights of whole pixels, each as large as the part of the pixel that it covers.
#ifndef HF_AREA_H
#define HF_AREA_H

#include "base/stop.h"

struct hf_area {
    double radius_x, radius_y;  // pixels
    int rx, ry;                 // of the lattice: offsets -rx..rx, -ry..ry
    int blades;                 // 0: a disc
    double rotation;            // degrees
    int symmetric;              // mirrors in x and in y
    int cut;                    // the aperture is larger than the lattice
    int times;                  // the tents' sum: a picture of ones is one of these where the weights are laid over it
};

// Part of each pixel of the lattice that is covered, 0..1, and at least a little of the nine in the middle: rows
// of 2 rx + 1.
void hf_area_cover(double *cover, const struct hf_area *a, atomic_int *stop);
// Weights from that, in its place: whole numbers of hf_area_unit, 1 where a pixel is covered. Returns by what sums are
// to be multiplied: that of the weights alone then is 1, exactly, but of one that is cut, which is never met as a whole.
float hf_area_weights(double *weight, const struct hf_area *a);
// Such that no sum of weights needs more than 24 bits.
double hf_area_unit(const struct hf_area *a);

#endif
