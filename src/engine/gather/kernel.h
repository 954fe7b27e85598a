// SPDX-License-Identifier: BSD-3-Clause
// An aperture of a radius as a convolution.
#ifndef HF_KERNEL_H
#define HF_KERNEL_H

#include "base/mem.h"
#include "base/stop.h"
#include "engine/gather/tents.h"
#include "pixel/convolve.h"

// What it follows from. No padding: keys are compared byte by byte.
struct hf_area_key {
    float radius;        // half-resolution pixels, > 0
    float pixel_aspect;  // that in x is divided by it
    int blades;          // 0: a disc
    float rotation;      // degrees
    int most_x, most_y;  // what lies farther away is never met
    int soft;            // 1: if it is large it may have taps with a step, and so a softer rim
};

// All pixels, each by the part of it that the aperture covers.
struct hf_area_kernel {
    struct hf_taps taps;
    // sums[y * (2 rx + 2) + x] of the weights above and left of pixel (x - rx, y - ry), in units.
    const int *sums;
    float unit;

    struct hf_block block;   // owns all of the above
    struct hf_area_key key;  // what it was built from; radius 0: nothing yet
};

// (Re)build for a key; does nothing when it is the one of the last call. Returns HF_OK, HF_ERR_MEMORY
// or HF_ERR_CANCELLED.
int hf_area_kernel_build(struct hf_area_kernel *k, const struct hf_area_key *key, const struct hf_mem *mem,
                         atomic_int *stop);
// The sum of the weights of offsets x0..x1 - 1, y0..y1 - 1, cut to what there is: exact.
float hf_area_part(const struct hf_area_kernel *k, int x0, int x1, int y0, int y1);
void hf_area_kernel_free(struct hf_area_kernel *k, const struct hf_mem *mem);

#endif
