// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float focus = 20, range = 10;

// A signed CoC (-1..1 near to far) that is 0 or clearly not, as a depth.
static float random_depth(struct rng *rng)
{
    static const float levels[] = {-1, -0.831f, -0.37f, -0.102f, 0, 0, 0.102f, 0.25f, 0.37f, 0.5f, 0.831f, 1, 2};
    if (rng_below(rng, 60) == 0)
        return rng_below(rng, 2) ? INFINITY : 0;
    return focus + range * levels[rng_below(rng, 13)];
}

static float depth_of_kind(struct rng *rng, enum scene_kind kind, float x, float y)
{
    switch (kind) {
    case SCENE_RAMP: {
        const float c = x + 2 * y - 1.5f;
        return focus + range * (fabsf(c) < 0.02f ? 0 : c);
    }
    case SCENE_FAR:
        return focus + range * rng_range(rng, 0.1f, 1.5f);
    case SCENE_NEAR:
        return focus - range * rng_range(rng, 0.1f, 1.5f);
    case SCENE_SHARP:
        return focus;
    default:
        return random_depth(rng);
    }
}

static void paint(struct scene *s, struct rng *rng, int x0, int y0, int x1, int y1, float z)
{
    const int w = s->colour.width;
    float base[4];
    for (int c = 0; c < 4; c++)
        base[c] = rng_float(rng) * rng_float(rng);
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            for (int c = 0; c < s->colour.channels; c++)
                s->colour.plane[c][y * w + x] = base[c] * rng_range(rng, 0.7f, 1.3f);
            s->depth.plane[0][y * w + x] = z;
        }
    }
}

static void paint_blocks(struct scene *s, struct rng *rng)
{
    const int w = s->colour.width, h = s->colour.height;
    paint(s, rng, 0, 0, w, h, random_depth(rng));
    for (int i = 0; i < 8; i++) {
        const int x = rng_below(rng, w), y = rng_below(rng, h);
        const int x1 = x + 1 + rng_below(rng, w - x), y1 = y + 1 + rng_below(rng, h - y);
        paint(s, rng, x, y, x1, y1, random_depth(rng));
    }
}

// Nothing shines but lamps of one to three pixels' width, of which some touch.
static void paint_lamps(struct scene *s, struct rng *rng)
{
    const int w = s->colour.width, h = s->colour.height;
    for (int c = 0; c < 3; c++)
        memset(s->colour.plane[c], 0, sizeof(float) * (size_t)w * (size_t)h);
    for (int i = 0; i < 1 + w * h / 200; i++) {
        const int x0 = rng_below(rng, w), y0 = rng_below(rng, h), size = 1 + rng_below(rng, 3);
        for (int c = 0; c < 3; c++) {
            const float light = rng_range(rng, 1, 2000);
            for (int y = y0; y < y0 + size && y < h; y++)
                for (int x = x0; x < x0 + size && x < w; x++)
                    s->colour.plane[c][y * w + x] = light;
        }
    }
}

struct scene scene_new(struct rng *rng, enum scene_kind kind, int width, int height, int channels)
{
    struct scene s = {picture_new(width, height, channels), picture_new(width, height, 1)};
    if (kind == SCENE_BLOCKS || kind == SCENE_HIGHLIGHTS || kind == SCENE_DARK || kind == SCENE_NEGATIVE) {
        paint_blocks(&s, rng);
    } else {
        paint(&s, rng, 0, 0, width, height, 0);
        for (int i = 0; i < width * height; i++)
            s.depth.plane[0][i] =
                depth_of_kind(rng, kind, (float)(i % width) / (float)width, (float)(i / width) / (float)height);
    }
    for (int i = 0; kind == SCENE_HIGHLIGHTS && i < 1 + width * height / 200; i++)
        for (int c = 0; c < channels && c < 3; c++)
            s.colour.plane[c][rng_below(rng, width * height)] = rng_range(rng, 10, 2000);
    if (kind == SCENE_DARK)
        paint_lamps(&s, rng);
    for (int i = 0; kind == SCENE_NEGATIVE && i < width * height / 3; i++)
        s.colour.plane[rng_below(rng, 3)][rng_below(rng, width * height)] = rng_range(rng, -2, 0);
    return s;
}

void scene_free(struct scene *s)
{
    picture_free(&s->colour);
    picture_free(&s->depth);
}

const char *scene_name(enum scene_kind kind)
{
    static const char *const names[] = {"blocks", "noise",      "ramp", "far",     "near",
                                        "sharp",  "highlights", "dark", "negative"};
    return names[kind];
}

// One depth sample as another type.
static double converted(enum hf_depth_type type, double z, double rho, double ray)
{
    const double near = 1, far = 100;
    const int there = z > 0 && z < 1e10;
    const double window = far * (z - near) / (z * (far - near));  // 0..1
    switch (type) {
    case HF_DEPTH_RAY:
        return there ? z * ray : z;
    case HF_DEPTH_NDC_D3D:
        return there ? window : 1;
    case HF_DEPTH_NDC_GL:
        return there ? 2 * window - 1 : 1;
    case HF_DEPTH_NDC_REVERSED:
        return there ? 1 - window : 0;
    case HF_DEPTH_INVERSE:
        return there ? 1 / z : 0;
    case HF_DEPTH_COC:
        return there ? rho * fmax(-1, fmin(1, (z - focus) / range)) : INFINITY;
    case HF_DEPTH_VIEW:
        break;
    }
    return z;
}

struct hf_depth scene_depth_as(const struct scene *s, enum hf_depth_type type, float rho, struct picture *samples)
{
    *samples = picture_copy(&s->depth);
    const int w = samples->width, h = samples->height;
    struct hf_depth d = picture_depth(samples);
    d.type = type;
    d.near_plane = 1;
    d.far_plane = 100;
    d.focal_px = 50;
    d.center_x = (float)w / 2;
    d.center_y = (float)h / 2;
    for (int i = 0; i < w * h; i++) {
        const double tx = (i % w + 0.5 - d.center_x) / 50, ty = (i / w + 0.5 - d.center_y) / 50;
        samples->plane[0][i] = (float)converted(type, s->depth.plane[0][i], rho, sqrt(1 + tx * tx + ty * ty));
    }
    return d;
}

struct hf_params scene_params(void)
{
    struct hf_params p = hf_default_params();
    p.focus = focus;
    p.range.distance = range;
    p.max_radius = 12;
    return p;
}

static void *alloc_nan(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    void *p = aligned_alloc(align, (size + align - 1) / align * align);
    return p ? memset(p, 0xff, size) : NULL;
}

static void free_nan(void *cookie, void *p)
{
    (void)cookie;
    free(p);
}

struct hf_config scene_config(enum hf_isa isa, int threads)
{
    return (struct hf_config){
        .size = sizeof(struct hf_config), .isa = isa, .threads = threads, .alloc = alloc_nan, .free = free_nan};
}
