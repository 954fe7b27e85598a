// SPDX-License-Identifier: BSD-3-Clause
#include "support/reference_edges.h"

static int inside(int v, int n)
{
    return v < 0 ? 0 : v < n ? v : n - 1;
}

static double clamp01(double v)
{
    return fmin(fmax(v, 0), 1);
}

struct edges {
    const struct picture *c;
    const float *radius;
    double sharp;
};

// Radii beyond the sharp limit; outside the frame its edge is repeated.
static double radius_at(const struct edges *e, int x, int y)
{
    const double r = e->radius[inside(y, e->c->height) * e->c->width + inside(x, e->c->width)];
    return fabs(r) > e->sharp ? r - copysign(e->sharp, r) : 0;
}

static double colour_at(const struct edges *e, int c, int x, int y)
{
    return e->c->plane[c][inside(y, e->c->height) * e->c->width + inside(x, e->c->width)];
}

static double range_at(const struct edges *e, int x, int y, double *middle)
{
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < 9; i++) {
        const double r = radius_at(e, x + i % 3 - 1, y + i / 3 - 1);
        low = fmin(low, r);
        high = fmax(high, r);
    }
    *middle = (low + high) / 2;
    return high - low;
}

static double mixed_of(double range)
{
    return clamp01(2 * (range - 0.75));
}

static double between(double v, double a, double b)
{
    return fmin(fmax(v, fmin(a, b)), fmax(a, b));
}

// Means of both sides of 5 x 5: of colours, and of radii (4).
static void side_means(const struct edges *e, int x, int y, double middle, double range, double mean[2][5])
{
    double sum[2] = {0};
    for (int i = 0; i < 25; i++) {
        const int u = i % 5 - 2, v = i / 5 - 2, d = u * u + v * v;
        double unused;
        const double r = radius_at(e, x + u, y + v), sure = d ? 1 - mixed_of(range_at(e, x + u, y + v, &unused)) : 0;
        const double w = (sure + 1 / 16.0) / (d ? d * d : 1), front = clamp01((middle - r) * 2 / range + 0.5);
        for (int k = 0; k < 2; k++) {
            const double part = w * (k ? 1 - front : front);
            sum[k] += part;
            for (int c = 0; c < e->c->channels; c++)
                mean[k][c] += part * colour_at(e, c, x + u, y + v);
            mean[k][4] += part * r;
        }
    }
    for (int k = 0; k < 2; k++)
        for (int c = 0; c < 5; c++)
            mean[k][c] /= sum[k];
}

// The share from colours only, not from alpha.
static double share_of(const struct edges *e, int x, int y, const double *front, const double *back, double a0)
{
    double along = 0, apart = 0, largest = 0, off = 0;
    for (int c = 0; c < 3; c++) {
        along = fmax(along, fabs(between(colour_at(e, c, x, y) - back[c], 0, front[c] - back[c])));
        apart = fmax(apart, fabs(front[c] - back[c]));
        largest = fmax(largest, fmax(fabs(front[c]), fabs(back[c])));
    }
    if (apart == 0)
        return a0;
    const double a = (along + largest / 16 * a0) / (apart + largest / 16);
    for (int c = 0; c < 3; c++)
        off = fmax(off, fabs(colour_at(e, c, x, y) - a * front[c] - (1 - a) * back[c]));
    return a0 + (a - a0) * apart / (apart + off);
}

struct edge_reference edge_reference(const struct picture *colour, const float *radius, double sharp, int x, int y)
{
    const struct edges e = {colour, radius, sharp};
    struct edge_reference out = {.mixed = 0};
    double middle, mean[2][5] = {{0}};
    const double range = range_at(&e, x, y, &middle), own = radius_at(&e, x, y), raw = radius[y * colour->width + x];
    for (int c = 0; c < colour->channels; c++)
        out.colour[0][c] = colour_at(&e, c, x, y);
    out.radius[0] = fabs(raw) > sharp ? raw : 0;
    out.mixed = mixed_of(range);
    if (out.mixed == 0)
        return out;
    side_means(&e, x, y, middle, range, mean);
    const double a0 = out.is_front = clamp01((middle - own) * 2 / range + 0.5);
    const double a = out.front = clamp01((share_of(&e, x, y, mean[0], mean[1], a0) * 256 - 1) / 254);
    out.share = out.mixed * (1 - a);
    const double whole = out.share < 1 ? (1 - out.mixed) / (1 - out.share) : 0;
    for (int c = 0; c < colour->channels; c++) {
        const double v = colour_at(&e, c, x, y), f = mean[0][c], b = mean[1][c], rest = v - a * f - (1 - a) * b;
        const double front = between(f + rest, f, v);
        out.colour[0][c] = front + whole * (v - front);
        out.colour[1][c] = between(b + rest, b, v);
    }
    const double front = mean[0][4] + a0 * (own - mean[0][4]),
                 r[2] = {front + whole * (own - front), own + a0 * (mean[1][4] - own)};
    for (int k = 0; k < 2; k++)
        out.radius[k] = r[k] != 0 ? r[k] + copysign(sharp, r[k]) : 0;
    return out;
}
