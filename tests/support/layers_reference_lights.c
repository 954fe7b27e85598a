// SPDX-License-Identifier: BSD-3-Clause
// The highlights of the reference: each square's are drawn by themselves, times what is left of them.
#include "support/layers_reference_parts.h"

enum { SQUARE = LAYERS_REFERENCE_SQUARE };

// What is bright in a square: its middle in pixels of the frame, its mean radius, and its light.
struct lamp {
    double x, y, radius, light;
};

static double apart_at(const struct frame *f, double radius)
{
    return fmax(f->set.spacing, fabs(radius) / 32);
}

static struct lamp lamp_of(const struct frame *f, int near, int x0, int y0)
{
    struct lamp p = {0};
    for (int y = y0; y < y0 + SQUARE; y++)
        for (int x = x0; x < x0 + SQUARE; x++) {
            const double *s = edge(&f->seen, x, y), light = s[SHARE] * (s[0] + s[1] + s[2]);
            if (!(s[SHARE] > 0) || (s[RADIUS] < 0) != near)
                continue;
            p.x += light * (x + 0.5);
            p.y += light * (y + 0.5);
            p.radius += light * s[RADIUS];
            p.light += light;
        }
    if (p.light > 0) {
        p.x /= p.light;
        p.y /= p.light;
        p.radius /= p.light;
    }
    return p;
}

// The coverage of a slice at its own level.
static struct grid coverage(const struct frame *f, const struct slice *s)
{
    const int level = layers_reference_level_of(f, s->own), far = 2 * (int)(fabs(s->own) * fmax(f->wide, 1)) + 64;
    struct grid g =
        grid_new(-(far >> level), -(far >> level), (f->width + far) >> level, (f->height + far) >> level, 5);
    layers_reference_add(f, s, &f->seen, level, SEEN, 0, 0, &g);
    layers_reference_add(f, s, &f->mixed, level, BEHIND, 0, 0, &g);
    if (layers_reference_levels(f) && s->hidden[0] < s->hidden[1]) {
        const struct slice behind = {s->hidden[0], s->own, s->hidden[1], {0}};
        layers_reference_add(f, &behind, &f->behind, level - 1, BEHIND, 0, 0, &g);
        layers_reference_add(f, &behind, &f->beyond, level - 1, BEHIND, 0, 0, &g);
    }
    return g;
}

// The coverage where the ray from (x, y) to a lamp passes the slice, between its four nearest samples.
static double passed(const struct frame *f, const struct grid *g, const struct slice *s, const struct lamp *p, double x,
                     double y)
{
    const double r = fabs(s->own), part = s->own / p->radius, size = 1 << layers_reference_level_of(f, s->own);
    const double u = (x + fmin(fmax(part * (p->x - x), -r * f->wide), r * f->wide)) / size - 0.5,
                 v = (y + fmin(fmax(part * (p->y - y), -r), r)) / size - 0.5;
    const int i = (int)floor(u), j = (int)floor(v);
    return (1 - v + j) * ((1 - u + i) * edge(g, i, j)[4] + (u - i) * edge(g, i + 1, j)[4]) +
           (v - j) * ((1 - u + i) * edge(g, i, j + 1)[4] + (u - i) * edge(g, i + 1, j + 1)[4]);
}

// What is cut from the light of a square, at half resolution.
static struct grid cut(const struct frame *f, const struct slice *s, int count, int near, const int square[2])
{
    struct grid out = grid_new(-MARGIN, -MARGIN, (f->width + 1) / 2 + MARGIN, (f->height + 1) / 2 + MARGIN, 1);
    const struct lamp lamp = lamp_of(f, near, square[0] * SQUARE, square[1] * SQUARE);
    for (int k = 0; k < count && lamp.light > 0; k++) {
        const double before = (lamp.radius - s[k].own) / (2 * apart_at(f, lamp.radius)) - 0.5;
        if (!layers_reference_level_of(f, s[k].own) || !(before > 0))
            continue;
        struct grid g = coverage(f, &s[k]);
        for (int y = out.y0; y < out.y1; y++)
            for (int x = out.x0; x < out.x1; x++)
                at(&out, x, y)[0] += fmin(before, 1) * passed(f, &g, &s[k], &lamp, 2 * x + 1, 2 * y + 1);
        free(g.v);
    }
    return out;
}

// Whether a square has shares of a slice.
static int has_shares(const struct frame *f, const struct slice *s, const int square[2])
{
    for (int i = 0; i < SQUARE * SQUARE; i++) {
        const double *v = edge(&f->seen, square[0] * SQUARE + i % SQUARE, square[1] * SQUARE + i / SQUARE);
        if (v[SHARE] > 0 && layers_reference_part_of(s, v[RADIUS]) > 0)
            return 1;
    }
    return 0;
}

// Add the light of one radius.
static void add_radius(const struct frame *f, const struct slice *s, int count, const struct slice *shine,
                       const struct grid *lift, struct grid *light)
{
    const int around = (int)(fabs(shine->own) * 2 * fmax(f->wide, 1)) / SQUARE + 2;
    for (int sy = -around; sy < (f->height - 1) / SQUARE + 1 + around; sy++)
        for (int sx = -around; sx < (f->width - 1) / SQUARE + 1 + around; sx++) {
            const int square[2] = {sx, sy};
            struct frame only = *f;
            if (!has_shares(f, shine, square))
                continue;
            only.square = square;
            struct grid sum = layers_reference_draw(&only, shine, 0, SHINE, 0),
                        less = cut(f, s, count, shine->own < 0, square);
            for (int i = 0; i < (less.x1 - less.x0) * (less.y1 - less.y0); i++)
                less.v[i] = fmin(less.v[i], 1);
            for (int y = 0; y < f->height; y++)
                for (int x = 0; x < f->width; x++)
                    for (int c = 0; c < 6; c++)
                        at(light, x, y)[c] += (c < 5 ? 1 - layers_reference_up(&less, 0, x, y) : 1) *
                                              at(&sum, x, y)[c < 5 ? c : 4] *
                                              (lift ? layers_reference_up(lift, 0, x, y) : 1);
            free(sum.v);
            free(less.v);
        }
}

// Between two slices that both lack full resolution lie further radii, except of apertures with a shape.
struct grid layers_reference_lights(const struct frame *f, const struct slice *s, int count, int from, int end,
                                    const struct grid *lift)
{
    const struct hf_aperture_params *a = &f->aperture;
    const int most = a->blades || a->ring > 0 || a->picture || a->cat_eye > 0 ? 1 : 4;
    struct grid light = grid_new(0, 0, f->width, f->height, 6);
    for (int i = from; i < end && f->highlights; i++) {
        const int last = i + 1 == count, coarse = !last && layers_reference_level_of(f, s[i + 1].own),
                  parts = coarse ? most : 1;
        const double step = last ? 0 : (s[i + 1].own - s[i].own) / parts;
        // From the slice before, to which the radii before the first lie as far apart as they do there.
        const int before_parts = i && layers_reference_level_of(f, s[i - 1].own) ? most : 1;
        const double before = i ? s[i].own - (s[i].own - s[i - 1].own) / before_parts : -INFINITY;
        for (int k = 0; k < parts; k++) {
            const struct slice shine = {k ? s[i].own + step * (k - 1) : before,
                                        s[i].own + step * k,
                                        last            ? INFINITY
                                        : k + 1 < parts ? s[i].own + step * (k + 1)
                                                        : s[i + 1].own,
                                        {0}};
            add_radius(f, s, count, &shine, i == from && k == 0 ? lift : NULL, &light);
        }
    }
    return light;
}
