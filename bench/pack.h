// SPDX-License-Identifier: BSD-3-Clause
// Pictures in the formats of the library.
#ifndef HF_BENCH_PACK_H
#define HF_BENCH_PACK_H

#include <stddef.h>

#include "hyperfocal/hyperfocal.h"

// A picture with its memory: rows packed tightly, 64-byte aligned, planes one after another.
struct bench_image {
    struct hf_image image;
    void *memory;
    size_t bytes;
};

// Returns 0, or -1 without memory. All bytes are written once, so that no frame pays for fresh pages. Planar pictures
// have three planes.
int bench_image_alloc(struct bench_image *image, int width, int height, enum hf_format format);
void bench_image_free(struct bench_image *image);

// Fill a picture from packed RGB floats, rounding to nearest, ties to even. A value that a format cannot hold becomes
// its closest finite value; NaN and infinity stay. Alpha is 1.
void bench_image_pack(const struct bench_image *image, const float *rgb);

// Convert one number to IEEE half, or to the unsigned floats with 5 exponent and 6 or 5 mantissa bits of R11G11B10F.
unsigned bench_to_half(float x);
unsigned bench_to_small(float x, int mantissa_bits);

#endif
