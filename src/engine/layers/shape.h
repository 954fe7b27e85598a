// SPDX-License-Identifier: BSD-3-Clause
// Apertures that are no disc, as slices draw them: rows of runs, or of weights for a picture.
#ifndef HF_LAYERS_SHAPE_H
#define HF_LAYERS_SHAPE_H

#include "pixel/aperture.h"

// A run of a row, in pixels from the middle of the pixel around which the shape lies: what it covers of the row's
// height is its weight.
struct hf_shape_end {
    float a, b, weight;
};

// The same as it is read: `length` whole pixels from `start` on, and parts of the one before and of the one after them,
// relative to the pixel that is drawn.
struct hf_shape_run {
    int start, length;
    float before, after, weight;
};

struct hf_shape_row {
    int first, count, left;  // of its runs, or weights; where the latter begin to be read
};

enum { HF_SHAPE_RUNS = 3 };  // of a row, at most

// A shape of a size. Its rows lie from `top` on around the pixel.
struct hf_shape {
    int top, rows, reach;  // reach: columns on either side
    double radius, sum;    // pixels; of all weights
    int windows;           // log2 of its longest run, plus 1
    const struct hf_shape_row *row;
    const struct hf_shape_end *end;  // shapes
    const struct hf_shape_run *run;  // the same, but for a cat's eye
    const float *weight;             // pictures
};

// What all shapes follow from. No padding: keys are compared byte by byte.
struct hf_shape_key {
    int blades, count;  // count: of radii
    float rotation, roundness, ring, cat_eye, wide, factor;
    float spacing, half, quarter;
    int fine;
    int width, height;  // of a picture
    uint64_t picture;   // its hash; 0: a shape
};

// The shapes of all slices, of one factor of the radius: [0] at the slice's resolution, [1] at that of what is hidden,
// [2] at full resolution.
struct hf_shapes {
    struct hf_block block;
    struct hf_shape_key key;
    int planes;                      // of a picture
    struct hf_shape (*shape)[3][3];  // [radius][channel of a picture][resolution]
};

// Radius i of a sequence and log2 of the pixels of its slice.
struct hf_shape_size {
    float radius;
    int level;
};

// (Re)build; does nothing when key is that of the last call, or but for fewer radii. picture: NULL for a shape.
int hf_shapes_build(struct hf_shapes *s, const struct hf_shape_key *key, const struct hf_shape_size *size,
                    const struct hf_image *picture, const struct hf_mem *mem);
// The weights of a picture (shape_picture.c): place one, and draw it.
void hf_shape_frame(struct hf_shape *s, const struct hf_area *area, double wide);
void hf_shape_draw(struct hf_shape *s, const struct hf_area *area, double wide, struct hf_shape_row *row,
                   float *weight);
// Integral from 0 to t of the half-width of the rows of a disc of radius r.
double hf_half_disc(double r, double t);
// How a run is read.
struct hf_shape_run hf_shape_run_of(float a, float b, float weight);

#endif
