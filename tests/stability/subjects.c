// SPDX-License-Identifier: BSD-3-Clause
#include "stability/stability.h"

#include <float.h>

// How far a pixel of gather and chapter reads, in pixels: two radii of the near CoC, the taps, the fill and the upsampling, each in
// half-resolution pixels.
static int fields_margin(void)
{
    const int h = (int)ceilf(STABILITY_RADIUS / 2);
    return 2 * (2 * h + h + 4);
}

// Twice the lattice's weights (making and adding them), 12 for the blurred CoC, 32 for downsampling and fill, 11 and
// 102 for the composite: tests/engines/chapter.c derives them.
enum { FIELDS_ROUNDINGS = 2 * 129 + 12 + 32 + 11 + 102 };

static struct subject fields(const char *name, enum hf_engine engine, enum hf_storage storage)
{
    struct subject s = {name,
                        scene_params(),
                        EXPOSES | FLIPS_QUADS | TRANSPOSES | PERMUTES | EXACT,
                        fields_margin(),
                        32,
                        FIELDS_ROUNDINGS,
                        0};
    s.params.engine = engine;
    s.params.gather.storage = s.params.chapter.storage = storage;
    if (storage == HF_STORAGE_HALF) {
        s.promises &= ~(unsigned)(EXPOSES | EXACT | TRANSPOSES);
        s.step = 1.0 / 1024;
    }
    if (storage == HF_STORAGE_PACKED) {
        s.promises &= ~(unsigned)(EXPOSES | EXACT | TRANSPOSES | PERMUTES);
        s.step = 1.0 / 32;
    }
    return s;
}

static struct subject gather(const char *name, enum hf_storage storage)
{
    struct subject s = fields(name, HF_ENGINE_GATHER, storage);
    s.promises |= KEEPS_ENERGY | ADDS | SMOOTH;
    return s;
}

static struct subject chapter(const char *name, enum hf_fill fill, enum hf_storage storage)
{
    struct subject s = fields(name, HF_ENGINE_CHAPTER, storage);
    s.params.chapter.fill = fill;
    if (fill == HF_FILL_NONE)
        s.promises |= KEEPS_ENERGY | ADDS;
    return s;
}

static struct subject hexagon(const char *name, enum hf_resolution resolution)
{
    // A line of n taps rounds its sum of weights n times and its weighted sum 2 n times, and 30 times besides; the
    // divisor is at least a quarter, in each of two passes (tests/engines/hexagon.c). Mixed pixels read 4 pixels more,
    // as in the scatter engine. Where far radii differ, light decides which radius wins; so pictures add only if all
    // have one radius.
    const double taps = 4 * (STABILITY_RADIUS + 4);
    struct subject s = {name,
                        scene_params(),
                        EXPOSES | PERMUTES | EXACT | KEEPS_ENERGY | ADDS_ONE_RADIUS,
                        2 * (int)STABILITY_RADIUS + 8 + 4,
                        2 * 2 * (taps + 16),
                        2 * 4 * (3 * taps + 30),
                        0};
    s.params.engine = HF_ENGINE_HEXAGON;
    s.params.hexagon.resolution = resolution;
    if (!resolution)
        s.promises |= SMOOTH;
    return s;
}

static struct subject scatter(const char *name, enum hf_resolution resolution)
{
    // 40: tests/engines/scatter.c derives it. Half resolution adds 8 for downsampling and 12 for upsampling. Shares of
    // mixed pixels add 16 times 50, and 2^-20 of a pixel. A share is a quotient of colours, so pictures add only where
    // no pixel is mixed. A mixed pixel reads two pixels around it, and those read one more: 4, as the frame is cut at
    // whole quads.
    const double shares = 16 * 50 + 16;
    struct subject s = {name,
                        scene_params(),
                        EXPOSES | PERMUTES | EXACT | KEEPS_ENERGY | ADDS_ONE_SURFACE | FLIPS | FLIPS_EVEN | TRANSPOSES |
                            KEEPS_CENTRE | SMOOTH,
                        (int)STABILITY_RADIUS + 8 + 4,
                        32,
                        (resolution ? 60 : 40) + shares,
                        0};
    s.params.engine = HF_ENGINE_SCATTER;
    s.params.scatter.resolution = resolution;
    if (resolution)
        s.promises = (s.promises & ~(unsigned)FLIPS) | FLIPS_QUADS;
    return s;
}

// 34: tests/engines/layers.c derives it. Colours of hidden samples are squares of means of roots, and sums of
// brightness depend on the order of channels: so pictures times a factor, or with channels exchanged, may have other
// bits. Un-mixing is not linear, so pictures do not add.
// Margin: a radius, 4 pixels of half resolution at its end, 30 for hidden samples, which four levels find where radii
// differ by 24, 12 for their means, 4 for un-mixing, and the mean around a highlight.
// A cat's eye has another shape at every place; that has its own test.
static struct subject layers(const char *name, const struct hf_aperture_params *aperture)
{
    struct subject s = {name,
                        scene_params(),
                        EXACT | KEEPS_ENERGY | KEEPS_CENTRE | UNMIXES,
                        (int)STABILITY_RADIUS + 4 + 30 + 12 + 4 + 2,
                        34,
                        60,
                        0};
    s.params.engine = HF_ENGINE_LAYERS;
    s.params.aperture = *aperture;
    return s;
}

static struct subject gaussian(const char *name, float sigma, enum hf_resolution resolution)
{
    // Four boxes of about 1.73 sigma reach 3.5 sigma to either side; or each iteration reaches two pixels.
    const int margin = sigma > 0 ? (int)(4 * sigma) + 8 : 2 * 3 * (resolution ? 4 : 1) + 8;
    struct subject s = {name,
                        scene_params(),
                        EXPOSES | PERMUTES | EXACT | KEEPS_ENERGY | ADDS | TRANSPOSES | KEEPS_CENTRE | FLIPS,
                        margin,
                        32,
                        2 * (3 * 5 * 2 + 16),
                        0};
    s.params.engine = HF_ENGINE_GAUSSIAN;
    s.params.gaussian.sigma = sigma > 0 ? sigma : HF_DERIVE;
    s.params.gaussian.resolution = resolution;
    if (resolution)
        s.promises = (s.promises & ~(unsigned)FLIPS) | FLIPS_QUADS;
    return s;
}

static struct subject per_pixel(void)
{
    struct subject s = gather("gather per pixel", HF_STORAGE_FLOAT);
    s.params.gather.per_pixel_kernel = 1;
    // In a quad with several far radii the light decides on one.
    s.promises = (s.promises & ~(unsigned)ADDS) | ADDS_ONE_RADIUS;
    return s;
}

static struct subject faithful(void)
{
    struct subject s = chapter("chapter faithful", HF_FILL_MAX, HF_STORAGE_FLOAT);
    s.params.chapter.faithful = 1;
    // Its taps without a far colour count as black, and it compares the CoC of one quad with the colour of another.
    s.promises &= ~(unsigned)(FLIPS_QUADS | TRANSPOSES);
    return s;
}

enum { SUBJECTS = 16 };

int subject_count(void)
{
    return SUBJECTS;
}

struct subject subject_make(int index)
{
    switch (index) {
    case 0:
        return gather("gather", HF_STORAGE_FLOAT);
    case 1:
        return chapter("chapter", HF_FILL_MAX, HF_STORAGE_FLOAT);
    case 2:
        return chapter("chapter none", HF_FILL_NONE, HF_STORAGE_FLOAT);
    case 3:
        return per_pixel();
    case 4:
        return gather("gather half", HF_STORAGE_HALF);
    case 5:
        return gather("gather packed", HF_STORAGE_PACKED);
    case 14:
        return chapter("chapter packed", HF_FILL_MAX, HF_STORAGE_PACKED);
    case 6:
        return faithful();
    case 7:
        return hexagon("hexagon", HF_RESOLUTION_FULL);
    case 8:
        return hexagon("hexagon half", HF_RESOLUTION_HALF);
    case 9:
        return scatter("scatter", HF_RESOLUTION_FULL);
    case 10:
        return scatter("scatter half", HF_RESOLUTION_HALF);
    case 11:
        return gaussian("gaussian", 0, HF_RESOLUTION_FULL);
    case 12:
        return layers("layers", &(struct hf_aperture_params){.squeeze = 1});
    case 13:
        return layers("layers ring", &(struct hf_aperture_params){.squeeze = 1, .blades = 6, .ring = 0.4f});
    default:
        return gaussian("gaussian sigma", 4, HF_RESOLUTION_FULL);
    }
}
