// SPDX-License-Identifier: BSD-3-Clause
// How much of each pixel of a lattice an aperture covers, and the weights that follow.
#include "gather/area.h"

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

void hf_area_cover(double *cover, const struct hf_area *a)
{
    struct polygon p = {.n = a->blades};
    for (int i = 0; i < p.n; i++) {
        const double t = a->rotation * M_PI / 180 + (2 * i + 1) * M_PI / p.n;
        p.x[i] = cos(t);
        p.y[i] = sin(t);
    }
    // A pixel of the lattice, seen from an aperture of radius 1.
    const double w = 1 / a->radius_x, h = 1 / a->radius_y;
    for (int y = -a->ry; y <= a->ry; y++)
        for (int x = -a->rx; x <= a->rx; x++) {
            const double x0 = (x - 0.5) * w, x1 = (x + 0.5) * w, y0 = (y - 0.5) * h, y1 = (y + 0.5) * h;
            const double area = p.n ? polygon_area(&p, x0, y0, x1, y1) : disc_area(x0, y0, x1, y1);
            cover[(y + a->ry) * (2 * a->rx + 1) + x + a->rx] = fmin(area / (w * h), 1);
        }
}

// Weights are whole numbers of 2^-24, and all together are 1: a picture of ones stays one of ones whatever the order in
// which they are added, since no sum needs more than 24 bits. Covered pixels share one weight, so that a run of them is
// one product. What rounding leaves over goes to the pixels at the rim, in mirrored pairs.
static const double UNITS = 0x1p24;

// Pixels that are mirrored into one another.
static int copies(int x, int y)
{
    return (x ? 2 : 1) * (y ? 2 : 1);
}

void hf_area_weights(double *weight, const struct hf_area *a)
{
    const int row = 2 * a->rx + 1, n = row * (2 * a->ry + 1);
    double all = 0, inside = 0, rim = 0;
    for (int i = 0; i < n; i++) {
        // Mirrored pixels have one weight, roundings included: the last quarter's.
        const int x = abs(i % row - a->rx), y = abs(i / row - a->ry);
        const double own = a->symmetric ? weight[(y + a->ry) * row + x + a->rx] : weight[i];
        weight[i] = own < 1e-6 ? 0 : own > 1 - 1e-9 ? 1 : own;
        all += weight[i];
        inside += weight[i] == 1;
        rim += weight[i] < 1 ? weight[i] : 0;
    }
    // A multiple of 4 for all that is covered: then what is left can be given away in fours.
    double share = floor(UNITS / all / 4 + 0.5) * 4;
    if (share < 4096)
        share = floor(UNITS / all);
    const double scale = rim > 0 ? (UNITS - inside * share) / rim : 0;
    double left = UNITS;
    for (int i = 0; i < n; i++) {
        weight[i] = weight[i] == 1 ? share : floor(weight[i] * scale);
        left -= weight[i];
    }
    if (!a->symmetric) {
        weight[n / 2] += left;
        left = 0;
    }
    // Mirrored fours first, then pairs on the axes, then the middle.
    for (int size = 4; size >= 1 && left > 0; size /= 2)
        for (int y = 0; y <= a->ry && left >= size; y++)
            for (int x = 0; x <= a->rx && left >= size; x++) {
                const int at = (y + a->ry) * row + x + a->rx;
                if (copies(x, y) != size || (size > 1 && (weight[at] == share || weight[at] == 0)))
                    continue;
                const double give = size > 1 ? 1 : left;
                for (int v = -y; v <= y; v += 2 * y + !y)
                    for (int u = -x; u <= x; u += 2 * x + !x)
                        weight[(v + a->ry) * row + u + a->rx] += give;
                left -= size * give;
            }
    for (int i = 0; i < n; i++)
        weight[i] /= UNITS;
}
