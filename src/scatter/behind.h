// SPDX-License-Identifier: BSD-3-Clause
// What lies behind near pixels (behind.c).
#ifndef HF_BEHIND_H
#define HF_BEHIND_H

#include "scatter/scatter.h"

enum { HF_BEHIND_LEVELS = 9, HF_BEHIND_BLOCK = 128 };

// Less than the outermost pixel of the widest neighbourhood weighs: there is no edge to what is seen.
#define HF_BEHIND_NOTHING 1e-8f

// Half-resolution pixels across neighbourhood j are 2^(j+1) - 1; q: radius of the near pixel, or the largest of a quad.
static inline float hf_behind_span(float q)
{
    return 0.5f * q + 1;
}

// Of a block of at most HF_BEHIND_BLOCK half-resolution pixels each way.
struct hf_behind {
    int x0, y0, columns, rows, stride, reach, channels;  // of the planes, half-resolution pixels
    float *level[10], *sum[10];
    const float *near, *widest;  // the largest near radius of a quad, and around it
    int near_stride;
    int seen[2];  // whether anything is, sharp and far
};

// How many neighbourhoods near radii up to this ask for, and how far around a block these look.
int hf_behind_levels(float largest);
int hf_behind_halo(int levels);  // how far around a block radii are read
size_t hf_behind_floats(int levels, int channels);

// Returns 0 if there is nothing to do in a block: no near pixels, or nothing else around them.
int hf_behind_make(struct hf_behind *h, const struct hf_frame *f, struct hf_rect r, int levels, float *memory);
// A row of n pixels from (x, y) on, x even: how much of what is seen around them is sharp, and far.
struct hf_behind_line {
    const struct hf_frame *f;
    int x, y, n;
    float *weight[2], *colour[2];  // colour: scratch
};
// Returns 0 if none of them is near.
int hf_behind_begin(const struct hf_behind *h, struct hf_behind_line *l, const float *radius);
// One channel of what lies behind those that are near.
void hf_behind_row(const struct hf_behind *h, const struct hf_behind_line *l, const struct hf_scatter_row *row,
                   int channel, const float *own, float *out);

#endif
