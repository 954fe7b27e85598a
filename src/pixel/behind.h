// SPDX-License-Identifier: BSD-3-Clause
// What lies behind near pixels (behind.c), for engines that draw these over it.
#ifndef HF_BEHIND_H
#define HF_BEHIND_H

#include "pass/frame.h"

enum { HF_BEHIND_LEVELS = 9, HF_BEHIND_BLOCK = 128, HF_BEHIND_PLANES = 10 };

// Less than the outermost pixel of the widest neighbourhood weighs: there is no edge to what is seen.
#define HF_BEHIND_NOTHING 1e-8f

// Half-resolution pixels across neighbourhood j are 2^(j+1) - 1; q: radius of the near pixel, or the largest of a quad.
static inline float hf_behind_span(float q)
{
    return 0.5f * q + 1;
}

// How much of a pixel of radius r <= 0 is seen behind near ones: what hardly is one itself, and what is less near than
// half of the largest near radius around it. Not more by far, or a slope would be seen behind itself.
static inline float hf_behind_seen(float r, float widest)
{
    const float nearer = hf_saturate(0.5f * widest + r), hardly = hf_saturate(1.5f + r);
    return nearer > hardly ? nearer : hardly;
}

// Of a block of at most HF_BEHIND_BLOCK half-resolution pixels each way.
struct hf_behind {
    int x0, y0, columns, rows, stride, reach, planes;  // of the planes, half-resolution pixels
    float *level[HF_BEHIND_PLANES], *sum[HF_BEHIND_PLANES];
    unsigned seen;               // bit p: there is something in plane p
    const float *near, *widest;  // the largest near radius of a quad, and around it
    int near_stride;
};

// Where an engine has its pixels.
struct hf_behind_source {
    // Largest near radii of the quads `from` to `to` of row q, where they are larger than out's.
    void (*near)(const struct hf_frame *f, int q, int from, int to, float *out);
    // What is seen of these quads is added to planes: numbers times weights, and weights. widest: the largest near radii
    // around them. line: six of a plane's rows, for scratch. Returns a bit for each plane to which something was added.
    unsigned (*seen)(const struct hf_frame *f, int q, int from, int to, const float *widest, float *line,
                     float *const plane[HF_BEHIND_PLANES]);
};

// How many neighbourhoods near radii up to this ask for, and how far around a block these look.
int hf_behind_levels(float largest);
int hf_behind_halo(int levels);  // how far around a block radii are read
size_t hf_behind_floats(int levels, int planes);

// Returns 0 if there is nothing to do in a block: no near pixels, or nothing else around them. h->planes is set.
int hf_behind_make(struct hf_behind *h, const struct hf_behind_source *source, const struct hf_frame *f,
                   struct hf_rect r, int levels, float *memory);
// Plane p at n full-resolution pixels from (x, y) on, x even, bilinearly; 0 where there is nothing in it.
void hf_behind_sample(const struct hf_behind *h, const struct hf_frame *f, int p, int x, int y, int n, float *out);
// What sources do whose radii are pixels': the largest near radii of quads, from channel c of a buffer.
void hf_behind_near(const struct hf_frame *f, const struct hf_buf *radii, int c, int q, int from, int to, float *out);
// Pixels of a row of n, v times weight times scale, added to the quads of out; the last of an odd n is half of one.
void hf_behind_add(const struct hf_frame *f, const float *v, const float *weight, float scale, int n, float *out);

#endif
