// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine's blur of any size.
#ifndef HF_PASS_WIDE_H
#define HF_PASS_WIDE_H

#include "engine/gaussian/gaussian.h"

// Columns filtered at a time, and the number of boxes. More boxes are closer to a gaussian, see
// tests/engines/gaussian.c.
enum { HF_WIDE_LANES = 16, HF_WIDE_BOXES = 4 };

// A box of 2l + 1 samples, plus alpha times one more at either end; scale is 1 / the sum.
struct hf_wide {
    int l;
    double alpha, scale;
};

struct hf_wide hf_wide_of(double variance);

// Floats of scratch for lines of n samples: the block, its sums in double, and another block.
static inline size_t hf_wide_floats(int n)
{
    return 3 * HF_WIDE_LANES * (size_t)n;
}

#endif
