// SPDX-License-Identifier: BSD-3-Clause
// Pictures for the tests: planes of floats, random numbers, packing into the API's formats, distances (image.c), and a
// small EXR reader on OpenEXRCore (image_exr.c).
#ifndef HF_TESTS_IMAGE_H
#define HF_TESTS_IMAGE_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "hyperfocal/hyperfocal.h"

// Tightly packed planes R, G, B and perhaps A, or any other channels.
struct picture {
    int width, height, channels;
    float *plane[4];
};

// Make a picture of zeros. Without memory the program ends: these are tests.
struct picture picture_new(int width, int height, int channels);
struct picture picture_copy(const struct picture *p);
// The part of a picture from (x0, y0) on; and its mirror image, left to right.
struct picture picture_cut(const struct picture *p, int x0, int y0, int w, int h);
struct picture picture_flipped(const struct picture *p);
void picture_free(struct picture *p);

// Views of a picture for the API, format PLANAR32F; the picture owns the memory.
struct hf_image picture_image(const struct picture *p);
struct hf_depth picture_depth(const struct picture *z);  // plane 0, HF_DEPTH_VIEW

// Random numbers, xorshift64*: the same on every machine.
struct rng {
    uint64_t state;
};
struct rng rng_seed(uint64_t seed);
uint32_t rng_u32(struct rng *r);
int rng_below(struct rng *r, int n);  // 0..n-1
float rng_float(struct rng *r);       // [0, 1)
float rng_range(struct rng *r, float low, float high);

// An image in any format with its own memory: rows `stride` bytes apart (negative: bottom-up), first pixel `offset`
// bytes from alignment, all bytes outside pixels set to `junk`.
struct packed {
    struct hf_image image;
    unsigned char *memory[4];
    size_t size[4];
};

int format_channels(enum hf_format format);    // that a pixel can hold: 3 or 4
int format_pixel_size(enum hf_format format);  // bytes of a pixel; of a sample in planar formats
struct packed packed_new(int width, int height, enum hf_format format, int with_alpha, ptrdiff_t extra, int negative,
                         int offset, unsigned char junk);
void packed_free(struct packed *p);
// Conversions written independently of the library's: half and R11G11B10F round to nearest even, in double.
void packed_write(struct packed *p, const struct picture *from);
struct picture packed_read(const struct packed *p);
// 1 if every byte outside pixels still holds junk.
int packed_junk_intact(const struct packed *p, unsigned char junk);

double half_to_double(uint16_t bits);
uint16_t double_to_half(double v);  // nearest even; beyond 65504 clamped, NaN kept
double uf_to_double(uint32_t bits, int mantissa_bits);

// The larger of two errors; NaN is larger than all others.
static inline double worse(double a, double b)
{
    return isnan(a) || b <= a ? a : b;
}

// Peak signal to noise ratio of two pictures' R, G, B after clamping to 0..1 and the sRGB curve, dB.
double display_psnr(const struct picture *a, const struct picture *b);
// 1 if all planes hold the same bits.
int picture_same_bits(const struct picture *a, const struct picture *b);

// Read the named channels of the first part of a scanline EXR file as planes. Returns 0, or -1 if that fails.
int exr_read(struct picture *out, const char *path, int channels, const char *const names[]);

#endif
