// SPDX-License-Identifier: BSD-3-Clause
// Each engine as its users see it: every quality, every aperture. The cases of pulls.c, local.c, pairs.c and lamps.c run over
// them, in codes of a display; subjects.c has those whose bits and roundings are counted.
#include "stability/stability.h"

struct look_row {
    const char *name;
    enum hf_engine engine;
    unsigned promises;  // MIRRORS, TURNS
    enum hf_layers_quality quality;
    enum hf_resolution resolution;
    enum hf_fill fill;
    struct hf_aperture_params aperture;
    float sigma;
    int picture, views;
};

#define PLAIN .squeeze = 1
enum { BOTH = MIRRORS | TURNS };

static const struct look_row table[] = {
    {"gather", HF_ENGINE_GATHER, BOTH, .aperture = {PLAIN}},
    {"gather ngon", HF_ENGINE_GATHER, 0, .aperture = {PLAIN, .blades = 5, .rotation = 20}},
    {"chapter", HF_ENGINE_CHAPTER, BOTH, .aperture = {PLAIN}},
    {"chapter mean", HF_ENGINE_CHAPTER, BOTH, .fill = HF_FILL_MEAN, .aperture = {PLAIN}},
    {"chapter none", HF_ENGINE_CHAPTER, 0, .fill = HF_FILL_NONE, .aperture = {PLAIN, .blades = 7}},
    {"hexagon", HF_ENGINE_HEXAGON, MIRRORS, .aperture = {PLAIN}},
    {"hexagon turned", HF_ENGINE_HEXAGON, 0, .aperture = {PLAIN, .rotation = 17}},
    {"hexagon half", HF_ENGINE_HEXAGON, 0, .resolution = HF_RESOLUTION_HALF, .aperture = {PLAIN}},
    {"scatter", HF_ENGINE_SCATTER, BOTH, .aperture = {PLAIN}},
    {"scatter ngon", HF_ENGINE_SCATTER, 0, .aperture = {PLAIN, .blades = 6, .roundness = 0.3f}},
    {"scatter ring", HF_ENGINE_SCATTER, BOTH, .aperture = {PLAIN, .ring = 0.45f}},
    {"scatter cat's eye", HF_ENGINE_SCATTER, BOTH, .aperture = {PLAIN, .cat_eye = 0.6f}},
    {"scatter picture", HF_ENGINE_SCATTER, BOTH, .aperture = {PLAIN}, .picture = 1},
    {"scatter squeeze", HF_ENGINE_SCATTER, MIRRORS, .aperture = {.squeeze = 2, .chromatic = 0.1f}},
    {"scatter half", HF_ENGINE_SCATTER, MIRRORS, .resolution = HF_RESOLUTION_HALF, .aperture = {PLAIN}},
    {"gaussian", HF_ENGINE_GAUSSIAN, BOTH, .aperture = {PLAIN}},
    {"gaussian quarter", HF_ENGINE_GAUSSIAN, 0, .resolution = HF_RESOLUTION_QUARTER, .aperture = {PLAIN}},
    {"gaussian sigma", HF_ENGINE_GAUSSIAN, BOTH, .sigma = 4, .aperture = {PLAIN}},
    {"layers draft", HF_ENGINE_LAYERS, BOTH, HF_LAYERS_DRAFT, .aperture = {PLAIN}},
    {"layers", HF_ENGINE_LAYERS, BOTH, HF_LAYERS_STANDARD, .aperture = {PLAIN}},
    {"layers high", HF_ENGINE_LAYERS, BOTH, HF_LAYERS_HIGH, .aperture = {PLAIN}},
    {"layers best", HF_ENGINE_LAYERS, 0, HF_LAYERS_BEST, .aperture = {PLAIN}},
    {"layers views", HF_ENGINE_LAYERS, 0, .views = 96, .aperture = {PLAIN}},
    {"layers ngon", HF_ENGINE_LAYERS, 0, .aperture = {PLAIN, .blades = 6, .roundness = 0.3f}},
    {"layers ring", HF_ENGINE_LAYERS, BOTH, .aperture = {PLAIN, .ring = 0.45f}},
    {"layers cat's eye", HF_ENGINE_LAYERS, BOTH, .aperture = {PLAIN, .cat_eye = 0.6f}},
    {"layers picture", HF_ENGINE_LAYERS, BOTH, .aperture = {PLAIN}, .picture = 1},
    {"layers squeeze", HF_ENGINE_LAYERS, MIRRORS, .aperture = {.squeeze = 2, .chromatic = 0.1f}},
};

// A soft round picture with a dark spot in the middle.
static const struct hf_image *aperture_picture(void)
{
    enum { SIZE = 24 };
    static float plane[SIZE * SIZE];
    static struct hf_image image;
    for (int i = 0; i < SIZE * SIZE; i++) {
        const double r = hypot(i % SIZE - (SIZE - 1) / 2.0, i / SIZE - (SIZE - 1) / 2.0) / (SIZE / 2.0);
        plane[i] = r > 1 ? 0 : (float)(1 - 0.5 * r * r) * (r < 0.25 ? 0.3f : 1);
    }
    const struct picture p = {SIZE, SIZE, 3, {plane, plane, plane, NULL}};
    image = picture_image(&p);
    return &image;
}

int look_count(void)
{
    return sizeof table / sizeof *table;
}

struct subject look_make(int index)
{
    const struct look_row *l = &table[index];
    struct subject s = {.name = l->name, .params = scene_params(), .promises = l->promises};
    struct hf_params *p = &s.params;
    p->engine = l->engine;
    p->layers.quality = l->quality;
    p->hexagon.resolution = p->scatter.resolution = p->gaussian.resolution = l->resolution;
    p->chapter.fill = l->fill;
    p->layers.lens_points = l->views;
    p->aperture = l->aperture;
    p->gaussian.sigma = l->sigma > 0 ? l->sigma : HF_DERIVE;
    if (l->picture)
        p->aperture.picture = aperture_picture();
    return s;
}
