// SPDX-License-Identifier: BSD-3-Clause
// How much of each pixel of a lattice an aperture covers, and the weights that follow.
#include "engine/gather/area.h"

#include <math.h>
#include <stdlib.h>

// Area of the unit disc within 0..x and 0..y; both >= 0.
static double quarter(double x, double y)
{
    x = fmin(x, 1);
    y = fmin(y, 1);
    if (x * x + y * y <= 1)
        return x * y;
    const double from = sqrt(1 - y * y);  // from here on the circle is lower than y
    return y * from + ((x * sqrt(1 - x * x) + asin(x)) - (from * sqrt(1 - from * from) + asin(from))) / 2;
}

// The same with signs: an integral over the disc from the axes.
static double signed_quarter(double x, double y)
{
    return copysign(1, x) * copysign(1, y) * quarter(fabs(x), fabs(y));
}

static double disc_area(double x0, double y0, double x1, double y1)
{
    return (signed_quarter(x1, y1) - signed_quarter(x0, y1)) - (signed_quarter(x1, y0) - signed_quarter(x0, y0));
}

enum { CORNERS = 16 + 4 };
struct polygon {
    int n;
    double x[CORNERS], y[CORNERS];
};

// What of a polygon lies where a x + b y <= c.
static struct polygon cut(const struct polygon *p, double a, double b, double c)
{
    struct polygon q = {0};
    for (int i = 0; i < p->n; i++) {
        const int k = (i + 1) % p->n;
        const double d = a * p->x[i] + b * p->y[i] - c, e = a * p->x[k] + b * p->y[k] - c;
        if (d <= 0) {
            q.x[q.n] = p->x[i];
            q.y[q.n++] = p->y[i];
        }
        if ((d < 0 && e > 0) || (d > 0 && e < 0)) {
            q.x[q.n] = p->x[i] + (p->x[k] - p->x[i]) * d / (d - e);
            q.y[q.n++] = p->y[i] + (p->y[k] - p->y[i]) * d / (d - e);
        }
    }
    return q;
}

static double polygon_area(const struct polygon *whole, double x0, double y0, double x1, double y1)
{
    struct polygon p = cut(whole, 1, 0, x1);
    p = cut(&p, -1, 0, -x0);
    p = cut(&p, 0, 1, y1);
    p = cut(&p, 0, -1, -y0);
    double sum = 0;
    for (int i = 0; i < p.n; i++) {
        const int k = (i + 1) % p.n;
        sum += p.x[i] * p.y[k] - p.x[k] * p.y[i];
    }
    return fabs(sum) / 2;
}

// What the eight pixels around the middle one weigh at least. A pixel beside a far one is upsampled with it and has to see
// it: a triangle of radius 1 covers nothing of some of them, and small discs nothing of the corners.
static const double LEAST = 1.0 / 1024;

void hf_area_cover(double *cover, const struct hf_area *a, atomic_int *stop)
{
    struct polygon p = {.n = a->blades};
    for (int i = 0; i < p.n; i++) {
        const double t = a->rotation * M_PI / 180 + (2 * i + 1) * M_PI / p.n;
        p.x[i] = cos(t);
        p.y[i] = sin(t);
    }
    // A pixel of the lattice, seen from an aperture of radius 1.
    const double w = 1 / a->radius_x, h = 1 / a->radius_y;
    for (int y = -a->ry; y <= a->ry && !hf_stopped(stop); y++)
        for (int x = -a->rx; x <= a->rx; x++) {
            const double x0 = (x - 0.5) * w, x1 = (x + 0.5) * w, y0 = (y - 0.5) * h, y1 = (y + 0.5) * h;
            const double area = p.n ? polygon_area(&p, x0, y0, x1, y1) : disc_area(x0, y0, x1, y1);
            const double least = abs(x) <= 1 && abs(y) <= 1 ? LEAST : 0;
            cover[(y + a->ry) * (2 * a->rx + 1) + x + a->rx] = fmax(fmin(area / (w * h), 1), least);
        }
}

// Weights are whole numbers of a unit, and no sum of them needs more than 24 bits: a picture of ones stays one of ones
// whatever the order in which they are added. Covered pixels weigh 1, so that a run of them is a sum alone. One over the
// sum of all is rounded; pixels at the rim, in mirrored copies, get a unit more until the product of both rounds to 1.
double hf_area_unit(const struct hf_area *a)
{
    int bits = 24;
    for (double all = 4 * (a->radius_x + 1) * (a->radius_y + 1) * a->times; all >= 1; all /= 2)  // more than a disc has
        bits--;
    return ldexp(1, -bits);
}

// The pixel whose weight its mirrored copies have, roundings included: the last quarter's.
static int original(const struct hf_area *a, int x, int y)
{
    const int row = 2 * a->rx + 1;
    return a->symmetric ? (abs(y) + a->ry) * row + abs(x) + a->rx : (y + a->ry) * row + x + a->rx;
}

// Give a unit to a pixel at the rim and to its copies. from: where to look for it, and where it was found. Returns how many.
static int give(double *weight, const struct hf_area *a, double unit, int *from)
{
    const int row = 2 * a->rx + 1, n = row * (2 * a->ry + 1);
    int given = 0;
    for (int i = 0; i < n && !given; i++, *from = (*from + 1) % n) {
        const int x = *from % row - a->rx, y = *from / row - a->ry, at = *from;
        if (at != original(a, x, y) || weight[at] == 0 || weight[at] >= 1 - unit)
            continue;
        for (int v = -abs(y); v <= abs(y); v++)
            for (int u = -abs(x); u <= abs(x); u++)
                if (original(a, u, v) == at) {
                    weight[(v + a->ry) * row + u + a->rx] += unit;
                    given++;
                }
    }
    return given;
}

float hf_area_weights(double *weight, const struct hf_area *a)
{
    const int row = 2 * a->rx + 1, n = row * (2 * a->ry + 1);
    const double unit = hf_area_unit(a);
    double all = 0;
    for (int i = n - 1; i >= 0; i--) {
        const double own = weight[original(a, i % row - a->rx, i / row - a->ry)];
        weight[i] = own < 1e-6 ? 0 : own > 1 - 1e-9 ? 1 : floor(own / unit + 0.5) * unit;
        all += weight[i];
    }
    if (a->cut) {
        const double turn = a->blades ? 2 * M_PI / a->blades : 0;
        return (float)(1 / (a->radius_x * a->radius_y * (a->blades ? a->blades / 2.0 * sin(turn) : M_PI)));
    }
    for (int i = 0, from = 0; i < 1024 && (float)(all * (double)(float)(1 / all)) != 1; i++)
        all += give(weight, a, unit, &from) * unit;
    return (float)(1 / all);
}
