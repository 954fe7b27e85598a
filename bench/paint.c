// SPDX-License-Identifier: BSD-3-Clause
// A house at night, seen over a railing. Leaves and the railing are near, the house and its wall are in focus, street,
// skyline and lights are far. Painting asks the layers from front to back; the first that covers the point is visible.
#include "paint.h"

#include <math.h>
#include <stdbool.h>

typedef struct bench_colour colour;
typedef struct bench_surface surface;

enum seed {
    LEAF,
    LEAF_SHAPE,
    LEAF_EDGE,
    WOOD,
    BRICK,
    BRICK_GRAIN,
    WINDOW,
    LIGHT,
    LIGHT_COLOUR,
    TOWN,
    TOWN_LIT,
    STREET
};

float bench_hash(int x, int y, uint32_t seed)
{
    uint32_t h = (uint32_t)x * 0x9E3779B1u ^ (uint32_t)y * 0x85EBCA77u ^ (seed + 1) * 0xC2B2AE3Du;
    h ^= h >> 16;
    h *= 0x7FEB352Du;
    h ^= h >> 15;
    h *= 0x846CA68Bu;
    h ^= h >> 16;
    return (float)(h >> 8) * 0x1p-24f;
}

static float mix(float a, float b, float t)
{
    return a + t * (b - a);
}

static float clamp01(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static colour scale(colour c, float k)
{
    return (colour){c.r * k, c.g * k, c.b * k};
}

// Smooth noise, 0..1, one bump per unit.
static float noise(float x, float y, uint32_t seed)
{
    const float fx = floorf(x), fy = floorf(y);
    const int ix = (int)fx, iy = (int)fy;
    const float a = x - fx, b = y - fy;
    const float sa = a * a * (3 - 2 * a), sb = b * b * (3 - 2 * b);
    return mix(mix(bench_hash(ix, iy, seed), bench_hash(ix + 1, iy, seed), sa),
               mix(bench_hash(ix, iy + 1, seed), bench_hash(ix + 1, iy + 1, seed), sa), sb);
}

// Near objects shrink with the width in pictures narrower than 16:9, so that the house keeps its share.
static float near_size(float aspect)
{
    return fminf(1, aspect * 9 / 16);
}

// How far a point lies inside the foliage, in picture heights. The foliage hangs in from the left and from the upper
// right.
static float foliage_depth(float u, float v, float aspect)
{
    const float edge = 0.14f * noise(v * 4.5f, 0, LEAF_EDGE) * near_size(aspect);
    const float left = aspect * (0.075f + 0.10f * (1 - v)) + edge - u;
    const float right = u - aspect * (0.86f + 0.5f * v * v) + edge - 0.07f * near_size(aspect);
    return fmaxf(left, right);
}

// One leaf of the grid cell (cx, cy): an ellipse with a rib.
static bool leaf(float u, float v, int cx, int cy, float cell, float aspect, surface *out)
{
    const float mu = ((float)cx + bench_hash(cx, cy, LEAF)) * cell;
    const float mv = ((float)cy + bench_hash(cy, cx, LEAF)) * cell;
    if (foliage_depth(mu, mv, aspect) < 0)
        return false;
    float dx = bench_hash(cx, cy, LEAF_SHAPE) - 0.5f, dy = bench_hash(cy, cx, LEAF_SHAPE) * 0.6f + 0.2f;
    const float length = sqrtf(dx * dx + dy * dy);
    dx /= length;
    dy /= length;
    const float along = (u - mu) * dx + (v - mv) * dy, across = (v - mv) * dx - (u - mu) * dy;
    const float a = along / cell, b = across / (0.5f * cell);
    if (a * a + b * b > 1)
        return false;
    const float tint = bench_hash(cx + 77, cy, LEAF), shade = 0.55f + 0.45f * b + (fabsf(b) < 0.07f ? 0.5f : 0.0f);
    out->t = -0.8f - 0.9f * bench_hash(cx, cy + 77, LEAF);
    out->colour = scale((colour){mix(0.03f, 0.16f, tint), mix(0.10f, 0.20f, tint), 0.02f}, shade);
    return true;
}

static bool foliage(float u, float v, float aspect, surface *out)
{
    const float cell = 0.07f * near_size(aspect);
    const float depth = foliage_depth(u, v, aspect);
    if (depth < -2 * cell)
        return false;
    const int cx = (int)floorf(u / cell), cy = (int)floorf(v / cell);
    for (int y = cy - 1; y <= cy + 1; y++)
        for (int x = cx - 1; x <= cx + 1; x++)
            if (leaf(u, v, x, y, cell, aspect, out))
                return true;
    if (depth < 0.3f * cell)
        return false;
    // The middle of the foliage lets no sky through.
    out->t = -0.6f;
    out->colour = scale((colour){0.010f, 0.025f, 0.008f}, 0.5f + noise(u * 40, v * 40, LEAF_EDGE));
    return true;
}

// A glazed ball on the railing, lit from the upper left.
static bool ball(float u, float v, float aspect, surface *out)
{
    const float radius = 0.13f * near_size(aspect), x = (u - 0.80f * aspect) / radius, y = (v - 0.77f) / radius;
    const float d2 = x * x + y * y;
    if (d2 > 1)
        return false;
    const float z = sqrtf(1 - d2);
    const float lit = fmaxf(0, -0.47f * x - 0.62f * y + 0.63f * z);
    // The half-way vector between that light and the eye, to the 64th power: a highlight about 1/15 as large as the
    // ball.
    float gloss = fmaxf(0, -0.26f * x - 0.34f * y + 0.90f * z);
    for (int i = 0; i < 6; i++)
        gloss *= gloss;
    const float stripe = fabsf(y) < 0.18f ? 1.0f : 0.25f;
    out->t = -0.9f - 0.2f * z;
    out->colour = scale((colour){0.35f * stripe, 0.30f * stripe, 0.28f}, 0.05f + lit);
    const float shine = 14 * gloss;
    out->colour = (colour){out->colour.r + shine, out->colour.g + shine * 0.9f, out->colour.b + shine * 0.75f};
    return true;
}

static bool railing(float u, float v, float aspect, surface *out)
{
    const float top = 0.865f;
    if (v < top)
        return false;
    const float p = (v - top) / (1 - top);
    // Planks run away from the eye, and their seams meet above the middle of the picture.
    const float plank = (u - 0.5f * aspect) / (0.5f + p) * 9;
    const float seam = plank - floorf(plank);
    const float grain = noise(plank * 6, v * 30, WOOD) * 0.5f + noise(plank * 40, v * 9, WOOD) * 0.5f;
    const float tint = 0.6f + 0.4f * bench_hash((int)floorf(plank), 0, WOOD);
    out->t = -0.3f - 1.2f * p;
    out->colour = scale((colour){0.20f, 0.11f, 0.055f}, tint * (0.4f + grain) * (seam < 0.04f ? 0.15f : 1.0f));
    return true;
}

// Outline of house, tower and garden wall; s is u as a part of the picture's width.
static bool house_covers(float s, float v)
{
    if (v > 0.66f)
        return true;
    if (s > 0.335f && s < 0.735f && v > 0.27f)
        return true;
    const bool notch = (int)((s - 0.395f) / 0.12f * 9) % 2 != 0;
    return s > 0.395f && s < 0.515f && v > (notch ? 0.11f : 0.08f);
}

// The two lanterns, and their light on the bricks.
static float lanterns(float u, float v, float aspect)
{
    float light = 0;
    for (int i = 0; i < 2; i++) {
        const float dx = u - aspect * (i ? 0.70f : 0.37f), dy = v - 0.47f, d2 = dx * dx + dy * dy;
        if (d2 < 0.010f * 0.010f)
            return 60;
        light += 0.02f / (0.008f + d2);
    }
    return light;
}

// Five windows in a row on the house, one on the tower.
static bool house_window(float u, float v, float s, colour *out)
{
    const float x = (s - 0.335f) / 0.08f, y = (v - 0.115f) / 0.17f;
    const int ix = (int)floorf(x), iy = (int)floorf(y);
    const float a = fabsf(x - (float)ix - 0.5f), b = fabsf(y - (float)iy - 0.5f);
    if (a > 0.22f || b > 0.32f || iy < 0 || iy > 2 || ix < 0 || ix > 4 || (iy < 1 && ix != 1))
        return false;
    if (a > 0.19f || b > 0.29f || a < 0.015f || fabsf(b - 0.1f) < 0.012f)
        *out = (colour){0.25f, 0.24f, 0.21f};
    else if (bench_hash(ix, iy, WINDOW) < 0.45f)
        *out = scale((colour){2.4f, 1.6f, 0.7f}, 0.6f + 0.8f * noise(u * 30, v * 30, WINDOW));
    else
        *out = scale((colour){0.015f, 0.02f, 0.035f}, 0.5f + noise(u * 25, v * 25, WINDOW));
    return true;
}

static bool house(float u, float v, float aspect, surface *out)
{
    const float s = u / aspect;
    if (!house_covers(s, v))
        return false;
    out->t = 0;
    const float light = lanterns(u, v, aspect);
    if (light >= 60) {
        out->colour = (colour){60, 42, 20};
        return true;
    }
    if (house_window(u, v, s, &out->colour))
        return true;
    const float row = floorf(v / 0.018f), x = u / 0.045f + (fmodf(row, 2) != 0 ? 0.5f : 0.0f);
    const float a = x - floorf(x), b = v / 0.018f - row;
    const bool mortar = a < 0.05f || b < 0.11f;
    const float grain = 0.75f + 0.5f * noise(u * 300, v * 300, BRICK_GRAIN);
    const float tint = mortar ? 1 : 0.6f + 0.8f * bench_hash((int)floorf(x), (int)row, BRICK);
    const colour base = mortar ? (colour){0.16f, 0.15f, 0.14f} : (colour){0.22f, 0.095f, 0.06f};
    out->colour =
        scale((colour){base.r * (0.35f + light), base.g * (0.4f + 0.8f * light), base.b * (0.5f + 0.5f * light)},
              tint * grain * 0.7f);
    return true;
}

// Lights of the far town: one cell in four has one, and a few reach a brightness of 200.
static bool light(float u, float v, surface *out)
{
    const float cell = 0.038f;
    const int cx = (int)floorf(u / cell), cy = (int)floorf(v / cell);
    const float pick = bench_hash(cx, cy, LIGHT);
    if (v < 0.10f || pick > 0.25f)
        return false;
    const float h = bench_hash(cx, cy, LIGHT_COLOUR), radius = 0.0013f + 0.0022f * h * h;
    const float du = u - ((float)cx + 0.2f + 0.6f * bench_hash(cy, cx, LIGHT)) * cell;
    const float dv = v - ((float)cy + 0.2f + 0.6f * bench_hash(cy, cx, LIGHT_COLOUR)) * cell;
    if (du * du + dv * dv > radius * radius)
        return false;
    static const colour colours[] = {{1, 0.62f, 0.25f}, {1, 0.9f, 0.75f}, {1, 0.12f, 0.06f},
                                     {0.25f, 0.5f, 1},  {1, 0.45f, 0.1f}, {0.2f, 1, 0.4f}};
    const float power = bench_hash(cx + 5, cy, LIGHT);
    out->t = 1.5f;
    out->colour = scale(colours[(int)(bench_hash(cx, cy + 5, LIGHT) * 6)], 6 + 194 * power * power * power);
    return true;
}

// A row of houses: blocks of equal width with tops between high and low, and lit windows.
static bool skyline(float u, float v, float block, float high, float low, float t, int seed, surface *out)
{
    const float x = u / block;
    const int ix = (int)floorf(x);
    const float top = mix(high, low, bench_hash(ix, seed, TOWN));
    if (v < top)
        return false;
    const float wx = (x - (float)ix) * 5, wy = (v - top) / 0.018f;
    const float a = wx - floorf(wx), b = wy - floorf(wy);
    const float lit = bench_hash(ix * 8 + (int)wx, (int)wy + seed * 1000, TOWN_LIT);
    out->t = t;
    if (lit < 0.16f && a > 0.3f && a < 0.75f && b > 0.3f && b < 0.75f && wy > 1)
        out->colour = scale((colour){1, 0.72f, 0.38f}, 1 + 40 * lit);
    else
        out->colour = scale((colour){0.018f, 0.016f, 0.024f}, 0.5f + bench_hash(ix, seed + 9, TOWN));
    return true;
}

static surface far_away(float u, float v)
{
    surface out;
    // The street leads from just behind the wall to the town. Along it, f grows from 0.1 to 0.6.
    const float kerb = 0.585f;
    if (v > kerb) {
        const float p = (v - kerb) / (0.66f - kerb);
        out.t = 0.6f - 0.5f * p;
        out.colour = scale((colour){0.05f, 0.045f, 0.05f}, 0.4f + noise(u * 20, v * 160, STREET));
        return out;
    }
    if (light(u, v, &out) || skyline(u, v, 0.11f, 0.30f, 0.55f, 1.0f, 1, &out) ||
        skyline(u, v, 0.07f, 0.20f, 0.45f, 2.0f, 2, &out))
        return out;
    const float p = clamp01(v / 0.6f), cloud = noise(u * 4, v * 9, STREET);
    out.t = 3;
    out.colour =
        (colour){0.006f + 0.10f * p * p * (0.5f + cloud), 0.009f + 0.05f * p * p * (0.5f + cloud), 0.03f + 0.05f * p};
    return out;
}

struct bench_surface bench_paint(float u, float v, float aspect)
{
    surface out;
    if (foliage(u, v, aspect, &out) || ball(u, v, aspect, &out) || railing(u, v, aspect, &out) ||
        house(u, v, aspect, &out))
        return out;
    return far_away(u, v);
}
