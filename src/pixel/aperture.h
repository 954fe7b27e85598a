// SPDX-License-Identifier: BSD-3-Clause
// Sprites: pictures of the aperture at every size, as spans row by row, which sources of the scatter draw. Ends of spans
// are whole numbers of 1/256 pixel, so that sums of them are exact. layers (shape.c) makes spans of real numbers from the
// same sides, discs and integrals; the gather (area.c) computes how much of each pixel the aperture covers.
#ifndef HF_APERTURE_H
#define HF_APERTURE_H

#include "base/mem.h"
#include "base/small_float.h"
#include "base/stop.h"
#include "pass/frame.h"

enum { HF_WHOLE_ROW = 128 };

// A row of a sprite: the span from a to b, in 1/256 pixel from the left edge of the pixel that it is drawn around, and
// its weight in 1/128, which is less than 128 where the sprite covers only a part of the row's height.
struct hf_run {
    int32_t a, b, weight;
};

// The sprite of one size. Every shape has rows from `top` downwards.
struct hf_picture {
    int first;      // index of row 0 (symmetric) or of row `top` in half[] or run[]
    int columns;    // of an image's sprite
    int top, rows;  // symmetric: top 0, rows 0..rows - 1 stand for both +dy and -dy
    int reach_x, reach_y;
    int cap;     // symmetric: weight of the last row
    float area;  // sum of the weights of its pixels: 256 * HF_WHOLE_ROW each; for images up to 1023 each
};

// There are 1024 sizes per octave from radius 0.5 on, each 0.05 to 0.1 % larger than the last, because a highlight far
// brighter than its surroundings shows each step. A radius takes the nearest size.
enum { HF_SIZES_LOG2 = 10, HF_SIZES = 1 << HF_SIZES_LOG2 };

// All that the sprites depend on. There is no padding, because keys are compared byte by byte.
struct hf_aperture_key {
    float largest;              // radius, pixels
    float scale_x;              // widths are multiplied by it: pixel aspect and squeeze
    int blades, outline;        // outline: discs as runs too
    float rotation, roundness;  // an image's rotation is 0 or 180
    int width, height;          // of an image
    uint64_t image;             // its hash; 0: a shape
};

struct hf_aperture {
    int symmetric;  // discs are symmetric about both axes and need only half[]
    int count;
    int headroom;  // bits by which sums may exceed the largest sample
    struct hf_picture *picture;
    float *inverse;      // for shapes: 1 / area of each sprite
    int32_t *half;       // symmetric: half a row's width plus half a pixel, 1/256 pixel
    struct hf_run *run;  // outlines
    int16_t *tap;        // for images: differences of weights along each row
    int planes, steps;   // for images: sprites for each channel; of how many sizes one is kept
    struct hf_block block;
    struct hf_aperture_key key;
};

// Build the sprites for a key, unless it is that of the last call. Returns HF_OK,
// HF_ERR_MEMORY or HF_ERR_CANCELLED.
int hf_aperture_build(struct hf_aperture *a, const struct hf_aperture_key *key, const struct hf_mem *mem,
                      atomic_int *stop);

// The same from an image. Its centre is the axis, its shorter side the diameter. key->rotation: 0, or 180 for half a turn.
int hf_aperture_build_image(struct hf_aperture *a, const struct hf_aperture_key *key, const struct hf_image *image,
                            const struct hf_mem *mem, atomic_int *stop);

// The integral from 0 to y of the half-width of the rows of a disc of radius r.
double hf_half_disc(double r, double y);

// A side of a polygon whose corners lie on the unit circle: the line x nx + y ny = d, or an arc through the same
// corners, of a circle around (cx, cy), bent towards the unit circle.
struct hf_side {
    double nx, ny, d, cx, cy, radius;  // radius 0: straight
};
enum { HF_SIDES = 16 };

// rotation in degrees, roundness from 0 to 1. Returns the number of sides.
int hf_aperture_sides(struct hf_side side[HF_SIDES], int blades, double rotation, double roundness);
// The run of row y inside the sides; returns 0 if there is none. of: the sides at its ends.
int hf_aperture_run(const struct hf_side *side, int sides, double y, double *a, double *b, int of[2]);

// An image's transmission, integrated over [0, x) x [0, y).
struct hf_integral {
    const double *sum;  // (width + 1) x (height + 1)
    int width, height;
};

size_t hf_integral_bytes(const struct hf_image *image);
// The integral of a channel, in memory of hf_integral_bytes.
struct hf_integral hf_integral_make(double *memory, const struct hf_image *image, int channel, atomic_int *stop);
// The integral's value at a place that may lie between pixels or outside.
double hf_integral_at(const struct hf_integral *t, double x, double y);
// A hash of an image; and whether its channels differ.
uint64_t hf_aperture_hash(const struct hf_image *image, atomic_int *stop);
int hf_aperture_coloured(const struct hf_image *image, atomic_int *stop);

// The number of the sprite for a finite radius; radii below 0.5 count as 0.5.
static inline int hf_picture_number(float radius)
{
    return ((int32_t)hf_bits(radius > 0.5f ? radius : 0.5f) - 0x3f000000 + (1 << (22 - HF_SIZES_LOG2))) >>
           (23 - HF_SIZES_LOG2);
}

// The radius of that sprite.
static inline float hf_picture_radius(int number)
{
    return hf_from_bits((uint32_t)(0x3f000000 + number * (1 << (23 - HF_SIZES_LOG2))));
}

#endif
