// SPDX-License-Identifier: BSD-3-Clause
// An aperture as weights of whole pixels, each as large as the part of the pixel that it covers.
#ifndef HF_AREA_H
#define HF_AREA_H

struct hf_area {
    double radius_x, radius_y;  // pixels
    int rx, ry;                 // of the lattice: offsets -rx..rx, -ry..ry
    int blades;                 // 0: a disc
    double rotation;            // degrees
    int symmetric;              // mirrors in x and in y
};

// Part of each pixel of the lattice that is covered, 0..1: rows of 2 rx + 1.
void hf_area_cover(double *cover, const struct hf_area *a);
// Weights from that, in its place: they sum to 1 exactly, and those of pixels that are covered are equal.
void hf_area_weights(double *weight, const struct hf_area *a);

#endif
