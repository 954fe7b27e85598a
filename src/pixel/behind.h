// SPDX-License-Identifier: BSD-3-Clause
// Disocclusion fill (behind.c), for engines that composite near pixels over it.
#ifndef HF_BEHIND_H
#define HF_BEHIND_H

#include "pass/frame.h"

enum { HF_BEHIND_LEVELS = 9, HF_BEHIND_BLOCK = 128, HF_BEHIND_PLANES = 10 };

// How wide the neighbourhoods have to be for a near pixel of radius q, or a quad with that largest radius.
// Neighbourhood j is 2^(j+1) - 1 half-resolution pixels wide.
static inline float hf_behind_span(float q)
{
    return 0.5f * q + 1;
}

// The visible part of a pixel of radius r <= 0 behind nearer ones: 1 for pixels that are hardly near, and for those
// less than half as near as the largest near radius around. Farther pixels alone do not count, or a slope would be seen
// behind itself.
static inline float hf_behind_seen(float r, float widest)
{
    const float nearer = hf_saturate(0.5f * widest + r), hardly = hf_saturate(1.5f + r);
    return nearer > hardly ? nearer : hardly;
}

// The scratch of a block of at most HF_BEHIND_BLOCK half-resolution pixels each way.
struct hf_behind {
    int x0, y0, columns, rows, stride, reach, planes;  // of the planes, half-resolution pixels
    float *level[HF_BEHIND_PLANES], *sum[HF_BEHIND_PLANES];
    unsigned seen;               // bit p: plane p holds something
    const float *near, *widest;  // the largest near radius of a quad, and around it
    int near_stride;
};

// How an engine provides its pixels.
struct hf_behind_source {
    // Raise out to the largest near radii of the quads `from` to `to` of row q.
    void (*near)(const struct hf_frame *f, int q, int from, int to, float *out);
    // Add the visible parts of these quads to the planes: values times weights, and weights. widest: the largest near
    // radii around them. line: scratch of six rows of a plane. Returns one bit for each plane that received something.
    unsigned (*seen)(const struct hf_frame *f, int q, int from, int to, const float *widest, float *line,
                     float *const plane[HF_BEHIND_PLANES]);
};

// The number of neighbourhoods that near radii up to this need, and how far around a block they reach.
int hf_behind_levels(float largest);
int hf_behind_halo(int levels);  // how far around a block radii are read
size_t hf_behind_floats(int levels, int planes);

// Fill a block. Returns 0 if it has no near pixels or nothing else around them. h->planes must be set.
int hf_behind_make(struct hf_behind *h, const struct hf_behind_source *source, const struct hf_frame *f,
                   struct hf_rect r, int levels, float *memory);
// Plane p at n full-resolution pixels from (x, y) on, x even, bilinear; 0 where the plane holds nothing.
void hf_behind_sample(const struct hf_behind *h, const struct hf_frame *f, int p, int x, int y, int n, float *out);
// For sources whose radii are pixels': raise out to the largest near radii of quads, from channel c of a buffer.
void hf_behind_near(const struct hf_frame *f, const struct hf_buf *radii, int c, int q, int from, int to, float *out);
// Add a row of n pixels, v times weight times scale, to the quads of out; the last pixel of an odd n is half a quad.
void hf_behind_add(const struct hf_frame *f, const float *v, const float *weight, float scale, int n, float *out);

#endif
