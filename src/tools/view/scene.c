// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/scene.h"

#include <math.h>
#include <stddef.h>

enum { COLUMNS = 24, BALLS = 40, LAMPS = 36 };

struct vec {
    double x, y, z;
};

// What is drawn, and from where. The camera walks along the hall and looks a little to both sides.
struct picture {
    float *const *rgb;
    float *depth;
    int width, height;
    double focal;  // pixels
    struct vec eye;
    double sine, cosine;
};

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

// From the world to the camera: x right, y up, z forward.
static struct vec seen_from(const struct picture *p, struct vec w)
{
    const double x = w.x - p->eye.x, z = w.z - p->eye.z;
    return (struct vec){x * p->cosine - z * p->sine, w.y - p->eye.y, x * p->sine + z * p->cosine};
}

static void put(const struct picture *p, size_t i, double z, double r, double g, double b)
{
    p->depth[i] = (float)z;
    p->rgb[0][i] = (float)r;
    p->rgb[1][i] = (float)g;
    p->rgb[2][i] = (float)b;
}

// Floor and ceiling with tiles, which fade into the dark.
static void draw_room(const struct picture *p)
{
    for (int y = 0; y < p->height; y++) {
        const double up = (p->height / 2.0 - y - 0.5) / p->focal;
        const double z = (up < 0 ? p->eye.y : 4 - p->eye.y) / fmax(fabs(up), 1e-6), fog = exp(-z / 14);
        for (int x = 0; x < p->width; x++) {
            const size_t i = (size_t)y * (size_t)p->width + (size_t)x;
            if (z > 60) {
                put(p, i, 60, 0.004, 0.005, 0.009);
                continue;
            }
            const double side = (x + 0.5 - p->width / 2.0) / p->focal * z;
            const double wx = p->eye.x + side * p->cosine + z * p->sine, wz = p->eye.z - side * p->sine + z * p->cosine;
            const int dark = ((int)floor(wx) + (int)floor(wz)) & 1;
            const double light = (up < 0 ? (dark ? 0.05 : 0.22) : 0.03) * fog;
            put(p, i, z, light, light * 0.9, light * 0.75);
        }
    }
}

// A column is as wide at every height: each of the picture's columns has one distance and one shade.
static void draw_column(const struct picture *p, struct vec at, double radius, const double colour[3])
{
    const struct vec c = seen_from(p, at);
    if (c.z < radius + 0.3)
        return;
    const double half = radius / sqrt(c.z * c.z - radius * radius) * p->focal * 1.1,
                 middle = c.x / c.z * p->focal + p->width / 2.0;
    for (int x = (int)fmax(0, middle - half); x < (int)fmin(p->width, middle + half + 1); x++) {
        // The ray (side, 1) in the plane of the floor meets the circle.
        const double side = (x + 0.5 - p->width / 2.0) / p->focal, a = side * side + 1, b = side * c.x + c.z;
        const double under = b * b - a * (c.x * c.x + c.z * c.z - radius * radius);
        if (under <= 0)
            continue;
        const double z = (b - sqrt(under)) / a, nx = (side * z - c.x) / radius, nz = (z - c.z) / radius;
        const double light = (0.06 + 0.6 * fmax(0, -0.6 * nx - 0.6 * nz)) * exp(-z / 16);
        for (int y = 0; y < p->height; y++) {
            const size_t i = (size_t)y * (size_t)p->width + (size_t)x;
            const double height = p->eye.y + (p->height / 2.0 - y - 0.5) / p->focal * z;
            if (height < 0 || height > 4 || p->depth[i] <= z)
                continue;
            const double groove = height < 0.25 || height > 3.75 ? 1.25 : 0.85 + 0.15 * cos(height * 12);
            put(p, i, z, colour[0] * light * groove, colour[1] * light * groove, colour[2] * light * groove);
        }
    }
}

// An ornament; with glow it is a lamp.
static void draw_ball(const struct picture *p, struct vec at, double radius, const double colour[3], double glow)
{
    const struct vec c = seen_from(p, at);
    if (c.z < radius + 0.2)
        return;
    const double half = radius / c.z * p->focal * 1.05 + 1, mx = c.x / c.z * p->focal + p->width / 2.0;
    const double my = p->height / 2.0 - c.y / c.z * p->focal;
    for (int y = (int)fmax(0, my - half); y < (int)fmin(p->height, my + half + 1); y++)
        for (int x = (int)fmax(0, mx - half); x < (int)fmin(p->width, mx + half + 1); x++) {
            const double dx = (x + 0.5 - mx) / half * 1.05, dy = (my - y - 0.5) / half * 1.05,
                         inside = 1 - dx * dx - dy * dy;
            const size_t i = (size_t)y * (size_t)p->width + (size_t)x;
            if (inside <= 0)
                continue;
            const double nz = sqrt(inside), z = c.z - nz * radius;
            if (p->depth[i] <= z)
                continue;
            const double shine = pow(fmax(0, 0.5 * dy + 0.75 * nz - 0.4 * dx), 24);
            const double light = glow > 0 ? glow : (0.08 + 0.7 * fmax(0, 0.6 * dy + 0.5 * nz - 0.5 * dx));
            put(p, i, z, colour[0] * light + shine, colour[1] * light + shine, colour[2] * light + shine);
        }
}

static void draw_things(const struct picture *p, double seconds)
{
    static const double stone[3] = {0.9, 0.82, 0.7};
    static const double paints[4][3] = {{0.9, 0.12, 0.08}, {0.85, 0.6, 0.12}, {0.1, 0.35, 0.85}, {0.15, 0.6, 0.25}};
    static const double warm[3] = {1, 0.75, 0.4}, cold[3] = {0.6, 0.8, 1};
    for (int i = 0; i < COLUMNS; i++)
        draw_column(p, (struct vec){i & 1 ? 2.2 : -2.2, 0, 3.0 * (i / 2) - 4}, 0.32, stone);
    for (int i = 0; i < BALLS; i++) {
        const double turn = 2.399963 * i, away = mix(0.5, 1.6, fmod(i * 0.618, 1));
        const double swing = 0.12 * sin(1.3 * seconds + i);
        draw_ball(p,
                  (struct vec){away * cos(turn) + swing, 0.5 + fmod(i * 0.37, 2.4) + 0.08 * sin(seconds + 2 * i),
                               0.85 * i - 3},
                  mix(0.07, 0.22, fmod(i * 0.77, 1)), paints[i % 4], 0);
    }
    for (int i = 0; i < LAMPS; i++)
        draw_ball(
            p,
            (struct vec){(i & 1 ? 1.75 : -1.75) + 0.05 * sin(seconds * 2 + i), 1.4 + fmod(i * 0.53, 1.8), 0.95 * i - 3},
            0.045, i % 3 ? warm : cold, 9);
}

void view_scene(float *const rgb[3], float *depth, int width, int height, double seconds)
{
    const double turn = 0.28 * sin(0.35 * seconds);
    const struct picture p = {rgb,         depth,
                              width,       height,
                              0.9 * width, {0.5 * sin(0.23 * seconds), 1.5, -4 + 6 * (1 - cos(0.12 * seconds))},
                              sin(turn),   cos(turn)};
    draw_room(&p);
    draw_things(&p, seconds);
}
