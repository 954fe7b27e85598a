// SPDX-License-Identifier: BSD-3-Clause
// Apertures other than discs, as slices draw them: rows of runs, or rows of weights for a picture.
#ifndef HF_LAYERS_SHAPE_H
#define HF_LAYERS_SHAPE_H

#include "pixel/aperture.h"

// A run of a row: its ends in pixels from the middle of the shape's pixel. weight: the part of the row's height that it
// covers.
struct hf_shape_end {
    float a, b, weight;
};

// The same run as it is read: `length` whole pixels from `start` on, relative to the pixel that is drawn, and the parts
// of the pixels before and after them.
struct hf_shape_run {
    int start, length;
    float before, after, weight;
};

struct hf_shape_row {
    int first, count, left;  // first and count of its runs or weights; left: column of the first weight
    float top, low;          // the heights between which the outline covers a row of runs, pixels from the row's middle
};

enum { HF_SHAPE_RUNS = 3 };  // most runs of a row

// A shape of one size. Its rows begin `top` rows from the pixel.
struct hf_shape {
    int top, rows, reach;  // reach: columns on either side
    double radius, sum;    // radius in pixels; sum of all weights
    int windows;           // how many window sizes its longest run needs
    const struct hf_shape_row *row;
    const struct hf_shape_end *end;  // the runs of shapes
    const struct hf_shape_run *run;  // the same, ready to read; not used for a cat's eye
    const float *weight;             // the weights of pictures
};

// All that shapes depend on. There is no padding, because keys are compared byte by byte.
struct hf_shape_key {
    int blades, count;                                       // number of radii
    float rotation, roundness, ring, cat_eye, wide, factor;  // rotation: of a picture 0, or 180 in front of the focus
    float spacing, half, quarter;
    int fine;
    int width, height;  // of a picture
    uint64_t picture;   // hash of a picture; 0: a shape
};

// The shapes of all slices, for one factor of the radius: [0] at the slice's resolution, [1] at that of hidden samples,
// [2] at full resolution.
struct hf_shapes {
    struct hf_block block;
    struct hf_shape_key key;
    int planes;                      // 3 for a picture with colours of its own, else 1
    struct hf_shape (*shape)[3][3];  // [radius][channel of a picture][resolution]
};

// The radius of a slice, and log2 of its pixel size.
struct hf_shape_size {
    float radius;
    int level;
};

// Build the shapes again, unless key is that of the last call, or differs only in having fewer radii. picture: NULL for
// a shape. Returns HF_ERR_MEMORY or HF_ERR_CANCELLED.
int hf_shapes_build(struct hf_shapes *s, const struct hf_shape_key *key, const struct hf_shape_size *size,
                    const struct hf_image *picture, const struct hf_mem *mem, atomic_int *stop);
// The weights of an aperture picture (shape_picture.c): find its rows and reach, and draw it, turned by half a turn or not.
void hf_shape_frame(struct hf_shape *s, const struct hf_integral *area, double wide);
void hf_shape_draw(struct hf_shape *s, const struct hf_integral *area, double wide, struct hf_shape_row *row,
                   float *weight, int turned);
// Make a run from its ends and its weight, in the form that drawing reads.
struct hf_shape_run hf_shape_run_of(float a, float b, float weight);

#endif
