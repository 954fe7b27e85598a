// SPDX-License-Identifier: BSD-3-Clause
// Shapes of apertures in double precision: the weight of each pixel.
#include <string.h>

#include "support/layers_reference_parts.h"

static const double PI = 3.14159265358979323846;

// A side of a polygon with corners on the unit circle: the line x nx + y ny = d, or an arc around (cx, cy) through the
// same corners, whose height is a part of that between the line and the unit circle.
struct side {
    double nx, ny, d, cx, cy, radius;  // radius 0: a line
};

static struct side side_of(const struct hf_aperture_params *a, double rotation, int i)
{
    const double angle = 2 * PI * i / a->blades + rotation * PI / 180, half = sin(PI / a->blades);
    struct side s = {.nx = cos(angle), .ny = sin(angle), .d = cos(PI / a->blades)};
    const double rise = a->roundness * (1 - s.d);
    if (a->roundness > 0) {
        s.radius = (half * half + rise * rise) / (2 * rise);
        s.cx = s.nx * (s.d + rise - s.radius);
        s.cy = s.ny * (s.d + rise - s.radius);
    }
    return s;
}

// The run at height y of a polygon; 0 if there is none.
static int chord(const struct side *side, int sides, double y, double *left, double *right)
{
    *left = -INFINITY;
    *right = INFINITY;
    for (int i = 0; i < sides; i++) {
        const struct side *s = &side[i];
        const double room = s->d - s->ny * y, wide = s->radius * s->radius - (y - s->cy) * (y - s->cy);
        if (s->radius > 0) {
            *right = fmin(*right, s->cx + sqrt(fmax(wide, 0)));
            *left = fmax(*left, s->cx - sqrt(fmax(wide, 0)));
        } else if (s->nx > 1e-9) {
            *right = fmin(*right, room / s->nx);
        } else if (s->nx < -1e-9) {
            *left = fmax(*left, room / s->nx);
        } else if (room < 0) {
            return 0;
        }
    }
    return *right > *left;
}

// Add the integrals over heights u to v of where a polygon begins and ends. Between its corners only the ends of arcs
// are steep; Simpson's rule along the angle of a half circle over the interval avoids both.
static void integrate(const struct side *side, int sides, double u, double v, double *left, double *right)
{
    enum { STEPS = 400 };
    for (int i = 1; i < STEPS; i++) {
        const double t = PI * i / STEPS, part = (v - u) / 2 * sin(t) * PI / STEPS * (i % 2 ? 4 : 2) / 3;
        double from, to;
        chord(side, sides, (u + v) / 2 - (v - u) / 2 * cos(t), &from, &to);
        *left += part * from;
        *right += part * to;
    }
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Row dy of the outline of radius r: its length is the shape's mean width over the part of the row's height that it
// covers.
static struct layers_run outline(const struct frame *f, double r, int dy)
{
    const struct hf_aperture_params *a = &f->aperture;
    // Half a turn of an even number of sides is none.
    const double rotation = a->rotation + (f->turned && a->blades % 2 ? 180.0f : 0);
    struct side side[16];
    double cut[2 + 3 * 16] = {(dy - 0.5) / r, (dy + 0.5) / r}, hit = 0, left = 0, right = 0, top = INFINITY,
                       low = -INFINITY;
    int cuts = 2;
    if (!a->blades) {
        const double u = fmax(dy - 0.5, -r), v = fmin(dy + 0.5, r);
        const double h =
            v > u ? (v * sqrt(r * r - v * v) + r * r * asin(v / r) - u * sqrt(r * r - u * u) - r * r * asin(u / r)) / 2
                  : 0;
        return (struct layers_run){-h * f->wide, h * f->wide, h > 0, -0.5, 0.5};
    }
    for (int i = 0; i < a->blades; i++) {
        side[i] = side_of(a, rotation, i);
        const double y[3] = {sin(2 * PI * (i + 0.5) / a->blades + rotation * PI / 180), side[i].cy - side[i].radius,
                             side[i].cy + side[i].radius};
        for (int k = 0; k < (side[i].radius > 0 ? 3 : 1); k++)
            if (y[k] > cut[0] && y[k] < cut[1])
                cut[cuts++] = y[k];
    }
    qsort(cut, (size_t)cuts, sizeof *cut, ascending);
    for (int i = 0; i + 1 < cuts; i++) {
        double from, to;
        if (cut[i + 1] <= cut[i] || !chord(side, a->blades, (cut[i] + cut[i + 1]) / 2, &from, &to))
            continue;
        integrate(side, a->blades, cut[i], cut[i + 1], &left, &right);
        hit += cut[i + 1] - cut[i];
        top = fmin(top, cut[i] * r - dy);
        low = fmax(low, cut[i + 1] * r - dy);
    }
    return hit * r > 1e-6 ? (struct layers_run){left / hit * r * f->wide, right / hit * r * f->wide, hit * r, top, low}
                          : (struct layers_run){0};
}

// Row dy of a shape: up to three runs.
static void make_row(const struct frame *f, double r, int dy, struct layers_run run[3])
{
    const struct layers_run o = outline(f, r, dy);
    struct layers_run hole = {0};
    if (f->aperture.ring > 0)
        hole = outline(f, r * f->aperture.ring, dy);
    hole.a = fmax(hole.a, o.a);
    hole.b = fmin(hole.b, o.b);
    run[0] = o;
    run[1] = run[2] = (struct layers_run){0};
    if (hole.weight > 0 && hole.b > hole.a) {
        run[0].b = hole.a;
        run[1] = (struct layers_run){hole.a, hole.b, o.weight - hole.weight, o.top, o.low};
        run[2] = (struct layers_run){hole.b, o.b, o.weight, o.top, o.low};
    }
}

// Add the part of each pixel of a row that a run covers; pixels' middles are at whole numbers.
static double cover(double *row, int reach, double a, double b, double weight)
{
    for (int x = -reach; x <= reach && b > a; x++)
        row[x + reach] += weight * fmax(0, fmin(b, x + 0.5) - fmax(a, x - 0.5));
    return b > a ? weight * (b - a) : 0;
}

// The part of texels `from` to `to` that a pixel covers, times their transmission; the picture has floats.
static double texels(const struct hf_image *m, int channel, double x0, double x1, double y0, double y1)
{
    double sum = 0;
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++) {
            const double w = fmin(x + 1, x1) - fmax(x, x0), h = fmin(y + 1, y1) - fmax(y, y0);
            const float *row = (const float *)(const void *)((const char *)m->data[0] + y * m->stride[0]);
            sum += w > 0 && h > 0 ? w * h * row[3 * x + channel] : 0;
        }
    return sum;
}

// The picture's shorter side is 2 r; what lies beyond twice that is cut off.
static double picture_shape(const struct frame *f, double r, int reach, double *w)
{
    const struct hf_image *m = f->aperture.picture;
    const double shorter = fmin(m->width, m->height), unit = shorter / 2 / r, step = unit / f->wide;
    const int high = (int)ceil(r * fmin(m->height / shorter, 2) - 0.5),
              across = (int)ceil(r * f->wide * fmin(m->width / shorter, 2) - 0.5), side = 2 * reach + 1;
    double sum = 0;
    for (int dy = -high; dy <= high; dy++)
        for (int dx = -across; dx <= across; dx++) {
            const double x0 = m->width / 2.0 + (dx - 0.5) * step, y0 = m->height / 2.0 + (dy - 0.5) * unit;
            const int at = (dy + reach) * side + dx + reach;
            sum += w[f->turned ? side * side - 1 - at : at] =
                texels(m, f->plane, x0, x0 + step, y0, y0 + unit) / (unit * step);
        }
    return sum;
}

struct layers_shape layers_shape_new(const struct frame *f, double r)
{
    struct layers_shape s = {.r = r, .reach = (int)ceil((f->aperture.picture ? 2 : 1) * r * fmax(f->wide, 1)) + 1};
    const size_t side = 2 * (size_t)s.reach + 1;
    s.run = calloc(3 * side, sizeof *s.run);
    s.weight = calloc(side * side, sizeof *s.weight);
    if (!s.run || !s.weight)
        abort();
    for (int i = 0; i < (int)side && r > 0 && !f->aperture.picture; i++)
        make_row(f, r, i - s.reach, s.run + 3 * i);
    layers_shape_cut(f, &s, 0, 0, INFINITY);
    return s;
}

void layers_shape_free(struct layers_shape *s)
{
    free(s->run);
    free(s->weight);
}

// Integral from 0 to t of half the width of a circle's rows.
static double half_circle(double r, double t)
{
    t = fmin(fmax(t, -r), r);
    return (t * sqrt(r * r - t * t) + r * r * asin(t / r)) / 2;
}

void layers_shape_cut(const struct frame *f, struct layers_shape *s, double x, double y, double r)
{
    const int side = 2 * s->reach + 1;
    double sum = 0;
    memset(s->weight, 0, sizeof *s->weight * (size_t)side * (size_t)side);
    if (f->aperture.picture && s->r > 0)
        sum = picture_shape(f, s->r, s->reach, s->weight);
    for (int i = 0; i < side && !f->aperture.picture; i++) {
        // The circle's mean width over the same heights as the outline's.
        const double top = i - s->reach + s->run[3 * i].top - y, low = i - s->reach + s->run[3 * i].low - y,
                     half = isinf(r)    ? r
                            : low > top ? f->wide * (half_circle(r, low) - half_circle(r, top)) / (low - top)
                                        : 0;
        for (int k = 3 * i; k < 3 * i + 3; k++)
            sum += cover(s->weight + i * side, s->reach, fmax(s->run[k].a, x - half), fmin(s->run[k].b, x + half),
                         s->run[k].weight);
    }
    if (sum <= 0)
        sum = s->weight[s->reach * side + s->reach] = 1;
    for (int i = 0; i < side * side; i++)
        s->weight[i] /= sum;
}
