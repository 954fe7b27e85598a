// SPDX-License-Identifier: BSD-3-Clause
#include "support/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *must(void *p)
{
    if (!p) {
        fputs("out of memory\n", stderr);
        exit(1);
    }
    return p;
}

struct picture picture_new(int width, int height, int channels)
{
    struct picture p = {width, height, channels, {NULL}};
    for (int c = 0; c < channels; c++)
        p.plane[c] = must(calloc((size_t)width * (size_t)height, sizeof(float)));
    return p;
}

struct picture picture_copy(const struct picture *p)
{
    struct picture q = picture_new(p->width, p->height, p->channels);
    for (int c = 0; c < p->channels; c++)
        memcpy(q.plane[c], p->plane[c], sizeof(float) * (size_t)p->width * (size_t)p->height);
    return q;
}

struct picture picture_cut(const struct picture *p, int x0, int y0, int w, int h)
{
    struct picture out = picture_new(w, h, p->channels);
    for (int c = 0; c < p->channels; c++)
        for (int y = 0; y < h; y++)
            memcpy(out.plane[c] + y * w, p->plane[c] + (y + y0) * p->width + x0, sizeof(float) * (size_t)w);
    return out;
}

struct picture picture_flipped(const struct picture *p)
{
    struct picture out = picture_new(p->width, p->height, p->channels);
    for (int c = 0; c < p->channels; c++)
        for (int y = 0; y < p->height; y++)
            for (int x = 0; x < p->width; x++)
                out.plane[c][y * p->width + x] = p->plane[c][y * p->width + p->width - 1 - x];
    return out;
}

void picture_free(struct picture *p)
{
    for (int c = 0; c < 4; c++)
        free(p->plane[c]);
    *p = (struct picture){0};
}

struct hf_image picture_image(const struct picture *p)
{
    struct hf_image image = {
        .size = sizeof image, .width = p->width, .height = p->height, .format = HF_FORMAT_PLANAR32F};
    for (int c = 0; c < p->channels; c++) {
        image.data[c] = p->plane[c];
        image.stride[c] = p->width * (ptrdiff_t)sizeof(float);
    }
    return image;
}

struct hf_depth picture_depth(const struct picture *z)
{
    return (struct hf_depth){
        .size = sizeof(struct hf_depth), .data = z->plane[0], .stride = z->width * (ptrdiff_t)sizeof(float)};
}

struct rng rng_seed(uint64_t seed)
{
    struct rng r = {seed * 0x9e3779b97f4a7c15u + 0x1234567u};
    r.state |= 1;
    for (int i = 0; i < 8; i++)
        rng_u32(&r);
    return r;
}

uint32_t rng_u32(struct rng *r)
{
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return (uint32_t)(r->state * 0x2545f4914f6cdd1du >> 32);
}

int rng_below(struct rng *r, int n)
{
    return (int)(rng_u32(r) % (uint32_t)n);
}

float rng_float(struct rng *r)
{
    return (float)(rng_u32(r) >> 8) * 0x1p-24f;
}

float rng_range(struct rng *r, float low, float high)
{
    return low + (high - low) * rng_float(r);
}

// Formats.

double half_to_double(uint16_t bits)
{
    const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
    const double sign = bits >> 15 ? -1 : 1;
    if (exponent == 31)
        return mantissa ? NAN : sign * INFINITY;
    return sign * (exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24));
}

// Convert a magnitude to exponent and mantissa bits, rounded to nearest even, at most the largest finite number.
static uint32_t small_float(double v, int mantissa_bits)
{
    const uint32_t largest = (31u << mantissa_bits) - 1;
    if (v >= 65536)
        return largest;
    const int exponent = v > 0 ? (int)fmax(ilogb(v), -14) : -14;
    // A denormal has the step of exponent -14 and the bits of exponent 0. A carry into the exponent gives the right
    // result.
    const double steps = nearbyint(ldexp(v, mantissa_bits - exponent));
    const uint32_t bits = (uint32_t)steps + ((uint32_t)(exponent + 14) << mantissa_bits);
    return bits > largest ? largest : bits;
}

uint16_t double_to_half(double v)
{
    if (isnan(v))
        return 0x7e00;
    return (uint16_t)(small_float(fabs(v), 10) | (signbit(v) ? 0x8000u : 0));
}

double uf_to_double(uint32_t bits, int mantissa_bits)
{
    const uint32_t exponent = bits >> mantissa_bits & 31, mantissa = bits & ((1u << mantissa_bits) - 1);
    if (exponent == 31)
        return mantissa ? NAN : INFINITY;
    return exponent ? ldexp(mantissa + (1u << mantissa_bits), (int)exponent - 15 - mantissa_bits)
                    : ldexp(mantissa, -14 - mantissa_bits);
}

static uint32_t pack_r11g11b10(const float c[4])
{
    uint32_t bits[3];
    for (int i = 0; i < 3; i++)
        bits[i] = c[i] > 0 ? small_float(c[i], i == 2 ? 5 : 6) : 0;
    return bits[0] | bits[1] << 11 | bits[2] << 22;
}

int format_channels(enum hf_format format)
{
    return format == HF_FORMAT_RGB32F || format == HF_FORMAT_R11G11B10F ? 3 : 4;
}

int format_pixel_size(enum hf_format format)
{
    switch (format) {
    case HF_FORMAT_RGBA32F:
        return 16;
    case HF_FORMAT_RGB32F:
        return 12;
    case HF_FORMAT_RGBA16F:
        return 8;
    case HF_FORMAT_R11G11B10F:
    case HF_FORMAT_PLANAR32F:
        return 4;
    default:
        return 0;  // tests/api/formats.c tests the integer formats
    }
}

struct packed packed_new(int width, int height, enum hf_format format, int with_alpha, ptrdiff_t extra, int negative,
                         int offset, unsigned char junk)
{
    struct packed p = {.image = {.size = sizeof p.image, .width = width, .height = height, .format = format}};
    const int planes = format != HF_FORMAT_PLANAR32F ? 1 : with_alpha ? 4 : 3;
    for (int i = 0; i < planes; i++) {
        const ptrdiff_t stride = width * (ptrdiff_t)format_pixel_size(format) + extra;
        p.size[i] = (size_t)(stride * height) + 64;
        p.memory[i] = must(malloc(p.size[i]));
        memset(p.memory[i], junk, p.size[i]);
        p.image.data[i] = p.memory[i] + offset + (negative ? stride * (height - 1) : 0);
        p.image.stride[i] = negative ? -stride : stride;
    }
    return p;
}

void packed_free(struct packed *p)
{
    for (int i = 0; i < 4; i++)
        free(p->memory[i]);
    *p = (struct packed){0};
}

static unsigned char *row_of(const struct hf_image *image, int plane, int y)
{
    return (unsigned char *)image->data[plane] + y * image->stride[plane];
}

static void write_pixel(const struct hf_image *image, int x, int y, const float c[4])
{
    unsigned char *to = row_of(image, 0, y) + x * (ptrdiff_t)format_pixel_size(image->format);
    if (image->format == HF_FORMAT_PLANAR32F) {
        for (int i = 0; i < 4 && image->data[i]; i++)
            memcpy(row_of(image, i, y) + x * 4, &c[i], 4);
    } else if (image->format == HF_FORMAT_R11G11B10F) {
        const uint32_t bits = pack_r11g11b10(c);
        memcpy(to, &bits, 4);
    } else if (image->format == HF_FORMAT_RGBA16F) {
        for (int i = 0; i < 4; i++) {
            const uint16_t bits = double_to_half(c[i]);
            memcpy(to + 2 * i, &bits, 2);
        }
    } else {
        memcpy(to, c, (size_t)format_pixel_size(image->format));
    }
}

void packed_write(struct packed *p, const struct picture *from)
{
    for (int y = 0; y < from->height; y++) {
        for (int x = 0; x < from->width; x++) {
            float c[4] = {0, 0, 0, 1};
            for (int i = 0; i < from->channels; i++)
                c[i] = from->plane[i][y * from->width + x];
            write_pixel(&p->image, x, y, c);
        }
    }
}

static void read_pixel(const struct hf_image *image, int x, int y, float c[4])
{
    const unsigned char *from = row_of(image, 0, y) + x * (ptrdiff_t)format_pixel_size(image->format);
    if (image->format == HF_FORMAT_PLANAR32F) {
        for (int i = 0; i < 4 && image->data[i]; i++)
            memcpy(&c[i], row_of(image, i, y) + x * 4, 4);
    } else if (image->format == HF_FORMAT_R11G11B10F) {
        uint32_t bits;
        memcpy(&bits, from, 4);
        c[0] = (float)uf_to_double(bits & 2047, 6);
        c[1] = (float)uf_to_double(bits >> 11 & 2047, 6);
        c[2] = (float)uf_to_double(bits >> 22, 5);
    } else if (image->format == HF_FORMAT_RGBA16F) {
        for (int i = 0; i < 4; i++) {
            uint16_t bits;
            memcpy(&bits, from + 2 * i, 2);
            c[i] = (float)half_to_double(bits);
        }
    } else {
        memcpy(c, from, (size_t)format_pixel_size(image->format));
    }
}

struct picture packed_read(const struct packed *p)
{
    const int planar = p->image.format == HF_FORMAT_PLANAR32F;
    const int channels = planar ? (p->image.data[3] ? 4 : 3) : format_channels(p->image.format);
    struct picture out = picture_new(p->image.width, p->image.height, channels);
    for (int y = 0; y < out.height; y++) {
        for (int x = 0; x < out.width; x++) {
            float c[4] = {0, 0, 0, 1};
            read_pixel(&p->image, x, y, c);
            for (int i = 0; i < channels; i++)
                out.plane[i][y * out.width + x] = c[i];
        }
    }
    return out;
}

int packed_junk_intact(const struct packed *p, unsigned char junk)
{
    const size_t row = (size_t)p->image.width * (size_t)format_pixel_size(p->image.format);
    for (int i = 0; i < 4 && p->memory[i]; i++) {
        unsigned char *pixels = must(calloc(p->size[i], 1));
        for (int y = 0; y < p->image.height; y++)
            memset(pixels + (row_of(&p->image, i, y) - p->memory[i]), 1, row);
        int intact = 1;
        for (size_t k = 0; k < p->size[i]; k++)
            if (!pixels[k] && p->memory[i][k] != junk)
                intact = 0;
        free(pixels);
        if (!intact)
            return 0;
    }
    return 1;
}

static double display(double v)
{
    v = v > 0 ? (v < 1 ? v : 1) : 0;
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

double display_psnr(const struct picture *a, const struct picture *b)
{
    double sum = 0;
    const size_t n = (size_t)a->width * (size_t)a->height;
    for (int c = 0; c < 3; c++) {
        for (size_t i = 0; i < n; i++) {
            const double d = display(a->plane[c][i]) - display(b->plane[c][i]);
            sum += d * d;
        }
    }
    return -10 * log10(sum / (3 * (double)n));
}

int picture_same_bits(const struct picture *a, const struct picture *b)
{
    for (int c = 0; c < a->channels; c++)
        if (memcmp(a->plane[c], b->plane[c], sizeof(float) * (size_t)a->width * (size_t)a->height) != 0)
            return 0;
    return a->channels == b->channels;
}
