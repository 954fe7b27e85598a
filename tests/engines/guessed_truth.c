// SPDX-License-Identifier: BSD-3-Clause
// What is guessed compared with what truly was not seen. The second and third surfaces of a scene say which of them each point of
// the lens sees: every surface is drawn once for each point, displaced by its radius, the nearest in front. The share of points
// that do not see a known surface, or see beyond the frame, has to go with the share that the library says it guessed.
//
//     guessed_truth images     the folder of the ray-traced scenes and their peels
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "hyperfocal/layers.h"
#include "support/check.h"
#include "support/render.h"

enum { SURFACES = 3, POINTS = 32 };

struct view {
    const char *name;
    float focus, f_number;
};

static const struct view scenes[] = {{"fence", 6, 0.46f}, {"foliage", 4, 0.7f}};

// The scene's surfaces, front to back; the first has alpha 1.
struct surfaces {
    struct picture colour[SURFACES], depth[SURFACES];
};

static int read_surfaces(struct surfaces *s, const char *folder, const char *name)
{
    static const char *const rgba[] = {"R", "G", "B", "A"}, *const z[] = {"Z"};
    static const char *const endings[SURFACES] = {"", ".peel1", ".peel2"};
    char path[4096];
    for (int i = 0; i < SURFACES; i++) {
        snprintf(path, sizeof path, "%s/%s%s.exr", folder, name, endings[i]);
        if (exr_read(&s->colour[i], path, 4, rgba) || exr_read(&s->depth[i], path, 1, z))
            return -1;
    }
    return 0;
}

static float radius_of(const struct view *t, int width, float z)
{
    const float focal = 0.05f, aperture = focal / (2 * t->f_number), pixels = focal / 0.036f * (float)width;
    return aperture * pixels * (1 / t->focus - (z < 1e9f ? 1 / z : 0));
}

// Draw a surface as one point of the lens sees it: number, where it is nearer than what is there.
static void draw(const struct surfaces *s, int i, const struct view *t, const float at[2], float *nearest, char *number)
{
    const int width = s->depth[i].width, height = s->depth[i].height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t from = (size_t)y * (size_t)width + (size_t)x;
            const float z = s->depth[i].plane[0][from], r = radius_of(t, width, z);
            const int u = (int)lrintf((float)x + r * at[0]), v = (int)lrintf((float)y + r * at[1]);
            const size_t to = (size_t)v * (size_t)width + (size_t)u;
            if (s->colour[i].plane[3][from] < 0.5f || u < 0 || v < 0 || u >= width || v >= height || !(z < nearest[to]))
                continue;
            nearest[to] = z;
            number[to] = (char)i;
        }
}

// The share of the lens from which a pixel shows none of the first `known` surfaces, for known 1 and 2.
static void find_unseen(const struct surfaces *s, const struct view *t, float *unseen[2])
{
    const size_t n = (size_t)s->depth[0].width * (size_t)s->depth[0].height;
    float *nearest = malloc(n * sizeof *nearest);
    char *number = malloc(n);
    for (int k = 0; k < POINTS && nearest && number; k++) {
        // A spiral that covers the disc evenly.
        const float away = sqrtf(((float)k + 0.5f) / POINTS), turn = 2.39996323f * (float)k;
        const float at[2] = {away * cosf(turn), away * sinf(turn)};
        for (size_t i = 0; i < n; i++) {
            nearest[i] = INFINITY;
            number[i] = SURFACES;
        }
        for (int i = 0; i < SURFACES; i++)
            draw(s, i, t, at, nearest, number);
        for (size_t i = 0; i < n; i++) {
            unseen[0][i] += (float)(number[i] > 0) / POINTS;
            unseen[1][i] += (float)(number[i] > 1) / POINTS;
        }
    }
    CHECK(nearest && number);
    free(nearest);
    free(number);
}

static double correlation(const float *a, const float *b, size_t n)
{
    double sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
    for (size_t i = 0; i < n; i++) {
        sa += a[i];
        sb += b[i];
        aa += (double)a[i] * a[i];
        bb += (double)b[i] * b[i];
        ab += (double)a[i] * b[i];
    }
    const double m = (double)n;
    return (ab - sa * sb / m) / sqrt((aa - sa * sa / m) * (bb - sb * sb / m));
}

// What the library guesses where the first `known` surfaces are given.
static int find_guessed(struct hf_context *c, struct surfaces *s, const struct view *t, int known, struct picture *out)
{
    struct hf_params p = hf_default_params();
    struct hf_image images[SURFACES], dst;
    struct hf_depth depths[SURFACES];
    struct hf_layer layers[SURFACES];
    for (int i = 0; i < known; i++) {
        images[i] = picture_image(&s->colour[i]);
        depths[i] = picture_depth(&s->depth[i]);
        layers[i] = (struct hf_layer){.size = sizeof *layers,
                                      .kind = i ? HF_LAYER_PEEL : HF_LAYER_WHOLE,
                                      .image = &images[i],
                                      .depth = &depths[i]};
    }
    p.engine = HF_ENGINE_LAYERS;
    p.model = HF_MODEL_LENS;
    p.focus = t->focus;
    p.lens.f_number = t->f_number;
    p.layers.guessed = 1;
    *out = picture_new(s->colour[0].width, s->colour[0].height, 4);
    dst = picture_image(out);
    return hf_render_layers(c, &dst, layers, known, &p, NULL);
}

static void measure(struct hf_context *c, const char *folder, const struct view *t)
{
    struct surfaces s = {0};
    if (!CHECK_MSG(!read_surfaces(&s, folder, t->name), "%s: its surfaces cannot be read", t->name))
        return;
    const size_t n = (size_t)s.depth[0].width * (size_t)s.depth[0].height;
    float *unseen[2] = {calloc(n, sizeof(float)), calloc(n, sizeof(float))};
    if (CHECK(unseen[0] && unseen[1]))
        find_unseen(&s, t, unseen);
    for (int known = 1; known <= 2 && unseen[0] && unseen[1]; known++) {
        struct picture guessed;
        CHECK_INT(find_guessed(c, &s, t, known, &guessed), HF_OK);
        const double r = correlation(guessed.plane[0], unseen[known - 1], n);
        printf("%s, %d known: correlation %.3f\n", t->name, known, r);
        CHECK_MSG(r > 0.7, "%s, %d known: what is guessed goes with what is not seen by only %.3f", t->name, known, r);
        picture_free(&guessed);
    }
    for (int i = 0; i < SURFACES; i++) {
        picture_free(&s.colour[i]);
        picture_free(&s.depth[i]);
    }
    free(unseen[0]);
    free(unseen[1]);
}

int main(int argc, char **argv)
{
    struct hf_context *c = NULL;
    if (!CHECK_INT(hf_open(&c, NULL), HF_OK))
        return check_report();
    for (size_t i = 0; argc > 1 && i < sizeof scenes / sizeof *scenes; i++)
        measure(c, argv[1], &scenes[i]);
    hf_close(&c);
    return check_report();
}
