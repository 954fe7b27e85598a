// SPDX-License-Identifier: BSD-3-Clause
// One of each way in which a frame is made: every engine, with the settings that lead it through other passes.
#ifndef HF_TESTS_LOOKS_H
#define HF_TESTS_LOOKS_H

#include "hyperfocal/hyperfocal.h"

struct look {
    const char *name;
    enum hf_engine engine;
    enum hf_resolution resolution;  // of hexagon, scatter and gaussian
    float max_radius;               // HF_DERIVE: as the engine has it
    enum hf_fill fill;              // chapter
    int faithful;                   // chapter, gaussian
    enum hf_layers_quality quality;
    float sigma;  // gaussian; 0: iterations
    int blades;
    float ring, cat_eye, chromatic;
    int lens;  // else the range model
};

static const struct look looks[] = {
    {"gather", HF_ENGINE_GATHER, .max_radius = HF_DERIVE},
    {"gather lens", HF_ENGINE_GATHER, .max_radius = HF_DERIVE, .lens = 1},
    {"chapter", HF_ENGINE_CHAPTER, .max_radius = 14, .fill = HF_FILL_MAX, .blades = 5},
    {"chapter faithful", HF_ENGINE_CHAPTER, .max_radius = 12, .fill = HF_FILL_MAX, .faithful = 1},
    {"hexagon", HF_ENGINE_HEXAGON, .max_radius = 14},
    {"hexagon half", HF_ENGINE_HEXAGON, HF_RESOLUTION_HALF, .max_radius = HF_DERIVE, .lens = 1},
    {"scatter", HF_ENGINE_SCATTER, .max_radius = 10},
    {"scatter lens", HF_ENGINE_SCATTER, .max_radius = HF_DERIVE, .cat_eye = 0.5f, .blades = 6, .lens = 1},
    {"scatter half", HF_ENGINE_SCATTER, HF_RESOLUTION_HALF, .max_radius = 40, .chromatic = 0.1f},
    {"gaussian", HF_ENGINE_GAUSSIAN, .max_radius = 12},
    {"gaussian quarter", HF_ENGINE_GAUSSIAN, HF_RESOLUTION_QUARTER, .max_radius = 12, .faithful = 1},
    {"gaussian sigma", HF_ENGINE_GAUSSIAN, HF_RESOLUTION_HALF, .max_radius = 12, .sigma = 9},
    {"layers", HF_ENGINE_LAYERS, .max_radius = 10},
    {"layers draft", HF_ENGINE_LAYERS, .max_radius = 30, .quality = HF_LAYERS_DRAFT, .ring = 0.4f},
    {"layers best", HF_ENGINE_LAYERS, .max_radius = HF_DERIVE, .quality = HF_LAYERS_BEST, .lens = 1},
    {"layers cat's eye", HF_ENGINE_LAYERS, .max_radius = 12, .cat_eye = 0.7f, .chromatic = 0.1f},
};
enum { LOOKS = sizeof looks / sizeof *looks };

// Radii of a lens, for depths of tests/support/random_scene.h, are up to about `reach` pixels in a picture of this width.
static inline struct hf_params look_params(const struct look *l, int width, float reach)
{
    struct hf_params p = hf_default_params();
    p.engine = l->engine;
    p.focus = 20;
    p.range.distance = 10;
    p.max_radius = l->max_radius;
    p.hexagon.resolution = p.scatter.resolution = p.gaussian.resolution = l->resolution;
    p.chapter.fill = l->fill;
    p.chapter.faithful = p.gaussian.faithful = l->faithful;
    p.layers.quality = l->quality;
    p.gaussian.sigma = l->sigma > 0 ? l->sigma : HF_DERIVE;
    p.aperture.blades = l->blades;
    p.aperture.ring = l->ring;
    p.aperture.cat_eye = l->cat_eye;
    p.aperture.chromatic = l->chromatic;
    if (l->lens) {
        // r(z) = K (1 / focus - 1 / z) grows beyond all bounds near z = 0, and to K / focus behind: that is a fifth of it.
        p.model = HF_MODEL_LENS;
        p.lens.focal_length_mm = 50;
        p.lens.f_number = 0.05f * 50 * (float)width / 36 / (2 * 20 * reach / 5);
    }
    return p;
}

#endif
