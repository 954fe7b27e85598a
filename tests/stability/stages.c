// SPDX-License-Identifier: BSD-3-Clause
// Scenes for the cases that run over all looks.
#include "stability/stability.h"

#include <stdlib.h>
#include <string.h>

// A floor through the focus, a wall behind and a bar in front.
static void floor_wall_bar(struct scene *s)
{
    const int w = s->depth.width, h = s->depth.height;
    for (int i = 0; i < w * h; i++) {
        const int x = i % w, y = i / w;
        s->depth.plane[0][i] = y < h / 2 ? 34 : 12 + 16 * (float)(x + 2 * y) / (float)(w + 2 * h);
        if (x >= w / 3 && x < w / 3 + 5)
            s->depth.plane[0][i] = 15.5f;
    }
}

// A card in front of a wall, a thin pole before both, a subject in focus.
static void cards(struct scene *s, struct rng *rng)
{
    const int w = s->depth.width, h = s->depth.height;
    const int x0 = w / 4 + rng_below(rng, 5), y0 = h / 4 + rng_below(rng, 5), pole = w / 2 + rng_below(rng, w / 3);
    const float wall = rng_range(rng, 24, 45), card = rng_range(rng, 10, 17);
    for (int i = 0; i < w * h; i++) {
        const int x = i % w, y = i / w;
        float z = wall;
        if (x > w / 2 && y > h / 2)
            z = STABILITY_FOCUS;
        if (x >= x0 && x < x0 + w / 4 && y >= y0)
            z = card;
        if (x >= pole && x < pole + 2)
            z = 8;
        s->depth.plane[0][i] = z;
    }
}

// Single pixels as bright as lamps.
static void add_lamps(struct scene *s, struct rng *rng)
{
    for (int i = 0; i < 6; i++) {
        const int at = rng_below(rng, (int)samples_of(&s->depth));
        const float light = rng_range(rng, 20, 1000);
        for (int c = 0; c < 3; c++)
            s->colour.plane[c][at] = light * rng_range(rng, 0.5f, 1);
    }
}

struct scene stage_make(enum stage stage, unsigned seed, int width, int height)
{
    struct rng rng = rng_seed(seed + 7000);
    if (stage == STAGE_NOISE) {
        struct scene s = scene_new(&rng, SCENE_BLOCKS, width, height, 3);
        for (int c = 0; c < 3; c++)
            for (size_t i = 0; i < samples_of(&s.colour); i++)
                s.colour.plane[c][i] *= rng_range(&rng, 0.5f, 1.5f);
        return s;
    }
    struct scene s = calm_scene(seed, width, height, 3);
    if (stage == STAGE_FLOOR || stage == STAGE_LAMPS)
        floor_wall_bar(&s);
    if (stage == STAGE_CARDS)
        cards(&s, &rng);
    if (stage == STAGE_LAMPS)
        add_lamps(&s, &rng);
    return s;
}

const char *stage_name(enum stage stage)
{
    static const char *const names[] = {"floor", "cards", "blocks", "noise", "lamps"};
    return names[stage];
}

#ifdef STABILITY_IMAGES
// A part of a picture, where its lights, leaves or bars are. Depth is scaled so that the subject lies at STABILITY_FOCUS.
int stage_picture(int index, int width, int height, struct scene *s, const char **name)
{
    static const struct {
        const char *name;
        int x, y;
        float focus;
    } parts[] = {{"lights", 440, 200, 5}, {"fence", 300, 240, 6}, {"foliage", 420, 180, 4}};
    static const char *const rgb[] = {"R", "G", "B"}, *const z[] = {"Z"};
    char path[4096];
    struct scene all;
    if (index >= (int)(sizeof parts / sizeof *parts))
        return 0;
    *name = parts[index].name;
    snprintf(path, sizeof path, "%s/%s.exr", STABILITY_IMAGES, *name);
    if (exr_read(&all.colour, path, 3, rgb))
        return 0;
    if (exr_read(&all.depth, path, 1, z)) {
        picture_free(&all.colour);
        return 0;
    }
    *s = (struct scene){picture_cut(&all.colour, parts[index].x, parts[index].y, width, height),
                        picture_cut(&all.depth, parts[index].x, parts[index].y, width, height)};
    for (size_t i = 0; i < samples_of(&s->depth); i++)
        s->depth.plane[0][i] *= STABILITY_FOCUS / parts[index].focus;
    scene_free(&all);
    return 1;
}
#else
int stage_picture(int index, int width, int height, struct scene *s, const char **name)
{
    (void)index, (void)width, (void)height, (void)s, (void)name;
    return 0;
}
#endif

void set_lens(struct hf_params *p, int width, float reach)
{
    p->model = HF_MODEL_LENS;
    p->max_radius = HF_DERIVE;
    p->lens.focal_length_mm = 50;
    // r(z) = K (1 / focus - 1 / z): `reach` pixels at a depth of 9, half as much far away.
    p->lens.f_number = 0.05f * 50 * (float)width / 36 / (2 * reach) * (1 / 9.0f - 1 / STABILITY_FOCUS);
}
