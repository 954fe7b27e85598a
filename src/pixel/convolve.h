// SPDX-License-Identifier: BSD-3-Clause
// Convolution of half-resolution planes with an aperture's weights on whole pixels.
#ifndef HF_CONVOLVE_H
#define HF_CONVOLVE_H

#include "pass/frame.h"

// The weights, summing to 1 with their scale: only those that are not 0, row by row. Row k has entries first[k] to
// first[k + 1]. symmetric: ny + 1 rows, for |dy| = k, with column |dx|. Else 2 ny + 1 rows, for dy = k - ny, with column
// dx + nx. Of runs, a column beyond nx (symmetric) stands for the sum of all from -j to j, j = column - nx - 1.
//
// With a step of 2 or 4, dx and dy count every second or fourth pixel, of an input that has been convolved with tents of that
// width (engine/gather/tents.h). Weights of the pixels between are interpolated linearly so: an area has a softer rim, for a half
// or a quarter of the work.
struct hf_taps {
    int step;
    int nx, ny;     // lattice reach: -nx..nx, -ny..ny, in steps
    int rx, ry;     // reach in pixels, tents included: nx * step + step - 1
    int symmetric;  // weights mirror in x and in y
    int rows;
    const int *first, *column;
    const float *weight;
    float scale;  // what their sums are multiplied by in the end
    int runs;     // there are such columns
};

// Channel c_in of one buffer into channel c_out of another.
void hf_convolve_c(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, const struct hf_buf *in,
                   int c_in, const struct hf_buf *out, int c_out);

#endif
