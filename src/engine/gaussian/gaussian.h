// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine's buffers and rows of work.
#ifndef HF_PASS_GAUSSIAN_H
#define HF_PASS_GAUSSIAN_H

#include "pass/frame.h"

enum {
    // Each once for every resolution, in their order:
    HF_GAUSSIAN_ROWS = 0,  // colour blurred along the rows, or as it was read: the whole frame
    HF_GAUSSIAN_BLUR = 3,  // then blurred down the columns: one tile
    HF_GAUSSIAN_BUFS = 6
};

// Columns of a strip. All iterations run on a strip while it is in the first-level cache.
enum { HF_GAUSSIAN_STRIP = 32 };

struct hf_gaussian {
    enum hf_resolution resolution;  // the working one, of the blur
    int faithful;
    int iterations;
    float sigma;                           // full-resolution pixels; 0: iterations
    int by_depth;                          // blend by the distance in depth from the focus
    float plane_near, plane_far, focus_d;  // see hf_gaussian_depth
    // If by_limits, z <= near_last has near CoC and z >= far_first has far CoC (limits.c).
    int by_limits;
    float near_last, far_first;
};

static inline const struct hf_gaussian *hf_gaussian(const struct hf_setup *s)
{
    return s->own;
}

static inline const struct hf_buf *hf_gaussian_buf(const struct hf_frame *f, int buf)
{
    return &f->buf[buf + (int)hf_gaussian(f->s)->resolution];
}

// The value that is compared with the focus: z over the far plane, or as the original shader has it.
static inline float hf_gaussian_depth(const struct hf_gaussian *g, float z)
{
    z = z > g->plane_near ? z : g->plane_near;
    z = z < g->plane_far ? z : g->plane_far;
    return g->faithful ? (2 * z) / (z + g->plane_far) : z / g->plane_far;
}

// Near and far CoC of a depth z, and the limits of both, for depth in view-space z.
float hf_gaussian_near(const struct hf_setup *s, float z);
float hf_gaussian_far(const struct hf_setup *s, float z);
void hf_gaussian_limits(const struct hf_setup *s, struct hf_gaussian *g);

// Pixels of the working buffer that the iterations reach on either side.
static inline int hf_gaussian_reach(const struct hf_setup *s)
{
    return 2 * hf_gaussian(s)->iterations;
}

// The same in half-resolution pixels.
static inline int hf_gaussian_halo(const struct hf_setup *s)
{
    return hf_gaussian(s)->iterations << hf_gaussian(s)->resolution;
}

// Floats of one scratch line of the first sweep: a chunk's row and the reach on either side.
static inline size_t hf_gaussian_line_floats(const struct hf_setup *s, int chunk_width)
{
    return (((size_t)chunk_width + 2 * (size_t)hf_gaussian_halo(s) + 15) & ~(size_t)15) + 2 * HF_PAD;
}

// Number of those lines: even and odd pixels, their sums, and two lines at the working resolution, which are twice as
// long.
enum { HF_GAUSSIAN_LINES = 20 };

// A size at the working resolution, and an area: the argument is in half-resolution pixels, the result lies inside the
// frame.
static inline int hf_gaussian_size(const struct hf_setup *s, int full, int half)
{
    return hf_gaussian(s)->resolution == HF_RESOLUTION_FULL
               ? full
               : (half + (int)hf_gaussian(s)->resolution - 1) / (int)hf_gaussian(s)->resolution;
}

static inline struct hf_rect hf_gaussian_working(const struct hf_setup *s, struct hf_rect r)
{
    const int log2 = (int)hf_gaussian(s)->resolution;
    return (struct hf_rect){2 * r.x0 >> log2, 2 * r.y0 >> log2,
                            hf_min(((2 * r.x1 - 1) >> log2) + 1, hf_gaussian_size(s, s->width, s->half_width)),
                            hf_min(((2 * r.y1 - 1) >> log2) + 1, hf_gaussian_size(s, s->height, s->half_height))};
}

#endif
