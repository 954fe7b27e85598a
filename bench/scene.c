// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include "paint.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

const char *const bench_scene_names[] = {"mixed",  "near",        "far",        "both",        "full", "focus",
                                         "band:P", "band-near:P", "band-far:P", "band-both:P", NULL};

enum scene_kind { MIXED, NEAR, FAR, BOTH, FULL, FOCUS, BAND, BAND_NEAR, BAND_FAR, BAND_BOTH, KINDS };

static int scene_kind(const char *name, float *band)
{
    for (int i = 0; i < KINDS; i++) {
        const size_t n = strcspn(bench_scene_names[i], "P");
        if (i < BAND && !strcmp(name, bench_scene_names[i]))
            return i;
        if (i < BAND || strncmp(name, bench_scene_names[i], n))
            continue;
        char *end;
        const float percent = strtof(name + n, &end);
        if (end == name + n || *end || !(percent >= 0 && percent <= 100))
            return KINDS;
        *band = percent / 100;
        return i;
    }
    return KINDS;
}

int bench_scene_builtin(const char *name, float *band)
{
    float share = 0;
    const int builtin = scene_kind(name, &share) != KINDS;
    if (band)
        *band = share;
    return builtin;
}

// Returns 1 if a pixel lies on a near disc of `both`. There is one disc in each square of `pitch` pixels, displaced at
// random by a quarter of it. The near field reaches 2 * max_radius pixels (maximum and box), which closes the gaps
// between discs. CoC is sampled at every other pixel of every other row, so no disc is so small that it falls between
// the samples.
static int on_disc(int x, int y, int pitch)
{
    const int cx = x / pitch, cy = y / pitch;
    const float radius = fmaxf(1.5f, 0.16f * (float)pitch), jitter = 0.25f * (float)pitch;
    const float mx = ((float)cx + 0.5f) * (float)pitch + (bench_hash(cx, cy, 100) - 0.5f) * jitter;
    const float my = ((float)cy + 0.5f) * (float)pitch + (bench_hash(cy, cx, 101) - 0.5f) * jitter;
    const float dx = (float)x + 0.5f - mx, dy = (float)y + 0.5f - my;
    return dx * dx + dy * dy <= radius * radius;
}

struct painter {
    enum scene_kind kind;
    int width, height;
    int pitch;           // of the discs of `both`, pixels
    int band0, band1;    // rows of the band
    float focus, range;  // scene units
};

// The distance from the focus, in ranges, of a pixel whose surface lies at t in `mixed`.
static float depth_of_kind(const struct painter *p, int x, int y, float t)
{
    const float order = (t + 2) / 5;  // 0..1, from the nearest to the farthest
    if (p->kind >= BAND && (y < p->band0 || y >= p->band1))
        return 0;
    switch (p->kind) {
    case MIXED:
        return t;
    case NEAR:
    case BAND_NEAR:
        return -1.5f + 1.3f * order;
    case FAR:
    case BAND_FAR:
        return 0.2f + 1.3f * order;
    case BOTH:
    case BAND_BOTH:
        return on_disc(x, y, p->pitch) ? -1.0f : 0.5f + order;
    case FULL:
        return 1.5f;
    case BAND:
        return x < p->width / 2 ? -0.5f - order : 0.5f + order;
    default:
        return 0;
    }
}

// With a range wider than the focus distance, near surfaces would lie behind the camera, so the depth is limited.
static float scene_depth(const struct painter *p, int x, int y, float t)
{
    return fmaxf(p->focus + p->range * depth_of_kind(p, x, y, t), 0.05f * p->focus);
}

// The colours at pixels' corners: one row of width + 1 points.
static void paint_corners(const struct painter *p, int y, struct bench_colour *corners)
{
    const float pixel = 1 / (float)p->height, aspect = (float)p->width / (float)p->height;
    for (int x = 0; x <= p->width; x++)
        corners[x] = bench_paint((float)x * pixel, (float)y * pixel, aspect).colour;
}

// A pixel's colour is half that of its centre and an eighth of each corner, which smooths edges as renderers do. Its
// depth is that of the centre, also as renderers do.
static void paint_row(const struct painter *p, int y, const struct bench_colour *above,
                      const struct bench_colour *below, float *rgb, float *depth)
{
    const float pixel = 1 / (float)p->height, aspect = (float)p->width / (float)p->height;
    for (int x = 0; x < p->width; x++, rgb += 3) {
        const struct bench_surface s = bench_paint(((float)x + 0.5f) * pixel, ((float)y + 0.5f) * pixel, aspect);
        const struct bench_colour *a = above + x, *b = below + x;
        rgb[0] = 0.5f * s.colour.r + 0.125f * (a[0].r + a[1].r + b[0].r + b[1].r);
        rgb[1] = 0.5f * s.colour.g + 0.125f * (a[0].g + a[1].g + b[0].g + b[1].g);
        rgb[2] = 0.5f * s.colour.b + 0.125f * (a[0].b + a[1].b + b[0].b + b[1].b);
        if (p->kind == BOTH && on_disc(x, y, p->pitch)) {  // raindrops in front of the town
            rgb[0] = 0.25f * rgb[0] + 0.05f;
            rgb[1] = 0.25f * rgb[1] + 0.06f;
            rgb[2] = 0.25f * rgb[2] + 0.08f;
        }
        depth[x] = scene_depth(p, x, y, s.t);
    }
}

// scene->rgb and depth must be allocated. Returns 0, or -1 without memory.
static int paint_all(const struct painter *p, const struct bench_scene *scene)
{
    const size_t width = (size_t)p->width;
    struct bench_colour *corners = malloc(2 * (width + 1) * sizeof *corners);
    if (!corners)
        return -1;
    struct bench_colour *above = corners, *below = corners + width + 1;
    paint_corners(p, 0, above);
    for (int y = 0; y < p->height; y++) {
        paint_corners(p, y + 1, below);
        paint_row(p, y, above, below, scene->rgb + (size_t)y * width * 3, scene->depth + (size_t)y * width);
        struct bench_colour *swap = above;
        above = below;
        below = swap;
    }
    free(corners);
    return 0;
}

static int make_painter(struct painter *p, const char *name, int width, int height, const struct bench_optics *optics,
                        struct tool_error *error)
{
    float band = 0;
    const int kind = scene_kind(name, &band);
    if (kind == KINDS)
        return tool_fail(error, -1, "there is no built-in scene '%s'", name);
    const int rows = (int)(band * (float)height + 0.5f);
    *p = (struct painter){
        .kind = (enum scene_kind)kind,
        .width = width,
        .height = height,
        .pitch = (int)fminf(16, fmaxf(4, optics->max_radius * 1.5f)),
        .band0 = (height - rows) / 2,
        .band1 = (height - rows) / 2 + rows,
        .focus = optics->focus,
        .range = optics->range > 0 && isfinite(optics->range) ? optics->range : optics->focus / 2,
    };
    return 0;
}

int bench_scene_paint(struct bench_scene *scene, const char *name, int width, int height,
                      const struct bench_optics *optics, struct tool_error *error)
{
    struct painter p;
    *scene = (struct bench_scene){.width = width, .height = height};
    if (make_painter(&p, name, width, height, optics, error))
        return -1;
    const size_t pixels = (size_t)width * (size_t)height;
    scene->rgb = malloc(pixels * 3 * sizeof(float));
    scene->depth = malloc(pixels * sizeof(float));
    if (!scene->rgb || !scene->depth || paint_all(&p, scene)) {
        bench_scene_free(scene);
        return tool_fail(error, -1, "there is not enough memory for a scene of %dx%d", width, height);
    }
    return 0;
}

int bench_scene_depth(const struct bench_scene *mixed, const char *name, const struct bench_optics *optics,
                      float *depth, struct tool_error *error)
{
    struct painter p;
    if (make_painter(&p, name, mixed->width, mixed->height, optics, error))
        return -1;
    for (int y = 0; y < p.height; y++)
        for (int x = 0; x < p.width; x++) {
            const size_t i = (size_t)y * (size_t)p.width + (size_t)x;
            depth[i] = scene_depth(&p, x, y, (mixed->depth[i] - p.focus) / p.range);
        }
    return 0;
}

void bench_scene_free(struct bench_scene *scene)
{
    free(scene->rgb);
    free(scene->depth);
    *scene = (struct bench_scene){0};
}
