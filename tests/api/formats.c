// SPDX-License-Identifier: BSD-3-Clause
// Pictures and depths of whole numbers: what a code means, that it comes back as itself, and that a frame in any such
// format is the frame of the floats it stands for, rounded once on the way out, in place as well.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hyperfocal/hyperfocal.h"
#include "support/check.h"
#include "tools/common/report.h"

enum { WIDTH = 61, HEIGHT = 23, PIXELS = WIDTH * HEIGHT, FORMATS = 6, DEPTHS = 5 };

static const struct {
    enum hf_format format;
    int bytes, channels;
    int bits[4], shift[4];
} formats[FORMATS] = {
    {HF_FORMAT_RGBA8, 4, 4, {8, 8, 8, 8}, {0, 8, 16, 24}},
    {HF_FORMAT_BGRA8, 4, 4, {8, 8, 8, 8}, {16, 8, 0, 24}},
    {HF_FORMAT_RGBX8, 4, 3, {8, 8, 8, 8}, {0, 8, 16, 24}},
    {HF_FORMAT_BGRX8, 4, 3, {8, 8, 8, 8}, {16, 8, 0, 24}},
    {HF_FORMAT_RGB10A2, 4, 4, {10, 10, 10, 2}, {0, 10, 20, 30}},
    {HF_FORMAT_RGBA16, 8, 4, {16, 16, 16, 16}, {0, 16, 32, 48}},
};

static double decode(double v)
{
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double encode(double v)
{
    return v <= 0.0031308 ? v * 12.92 : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static uint64_t pixel_of(const uint8_t *memory, int f, int i)
{
    uint64_t word = 0;
    memcpy(&word, memory + (size_t)i * (size_t)formats[f].bytes, (size_t)formats[f].bytes);
    return word;
}

static double code_of(uint64_t word, int f, int c)
{
    return (double)(word >> formats[f].shift[c] & ((1u << formats[f].bits[c]) - 1));
}

static struct hf_image image_of(void *memory, int f, enum hf_transfer transfer, int width, int height)
{
    return (struct hf_image){.size = sizeof(struct hf_image),
                             .width = width,
                             .height = height,
                             .format = formats[f].format,
                             .data = {memory},
                             .stride = {(ptrdiff_t)width * formats[f].bytes},
                             .transfer = transfer};
}

static struct hf_image floats_of(float *memory, int width, int height)
{
    return (struct hf_image){.size = sizeof(struct hf_image),
                             .width = width,
                             .height = height,
                             .format = HF_FORMAT_RGBA32F,
                             .data = {memory},
                             .stride = {(ptrdiff_t)width * 16}};
}

static uint32_t state = 1;

static uint32_t random_bits(void)
{
    state = state * 1664525u + 1013904223u;
    return state >> 8 ^ state << 13;
}

// Every code of a channel with that many bits, in all channels, through a frame without blur: to floats, and back.
static void check_codes(struct hf_context *c, int f, enum hf_transfer transfer)
{
    const int bits = formats[f].bits[0], width = 1 << (bits < 12 ? bits : 12), height = (1 << bits) / width;
    const size_t n = (size_t)width * (size_t)height;
    uint8_t *codes = calloc(n, 8), *back = calloc(n, 8);
    float *light = calloc(n, 16), *depth = calloc(n, 4);
    for (size_t i = 0; i < n; i++) {
        uint64_t word = 0;
        for (int k = 0; k < 4; k++)
            word |= (uint64_t)(i & ((1u << formats[f].bits[k]) - 1)) << formats[f].shift[k];
        memcpy(codes + i * (size_t)formats[f].bytes, &word, (size_t)formats[f].bytes);
        depth[i] = 10;
    }
    const struct hf_image in = image_of(codes, f, transfer, width, height), floats = floats_of(light, width, height);
    const struct hf_image out = image_of(back, f, transfer, width, height);
    const struct hf_depth z = {.size = sizeof z, .data = depth, .stride = (ptrdiff_t)width * 4};
    CHECK(hf_render(c, &floats, &in, &z, NULL) == HF_OK);
    CHECK(hf_render(c, &out, &floats, &z, NULL) == HF_OK);
    // The polynomial's 3e-7, and the roundings of two roots and of eight products and sums: 16 half places of 2^-24
    // each.
    const double bound = 3e-7 + 16 * 0x1p-24;
    double worst = 0;
    int same = 1;
    for (size_t i = 0; i < n; i++) {
        const uint64_t word = pixel_of(codes, f, (int)i), again = pixel_of(back, f, (int)i);
        for (int k = 0; k < formats[f].channels; k++) {
            const double v = code_of(word, f, k) / ((1 << formats[f].bits[k]) - 1);
            const double want = k < 3 && transfer == HF_TRANSFER_SRGB ? decode(v) : v;
            worst = fmax(worst, fabs((double)light[4 * i + (size_t)k] - want) / fmax(want, 1e-4));
            same = same && code_of(word, f, k) == code_of(again, f, k);
        }
        CHECK(formats[f].channels == 4 || (light[4 * i + 3] == 1 && code_of(again, f, 3) == 255));
    }
    CHECK(worst <= bound);
    CHECK(same);
    free(codes);
    free(back);
    free(light);
    free(depth);
}

static struct hf_params blurred(void)
{
    struct hf_params p = hf_default_params();
    p.focus = 10;
    p.range.distance = 4;
    p.max_radius = 6;
    return p;
}

// A byte without meaning is written as 255, whether a tile is sharp or blurred.
static void check_meaningless(const uint8_t *codes, int f, const char *what)
{
    int others = 0;
    if (formats[f].format != HF_FORMAT_RGBX8 && formats[f].format != HF_FORMAT_BGRX8)
        return;
    for (int i = 0; i < PIXELS; i++)
        others += codes[4 * i + 3] != 255;
    CHECK_MSG(!others, "format %d, %s: %d bytes without meaning are not 255", f, what, others);
}

// A frame out of place and in place compared with the same frame in floats, with or without restored highlights.
static void check_frame(struct hf_context *c, int f, enum hf_transfer transfer, float gain)
{
    uint8_t *codes = malloc(PIXELS * 8), *out = malloc(PIXELS * 8);
    float *light = malloc(PIXELS * 16), *want = malloc(PIXELS * 16), *depth = malloc(PIXELS * 4),
          *far = malloc(PIXELS * 4);
    for (int i = 0; i < PIXELS; i++) {
        const uint64_t word = (uint64_t)random_bits() << 32 | random_bits();
        memcpy(codes + (size_t)i * (size_t)formats[f].bytes, &word, (size_t)formats[f].bytes);
        depth[i] = 4 + 12 * (float)(random_bits() & 0xffff) / 65536;
        far[i] = 10;
    }
    const struct hf_image in = image_of(codes, f, transfer, WIDTH, HEIGHT),
                          copy = image_of(out, f, transfer, WIDTH, HEIGHT);
    const struct hf_image floats = floats_of(light, WIDTH, HEIGHT), blur = floats_of(want, WIDTH, HEIGHT);
    const struct hf_depth z = {.size = sizeof z, .data = depth, .stride = WIDTH * 4},
                          sharp = {.size = sizeof sharp, .data = far, .stride = WIDTH * 4};
    struct hf_params p = blurred();
    p.highlight.gain = gain;
    CHECK(hf_render(c, &floats, &in, &sharp, &p) == HF_OK);  // only to floats
    CHECK(hf_render(c, &blur, &floats, &z, &p) == HF_OK);
    CHECK(hf_render(c, &copy, &in, &sharp, &p) == HF_OK);
    check_meaningless(out, f, "all sharp");
    CHECK(hf_render(c, &copy, &in, &z, &p) == HF_OK);
    check_meaningless(out, f, "blurred");
    CHECK(hf_render(c, &in, &in, &z, &p) == HF_OK);
    CHECK(!memcmp(codes, out, (size_t)PIXELS * (size_t)formats[f].bytes));
    double worst = 0;
    for (int i = 0; i < PIXELS; i++)
        for (int k = 0; k < formats[f].channels; k++) {
            const double max = (1 << formats[f].bits[k]) - 1, v = fmin(fmax((double)want[4 * i + k], 0), 1);
            const double exact = max * (k < 3 && transfer == HF_TRANSFER_SRGB ? encode(v) : v);
            worst = fmax(worst, fabs(code_of(pixel_of(out, f, i), f, k) - exact) - 0.5 - 2e-6 * max);
        }
    // Half a code of rounding, plus the error of the encoder's polynomial (5e-7) and its roundings (24 of 2^-24).
    CHECK(worst <= 0);
    free(codes);
    free(out);
    free(light);
    free(want);
    free(depth);
    free(far);
}

static const enum hf_depth_format depths[DEPTHS] = {HF_DEPTH_FORMAT_FLOAT16, HF_DEPTH_FORMAT_UNORM16,
                                                    HF_DEPTH_FORMAT_UNORM32, HF_DEPTH_FORMAT_D24S8,
                                                    HF_DEPTH_FORMAT_X8D24};

// The float that a depth word stands for; halves are made so that they are exact.
static float depth_of(int d, uint32_t word)
{
    switch (depths[d]) {
    case HF_DEPTH_FORMAT_FLOAT16:
        return ldexpf((float)(1024 + (word & 1023)), (int)(word >> 10 & 31) - 25);
    case HF_DEPTH_FORMAT_UNORM16:
        return (float)(word & 0xffff) * (1 / 65535.0f);
    case HF_DEPTH_FORMAT_D24S8:
        return (float)(word >> 8) * (1 / 16777215.0f);
    case HF_DEPTH_FORMAT_X8D24:
        return (float)(word & 0xffffff) * (1 / 16777215.0f);
    default:
        return (float)word * (1 / 4294967295.0f);
    }
}

// The same bits as with float depth, for every engine.
static void check_depth(struct hf_context *c, int d, enum hf_engine engine)
{
    const size_t bytes = d < 2 ? 2 : 4;
    uint8_t *words = malloc(PIXELS * bytes + 1);
    float *z = malloc(PIXELS * 4), *picture = malloc(PIXELS * 16), *a = malloc(PIXELS * 16), *b = malloc(PIXELS * 16);
    for (int i = 0; i < PIXELS; i++) {
        // Halves from 0.25 to 8; other formats near 1, where window depth is.
        const uint32_t word = d == 0 ? (random_bits() & 1023) | (13 + random_bits() % 5) << 10
                                     : 0xffffffffu - (random_bits() & 0x1fffffffu);
        memcpy(words + 1 + (size_t)i * bytes, &word, bytes);
        z[i] = depth_of(d, d == 0 ? word : bytes == 2 ? word & 0xffff : word);
        for (int k = 0; k < 4; k++)
            picture[4 * i + k] = (float)(random_bits() & 1023) / 1023;
    }
    const struct hf_image in = floats_of(picture, WIDTH, HEIGHT), one = floats_of(a, WIDTH, HEIGHT),
                          two = floats_of(b, WIDTH, HEIGHT);
    struct hf_depth exact = {.size = sizeof exact, .data = z, .stride = WIDTH * 4, .near_plane = 0.5f, .far_plane = 50};
    exact.type = d == 0 ? HF_DEPTH_VIEW : HF_DEPTH_NDC_D3D;
    struct hf_depth stored = exact;
    stored.data = words + 1;
    stored.stride = (ptrdiff_t)(WIDTH * bytes);
    stored.format = depths[d];
    struct hf_params p = blurred();
    p.engine = engine;
    p.focus = 3;
    p.range.distance = 2;
    float at_exact = 0, at_stored = 0;
    CHECK(hf_render(c, &one, &in, &exact, &p) == HF_OK);
    CHECK(hf_render(c, &two, &in, &stored, &p) == HF_OK);
    CHECK(!memcmp(a, b, PIXELS * 16));
    CHECK(memcmp(a, picture, PIXELS * 16) != 0);
    CHECK(hf_depth_at(&exact, WIDTH, HEIGHT, 7, 5, &at_exact, NULL) ==
          hf_depth_at(&stored, WIDTH, HEIGHT, 7, 5, &at_stored, NULL));
    CHECK(at_exact == at_stored);
    free(words);
    free(z);
    free(picture);
    free(a);
    free(b);
}

static void check_refusals(struct hf_context *c)
{
    float pixel[4] = {0}, z = 1;
    struct hf_image image = floats_of(pixel, 1, 1);
    struct hf_depth depth = {.size = sizeof depth, .data = &z, .stride = 4};
    image.transfer = HF_TRANSFER_SRGB;
    CHECK(hf_render(c, &image, &image, &depth, NULL) == HF_ERR_ARG);
    image.transfer = (enum hf_transfer)7;
    CHECK(hf_render(c, &image, &image, &depth, NULL) == HF_ERR_ARG);
    image.transfer = HF_TRANSFER_LINEAR;
    depth.format = (enum hf_depth_format)9;
    CHECK(hf_render(c, &image, &image, &depth, NULL) == HF_ERR_ARG);
    depth.format = HF_DEPTH_FORMAT_UNORM16;
    depth.stride = 1;
    CHECK(hf_render(c, &image, &image, &depth, NULL) == HF_ERR_ARG);
}

static void count_warnings(void *cookie, const struct hf_message *message)
{
    *(int *)cookie += message->level == HF_LOG_WARNING && !strcmp(message->argument, "depth.type");
}

// A warning about integers taken for distances comes once, and only where they cannot be distances.
static void check_warning(void)
{
    float pixel[4] = {0};
    const uint32_t z = UINT32_MAX;
    int warned = 0;
    const struct hf_config config = {.size = sizeof config, .threads = 1, .log = count_warnings, .log_cookie = &warned};
    struct hf_image image = floats_of(pixel, 1, 1);
    struct hf_depth depth = {.size = sizeof depth, .data = &z, .stride = 4, .format = HF_DEPTH_FORMAT_UNORM16};
    struct hf_params p = hf_default_params();
    struct hf_context *c;
    CHECK(hf_open(&c, &config) == HF_OK);
    p.focus = 0.5f;  // something may be in focus
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 0);
    p.focus = 10;
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 1);
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 1);
    depth.format = HF_DEPTH_FORMAT_D24S8;  // another mistake
    p.focus = 0.5f;
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 2);
    depth.near_plane = 1;
    depth.far_plane = 10;
    depth.type = HF_DEPTH_NDC_D3D;
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 2);
    depth = (struct hf_depth){.size = sizeof(struct hf_depth), .data = &p.focus, .stride = 4};
    CHECK(hf_render(c, &image, &image, &depth, &p) == HF_OK && warned == 2);
    hf_close(&c);
}

int main(void)
{
    check_warning();

    for (enum hf_isa isa = HF_ISA_SCALAR; isa <= HF_ISA_NEON; isa++) {
        const struct hf_config config = {.size = sizeof config, .isa = isa, .threads = 2};
        struct hf_context *c;
        if (!hf_isa_available(isa) || hf_open(&c, &config) != HF_OK)
            continue;
        for (int f = 0; f < FORMATS; f++)
            for (int transfer = HF_TRANSFER_LINEAR; transfer <= HF_TRANSFER_SRGB; transfer++) {
                check_codes(c, f, (enum hf_transfer)transfer);
                check_frame(c, f, (enum hf_transfer)transfer, 1);
                check_frame(c, f, (enum hf_transfer)transfer, 8);
            }
        for (int d = 0; d < DEPTHS; d++)
            for (int e = 0; e < tool_engines(); e++)
                check_depth(c, d, (enum hf_engine)e);
        check_refusals(c);
        hf_close(&c);
    }
    return check_report();
}
