// SPDX-License-Identifier: BSD-3-Clause
// Integer colour: 0 to 2^bits - 1 stand for 0 to 1, linear or by the sRGB curve (IEC 61966-2-1). Alpha is always
// linear. Decoding and encoding a code gives the code again, for every format and transfer.
#ifndef HF_UNORM_H
#define HF_UNORM_H

#include <math.h>
#include <stdint.h>

#include "hyperfocal/hyperfocal.h"

// How a format packs its channels: bits[c] at shift[c] of a pixel of that many bytes, least significant bit first.
struct hf_unorm {
    uint8_t bytes, channels;
    uint8_t bits[4], shift[4];
};

// NULL for a format that is not of integers.
const struct hf_unorm *hf_unorm(enum hf_format format);

// Read channel c (0..3) of pixel (x, y), 0..1, linear. put: clamp v to 0..1, round it to nearest, and write it.
float hf_unorm_sample(const struct hf_image *image, int c, int x, int y);
void hf_unorm_put(const struct hf_image *image, int c, int x, int y, float v);

// The 256 values of 8-bit sRGB.
extern const float hf_srgb8[256];

// v^(5/12) is q^(5/3) with q the fourth root of v: a polynomial in q with an error of at most 5e-7 where it is used,
// from 0.0031308 to 1. That is 0.03 of a 16-bit code.
#define HF_SRGB_ENCODE                                                                                                 \
    {                                                                                                                  \
        -0.064447642f, 0.34023353f, -0.79031898f, 1.0867441f, -1.0624164f, 1.3746371f, 0.11896311f, -0.003394958f      \
    }
// u^2.4 is u^2 r^1.6 with r the fourth root of u: relative error 3e-7 from u = 0.0904 to 1.
#define HF_SRGB_DECODE                                                                                                 \
    {                                                                                                                  \
        -0.026887892f, 0.14698055f, -0.38556077f, 1.0233985f, 0.25639120f, -0.014321728f                               \
    }

// Linear 0..1 to sRGB 0..1.
static inline float hf_srgb_encode(float v)
{
    static const float p[8] = HF_SRGB_ENCODE;
    const float q = sqrtf(sqrtf(v));
    float sum = p[0];
    for (int i = 1; i < 8; i++)
        sum = sum * q + p[i];
    return v > 0.0031308f ? sum * 1.055f - 0.055f : v * 12.92f;
}

static inline float hf_srgb_decode(float s)
{
    static const float p[6] = HF_SRGB_DECODE;
    const float u = (s + 0.055f) * (1 / 1.055f), r = sqrtf(sqrtf(u));
    float sum = p[0];
    for (int i = 1; i < 6; i++)
        sum = sum * r + p[i];
    return s > 0.04045f ? u * u * sum : s * (1 / 12.92f);
}

#endif
