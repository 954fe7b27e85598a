// SPDX-License-Identifier: BSD-3-Clause
// Samples behind the first of a pixel: backs of mixed pixels, and what the caller knows of hidden surfaces (known.c).
#ifndef HF_SCATTER_KNOWN_H
#define HF_SCATTER_KNOWN_H

#include "engine/scatter/walk.h"

// A pixel may have a sample of each of these.
enum hf_backs_set { HF_BACKS_MIXED, HF_BACKS_HIDDEN, HF_BACKS };

// The sets that are drawn in a field (0 near, 1 far) come before this one: hidden samples are only drawn if they are far.
static inline int hf_scatter_sets(int field)
{
    return field ? HF_BACKS : HF_BACKS_HIDDEN;
}

// A row of a set: shares of the pixel, 0 for none; radii; colours.
struct hf_backs {
    float *share, *radius, *colour[4];
};
// The row of pixels from (x, y) on. Returns 0 if the frame has no such samples.
int hf_scatter_backs(const struct hf_frame *f, enum hf_backs_set set, int x, int y, struct hf_backs *b);

// Take known edges of n pixels from (x, y) on in place of what un-mixing found.
void hf_scatter_know_edges(const struct hf_frame *f, int x, int y, int n, const struct hf_sides *row);
// Make the hidden samples of those pixels. visible: what hides them.
void hf_scatter_know(const struct hf_frame *f, int x, int y, int n, const struct hf_sides *visible);
// Put what is known into channel c of what lies behind a row's near pixels, which holds a guess.
void hf_scatter_known_row(const struct hf_frame *f, const struct hf_scatter_row *row, int c, float *behind);

#endif
