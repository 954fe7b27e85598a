// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/aperture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double hf_half_disc(double r, double y)
{
    const double t = y > r ? r : y < -r ? -r : y;
    return (t * sqrt(r * r - t * t) + r * r * asin(t / r)) / 2;
}

// How much of the height of row dy a disc covers, in 1 / HF_WHOLE_ROW.
static int row_height(double r, int dy)
{
    const double height = r - (abs(dy) - 0.5);
    return dy == 0 || height >= 1 ? HF_WHOLE_ROW : height <= 0 ? 0 : (int)lround(HF_WHOLE_ROW * height);
}

// Half the disc's mean width over the covered part of row dy, plus half a pixel, in 1/256 pixel.
static int32_t disc_row(double r, double scale_x, int dy)
{
    const double height = dy ? fmin(1, r - (abs(dy) - 0.5)) : 1;
    if (height <= 0)
        return 128;
    return (int32_t)lround(256 * ((hf_half_disc(r, dy + 0.5) - hf_half_disc(r, dy - 0.5)) / height * scale_x + 0.5));
}

// The number of rows on one side, including the middle one.
static int rows_of(double r)
{
    return (int)ceil(r + 0.5);
}

static void build_disc(struct hf_aperture *a, int number, int first)
{
    struct hf_picture *p = &a->picture[number];
    const double r = hf_picture_radius(number);
    double area = 0;
    *p = (struct hf_picture){.first = first, .rows = rows_of(r)};
    for (int dy = 0; dy < p->rows; dy++) {
        a->half[first + dy] = disc_row(r, a->key.scale_x, dy);
        area += (dy ? 2.0 : 1.0) * (2 * a->half[first + dy] - 256) * row_height(r, dy);
    }
    // Leave out rows that round to nothing.
    while (p->rows > 1 && (a->half[first + p->rows - 1] <= 128 || !row_height(r, p->rows - 1)))
        p->rows--;
    if (area <= 0) {
        a->half[first] = 129;
        area = 2 * HF_WHOLE_ROW;
    }
    p->cap = row_height(r, p->rows - 1);
    p->reach_y = p->rows - 1;
    p->reach_x = (a->half[first] >> 8) + 1;
    p->area = (float)area;
}

int hf_aperture_sides(struct hf_side side[HF_SIDES], int blades, double rotation, double roundness)
{
    const double pi = 3.14159265358979323846, d = cos(pi / blades), h = sin(pi / blades);
    const double sagitta = roundness * (1 - d),
                 radius = sagitta > 1e-6 ? (h * h + sagitta * sagitta) / (2 * sagitta) : 0;
    for (int i = 0; i < blades; i++) {
        const double angle = 2 * pi * i / blades + rotation * (pi / 180), back = d + sagitta - radius;
        side[i] = (struct hf_side){.nx = cos(angle), .ny = sin(angle), .d = d, .radius = radius};
        side[i].cx = side[i].nx * back;
        side[i].cy = side[i].ny * back;
    }
    return blades;
}

static void later(double x, int i, double *a, int *of)
{
    if (x > *a) {
        *a = x;
        *of = i;
    }
}

static void sooner(double x, int i, double *b, int *of)
{
    if (x < *b) {
        *b = x;
        *of = i;
    }
}

int hf_aperture_run(const struct hf_side *side, int sides, double y, double *a, double *b, int of[2])
{
    *a = -2;
    *b = 2;
    of[0] = of[1] = 0;
    for (int i = 0; i < sides; i++) {
        const struct hf_side *s = &side[i];
        if (s->radius > 0) {
            const double q = s->radius * s->radius - (y - s->cy) * (y - s->cy), w = q > 0 ? sqrt(q) : -1;
            if (w < 0)
                return 0;
            later(s->cx - w, i, a, &of[0]);
            sooner(s->cx + w, i, b, &of[1]);
        } else if (fabs(s->nx) < 1e-9) {
            if (s->ny * y > s->d)
                return 0;
        } else if (s->nx > 0) {
            sooner((s->d - s->ny * y) / s->nx, i, b, &of[1]);
        } else {
            later((s->d - s->ny * y) / s->nx, i, a, &of[0]);
        }
    }
    return *b > *a;
}

// How far a polygon extends upwards (sign -1) or downwards (1) from its centre.
static double polygon_end(const struct hf_side *side, int sides, double sign)
{
    double in = 0, out = 1 + 1e-9;
    for (int i = 0; i < 40; i++) {
        const double y = (in + out) / 2;
        double a, b;
        int of[2];
        if (hf_aperture_run(side, sides, sign * y, &a, &b, of))
            in = y;
        else
            out = y;
    }
    return sign * in;
}

// A polygon's sides, and from where to where it extends.
struct polygon {
    struct hf_side side[HF_SIDES];
    int sides;
    double top, bottom;
};

// Row dy of a polygon: the mean ends of its runs within the part of the row that it covers, and that part of the row's
// height.
static struct hf_run polygon_row(const struct polygon *p, double r, double scale_x, int dy)
{
    enum { PARTS = 8 };
    const double y0 = fmax(dy - 0.5, p->top * r), y1 = fmin(dy + 0.5, p->bottom * r), height = y1 - y0;
    double a = 0, b = 0;
    const int32_t weight = height > 0 ? (int32_t)lround(HF_WHOLE_ROW * height) : 0;
    if (!weight)
        return (struct hf_run){0};
    for (int i = 0; i < PARTS; i++) {
        double left, right;
        int of[2];
        hf_aperture_run(p->side, p->sides, (y0 + (i + 0.5) / PARTS * height) / r, &left, &right, of);
        a += left;
        b += right;
    }
    return (struct hf_run){(int32_t)lround(256 * (a / PARTS * r * scale_x + 0.5)),
                           (int32_t)lround(256 * (b / PARTS * r * scale_x + 0.5)), weight};
}

// Row dy of a disc that a cat's eye will cut.
static struct hf_run disc_run(double r, double scale_x, int dy)
{
    const int32_t half = disc_row(r, scale_x, dy);
    return (struct hf_run){256 - half, half, row_height(r, dy)};
}

// Make a sprite of runs: of a polygon, or of a disc if it has no sides.
static void build_runs(struct hf_aperture *a, const struct polygon *polygon, int number, int first)
{
    struct hf_picture *p = &a->picture[number];
    const double r = hf_picture_radius(number);
    double area = 0;
    *p = (struct hf_picture){.first = first, .top = 1 - rows_of(r), .rows = 2 * rows_of(r) - 1};
    p->reach_y = rows_of(r) - 1;
    for (int i = 0; i < p->rows; i++) {
        struct hf_run *run = &a->run[first + i];
        *run = polygon->sides ? polygon_row(polygon, r, a->key.scale_x, p->top + i)
                              : disc_run(r, a->key.scale_x, p->top + i);
        area += (double)run->weight * (run->b - run->a);
        p->reach_x = hf_max(p->reach_x, hf_max((run->b >> 8) + 1, -(run->a >> 8)) + (polygon->sides > 0));
    }
    if (area <= 0) {
        a->run[first - p->top] = (struct hf_run){127, 129, HF_WHOLE_ROW};
        area = 2 * HF_WHOLE_ROW;
    }
    p->area = (float)area;
}

// The bits above the brightest sample that sums of discs up to this radius need.
static int disc_headroom(float largest)
{
    return largest < 20 ? 3 : largest < 1096 ? 4 : 5;
}

int hf_aperture_build(struct hf_aperture *a, const struct hf_aperture_key *key, const struct hf_mem *mem,
                      atomic_int *stop)
{
    if (a->count && !memcmp(&a->key, key, sizeof *key))
        return HF_OK;
    a->count = hf_picture_number(key->largest) + 2;
    a->key = *key;
    a->tap = NULL;
    a->planes = a->steps = 1;
    a->symmetric = !key->blades && !key->outline;
    // Pixels of any radii around one pixel add up to less than 2 ln(r) + 2 times the brightest sample for discs (6.5 for
    // 7.0 at radius 12, 11.5 for 12.0 at 148, at any width), and to more for sprites that are smaller at the same radius.
    a->headroom = key->blades ? 7 : key->outline ? 5 : disc_headroom(key->largest);
    const size_t row = a->symmetric ? sizeof *a->half : 2 * sizeof *a->run;
    size_t rows = 0;
    for (int i = 0; i < a->count; i++)
        rows += (size_t)rows_of(hf_picture_radius(i));
    const size_t picture = sizeof *a->picture + sizeof *a->inverse;
    const int err = hf_block_grow(&a->block, (size_t)a->count * picture + rows * row, mem);
    if (err) {
        a->count = 0;
        return err;
    }
    a->picture = a->block.data;
    a->inverse = (float *)(a->picture + a->count);
    a->half = (int32_t *)(a->inverse + a->count);
    a->run = (struct hf_run *)a->half;
    struct polygon polygon = {.sides = 0};
    if (key->blades) {
        polygon.sides = hf_aperture_sides(polygon.side, key->blades, key->rotation, key->roundness);
        polygon.top = polygon_end(polygon.side, polygon.sides, -1);
        polygon.bottom = polygon_end(polygon.side, polygon.sides, 1);
    }
    for (int i = 0, first = 0; i < a->count; i++) {
        if (hf_stopped(stop)) {
            a->count = 0;
            return HF_ERR_CANCELLED;
        }
        if (a->symmetric)
            build_disc(a, i, first);
        else
            build_runs(a, &polygon, i, first);
        a->inverse[i] = 1 / a->picture[i].area;
        first += (a->symmetric ? 1 : 2) * rows_of(hf_picture_radius(i));
    }
    return HF_OK;
}
