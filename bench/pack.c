// SPDX-License-Identifier: BSD-3-Clause
#include "pack.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    size_t pixel;  // bytes of a pixel in a plane
    int planes;
} formats[] = {
    [HF_FORMAT_RGBA32F] = {16, 1},   [HF_FORMAT_RGB32F] = {12, 1},   [HF_FORMAT_RGBA16F] = {8, 1},
    [HF_FORMAT_R11G11B10F] = {4, 1}, [HF_FORMAT_PLANAR32F] = {4, 3}, [HF_FORMAT_RGBA8] = {4, 1},
    [HF_FORMAT_BGRA8] = {4, 1},      [HF_FORMAT_RGBX8] = {4, 1},     [HF_FORMAT_BGRX8] = {4, 1},
    [HF_FORMAT_RGB10A2] = {4, 1},    [HF_FORMAT_RGBA16] = {8, 1},
};

// 8-bit formats are sRGB, as in frame buffers; formats with more bits are linear.
static int is_srgb(enum hf_format format)
{
    return format == HF_FORMAT_RGBA8 || format == HF_FORMAT_BGRA8 || format == HF_FORMAT_RGBX8 ||
           format == HF_FORMAT_BGRX8;
}

int bench_image_alloc(struct bench_image *image, int width, int height, enum hf_format format)
{
    const size_t row = (size_t)width * formats[format].pixel, plane = row * (size_t)height;
    *image = (struct bench_image){
        .image = {.size = sizeof(struct hf_image),
                  .width = width,
                  .height = height,
                  .format = format,
                  .transfer = is_srgb(format) ? HF_TRANSFER_SRGB : HF_TRANSFER_LINEAR},
        .bytes = plane * (size_t)formats[format].planes,
    };
    image->memory = aligned_alloc(64, (image->bytes + 63) / 64 * 64);
    if (!image->memory)
        return -1;
    memset(image->memory, 0, image->bytes);
    for (int i = 0; i < formats[format].planes; i++) {
        image->image.data[i] = (char *)image->memory + (size_t)i * plane;
        image->image.stride[i] = (ptrdiff_t)row;
    }
    return 0;
}

void bench_image_free(struct bench_image *image)
{
    free(image->memory);
    *image = (struct bench_image){0};
}

// x >= 0 or NaN to 5 exponent bits (bias 15) and m mantissa bits.
static unsigned small_float(float x, int m)
{
    const unsigned infinity = 31u << m;
    if (isnan(x))
        return infinity | 1;
    if (isinf(x))
        return infinity;
    if (x < 0x1p-14f)  // denormal, in units of 2^(-14 - m); rounding up to 2^m gives the smallest normal number
        return (unsigned)rintf(x * (float)(1 << 14) * (float)(1 << m));
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int drop = 23 - m;
    bits += ((bits >> drop) & 1) + (1u << (drop - 1)) - 1;
    const unsigned rounded = (bits >> drop) - (112u << m);
    return rounded < infinity ? rounded : infinity - 1;
}

unsigned bench_to_small(float x, int mantissa_bits)
{
    return small_float(x > 0 || isnan(x) ? x : 0, mantissa_bits);
}

unsigned bench_to_half(float x)
{
    return small_float(fabsf(x), 10) | (signbit(x) ? 0x8000u : 0u);
}

static uint64_t to_unorm(float v, unsigned max, int srgb)
{
    v = v > 0 ? v < 1 ? v : 1 : 0;
    if (srgb)
        v = v <= 0.0031308f ? v * 12.92f : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
    return (uint64_t)lrintf(v * (float)max);
}

// A pixel of an integer format, opaque.
static void pack_unorm(const struct bench_image *image, size_t i, const float rgb[3])
{
    const enum hf_format format = image->image.format;
    const int srgb = image->image.transfer == HF_TRANSFER_SRGB;
    const int swap = format == HF_FORMAT_BGRA8 || format == HF_FORMAT_BGRX8;
    const unsigned bits = format == HF_FORMAT_RGBA16 ? 16 : format == HF_FORMAT_RGB10A2 ? 10 : 8;
    uint64_t word = ~(uint64_t)0 << 3 * bits;
    for (unsigned c = 0; c < 3; c++)
        word |= to_unorm(rgb[swap ? 2 - c : c], (1u << bits) - 1, srgb) << c * bits;
    memcpy((char *)image->memory + i * formats[format].pixel, &word, formats[format].pixel);
}

// Write pixel i of a picture, counted in reading order.
static void pack_pixel(const struct bench_image *image, size_t i, const float rgb[3])
{
    switch (image->image.format) {
    case HF_FORMAT_RGBA32F:
        for (size_t c = 0; c < 4; c++)
            ((float *)image->memory)[i * 4 + c] = c < 3 ? rgb[c] : 1;
        break;
    case HF_FORMAT_RGB32F:
        for (size_t c = 0; c < 3; c++)
            ((float *)image->memory)[i * 3 + c] = rgb[c];
        break;
    case HF_FORMAT_RGBA16F:
        for (size_t c = 0; c < 4; c++)
            ((uint16_t *)image->memory)[i * 4 + c] = (uint16_t)bench_to_half(c < 3 ? rgb[c] : 1);
        break;
    case HF_FORMAT_R11G11B10F:
        ((uint32_t *)image->memory)[i] =
            bench_to_small(rgb[0], 6) | bench_to_small(rgb[1], 6) << 11 | bench_to_small(rgb[2], 5) << 22;
        break;
    case HF_FORMAT_PLANAR32F:
        for (int c = 0; c < 3; c++)
            ((float *)image->image.data[c])[i] = rgb[c];
        break;
    default:
        pack_unorm(image, i, rgb);
        break;
    }
}

void bench_image_pack(const struct bench_image *image, const float *rgb)
{
    const size_t pixels = (size_t)image->image.width * (size_t)image->image.height;
    for (size_t i = 0; i < pixels; i++)
        pack_pixel(image, i, rgb + i * 3);
}
