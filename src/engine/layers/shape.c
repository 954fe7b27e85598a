// SPDX-License-Identifier: BSD-3-Clause
// Apertures other than discs: their rows at the sizes of the slices.
//
// A run covers the part of its row's height that the shape has, and that part is its weight. Its length is the shape's
// mean width over that part. So its area is exact. Sides of polygons are integrated one by one, from corner to corner.
#include "engine/layers/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct maker {
    const struct hf_shape_key *key;
    struct hf_side side[HF_SIDES];
    int sides;
    double corner[3 * HF_SIDES];  // heights at which a side ends or turns back
    int corners;
};

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct maker maker_of(const struct hf_shape_key *key)
{
    const double pi = 3.14159265358979323846;
    struct maker m = {.key = key};
    if (!key->blades)
        return m;
    m.sides = hf_aperture_sides(m.side, key->blades, key->rotation, key->roundness);
    for (int i = 0; i < m.sides; i++) {
        m.corner[m.corners++] = sin(2 * pi * (i + 0.5) / m.sides + key->rotation * (pi / 180));
        m.corner[m.corners++] = m.side[i].cy + m.side[i].radius;
        m.corner[m.corners++] = m.side[i].cy - m.side[i].radius;
    }
    qsort(m.corner, (size_t)m.corners, sizeof *m.corner, ascending);
    return m;
}

// Integral of a side's x over heights u to v. right: the side ends runs (else it begins them).
static double along(const struct hf_side *s, double u, double v, int right)
{
    if (s->radius <= 0)
        return (s->d - s->ny * (u + v) / 2) / s->nx * (v - u);
    const double w = hf_half_disc(s->radius, v - s->cy) - hf_half_disc(s->radius, u - s->cy);
    return s->cx * (v - u) + (right ? w : -w);
}

// One row of a shape of radius 1, from height u to v: its ends, the heights that it covers, and returns its weight, 0 if
// the row is empty.
static double polygon_row(const struct maker *m, double u, double v, double *a, double *b, double *top, double *low)
{
    double hit = 0, from = u;
    *a = *b = *top = *low = 0;
    for (int i = 0; i <= m->corners; i++) {
        const double to = i < m->corners ? m->corner[i] : v;
        double left, right;
        int of[2];
        if (to <= from || (i < m->corners && to >= v))
            continue;
        if (hf_aperture_run(m->side, m->sides, (from + to) / 2, &left, &right, of)) {
            *a += along(&m->side[of[0]], from, to, 0);
            *b += along(&m->side[of[1]], from, to, 1);
            *top = hit > 0 ? *top : from;
            *low = to;
            hit += to - from;
        }
        from = to;
    }
    if (hit <= 0)
        return 0;
    *a /= hit;
    *b /= hit;
    return hit / (v - u);
}

// Row dy of an outline of radius r, and the heights that it covers. Discs have the same rows as in slices.c.
static struct hf_shape_end outline(const struct maker *m, double r, int dy, struct hf_shape_row *row)
{
    const double wide = m->key->wide;
    row->top = -0.5f;
    row->low = 0.5f;
    if (m->sides) {
        double a, b, top, low;
        const double weight = polygon_row(m, (dy - 0.5) / r, (dy + 0.5) / r, &a, &b, &top, &low);
        row->top = (float)(top * r - dy);
        row->low = (float)(low * r - dy);
        return (struct hf_shape_end){(float)(a * r * wide), (float)(b * r * wide), weight > 1e-6 ? (float)weight : 0};
    }
    const double h = (hf_half_disc(r, dy + 0.5) - hf_half_disc(r, dy - 0.5)) * wide;
    return (struct hf_shape_end){(float)-h, (float)h, h > 0};
}

static int put(struct hf_shape_end *out, int n, float a, float b, float weight)
{
    if (b > a && weight > 0)
        out[n++] = (struct hf_shape_end){a, b, weight};
    return n;
}

// The runs of row dy of a shape; returns how many. A ring's hole takes the middle run away, or makes it lighter where
// the hole covers only a part of the row's height.
static int make_row(const struct maker *m, double r, int dy, struct hf_shape_row *row,
                    struct hf_shape_end out[HF_SHAPE_RUNS])
{
    const struct hf_shape_end o = outline(m, r, dy, row);
    struct hf_shape_end hole = {0};
    struct hf_shape_row unused;
    if (m->key->ring > 0)
        hole = outline(m, r * m->key->ring, dy, &unused);
    hole.a = hole.a > o.a ? hole.a : o.a;
    hole.b = hole.b < o.b ? hole.b : o.b;
    if (!(hole.weight > 0 && hole.b > hole.a))
        return put(out, 0, o.a, o.b, o.weight);
    int n = put(out, 0, o.a, hole.a, o.weight);
    n = put(out, n, hole.a, hole.b, o.weight - hole.weight);
    return put(out, n, hole.b, o.b, o.weight);
}

struct hf_shape_run hf_shape_run_of(float a, float b, float weight)
{
    const float from = a + 0.5f, to = b + 0.5f;
    const int first = (int)ceilf(from), last = (int)floorf(to);
    if (last < first)  // the run begins and ends within one pixel
        return (struct hf_shape_run){-last, 0, 0, to - from, weight};
    return (struct hf_shape_run){1 - last, last - first, to - (float)last, (float)first - from, weight};
}

static int log2_of(int n)
{
    int k = 0;
    while (n >> (k + 1))
        k++;
    return k;
}

// Make all rows of a shape.
static void make_shape(struct hf_shape *s, const struct maker *m, struct hf_shape_row *row, struct hf_shape_end *end,
                       struct hf_shape_run *run)
{
    int n = 0;
    s->row = row;
    s->end = end;
    s->run = run;
    s->sum = 0;
    s->reach = s->windows = 0;
    for (int i = 0; i < s->rows; i++) {
        row[i] = (struct hf_shape_row){.first = n};
        row[i].count = make_row(m, s->radius, s->top + i, &row[i], end + n);
        for (int j = n; j < n + row[i].count; j++) {
            run[j] = hf_shape_run_of(end[j].a, end[j].b, end[j].weight);
            s->sum += (double)end[j].weight * ((double)end[j].b - end[j].a);
            s->reach = hf_max(s->reach, hf_max((int)ceilf(end[j].b + 0.5f), (int)ceilf(0.5f - end[j].a)));
            s->windows = hf_max(s->windows, 1 + log2_of(run[j].length));
        }
        n += row[i].count;
    }
}

// Make one shape in memory; returns how many bytes it takes there. With memory NULL it only counts.
static size_t build_one(struct hf_shape *s, const struct maker *m, const struct hf_integral *area, uint8_t *memory)
{
    s->rows = 2 * (int)ceil(s->radius - 0.5) + 1;
    s->top = -(s->rows / 2);
    if (area)
        hf_shape_frame(s, area, m->key->wide);
    const size_t rows = (size_t)s->rows * sizeof(struct hf_shape_row);
    if (area) {
        if (memory)
            hf_shape_draw(s, area, m->key->wide, (struct hf_shape_row *)memory, (float *)(memory + rows),
                          m->key->rotation != 0);
        return rows + ((size_t)s->reach * 2 + 1 + 15) / 16 * 16 * (size_t)s->rows * sizeof(float);
    }
    const size_t runs = (size_t)s->rows * HF_SHAPE_RUNS;
    if (memory) {
        struct hf_shape_end *end = (struct hf_shape_end *)(memory + rows);
        make_shape(s, m, (struct hf_shape_row *)memory, end, (struct hf_shape_run *)(end + runs));
    }
    return rows + runs * (sizeof(struct hf_shape_end) + sizeof(struct hf_shape_run));
}

// Make all shapes in memory; returns how many bytes they take. With memory NULL it only counts.
static size_t build(struct hf_shapes *s, const struct hf_shape_size *size, const struct hf_integral *area,
                    uint8_t *memory, atomic_int *stop)
{
    const struct maker m = maker_of(&s->key);
    size_t used = 0;
    for (int i = 0; i < s->key.count; i++)
        for (int p = 0; p < s->planes; p++)
            for (int t = 0; t < 3 && !hf_stopped(stop); t++) {
                const int level = size[i].level, levels[3] = {level, hf_max(level, 1), 0};
                struct hf_shape shape = {.radius = (double)size[i].radius * s->key.factor / (1 << levels[t])};
                if (t && levels[t] == level) {
                    if (memory)
                        s->shape[i][p][t] = s->shape[i][p][0];
                    continue;
                }
                used += build_one(&shape, &m, area ? &area[p] : NULL, memory ? memory + used : NULL);
                used = (used + 63) & ~(size_t)63;
                if (memory)
                    s->shape[i][p][t] = shape;
            }
    return used;
}

int hf_shapes_build(struct hf_shapes *s, const struct hf_shape_key *key, const struct hf_shape_size *size,
                    const struct hf_image *picture, const struct hf_mem *mem, atomic_int *stop)
{
    struct hf_shape_key same = *key;
    same.count = hf_max(s->key.count, key->count);
    if (s->block.data && !memcmp(&s->key, &same, sizeof same))
        return HF_OK;
    struct hf_integral area[3];
    struct hf_block integrals = {0};
    s->key = *key;
    s->planes = picture && hf_aperture_coloured(picture, stop) ? 3 : 1;
    if (picture) {
        const size_t bytes = hf_integral_bytes(picture);
        const int err = hf_block_grow(&integrals, bytes * (size_t)s->planes, mem);
        if (err) {
            s->key.count = -1;
            return err;
        }
        for (int p = 0; p < s->planes; p++)
            area[p] = hf_integral_make((double *)integrals.data + bytes / sizeof(double) * (size_t)p, picture, p, stop);
    }
    const size_t table = ((size_t)key->count * sizeof *s->shape + 63) & ~(size_t)63;
    const size_t bytes = table + build(s, size, picture ? area : NULL, NULL, stop);
    int err = hf_block_grow(&s->block, bytes, mem);
    if (!err) {
        s->shape = s->block.data;
        if (bytes)
            build(s, size, picture ? area : NULL, (uint8_t *)s->block.data + table, stop);
        err = hf_stopped(stop) ? HF_ERR_CANCELLED : HF_OK;
    }
    if (err)
        s->key.count = -1;
    hf_block_free(&integrals, mem);
    return err;
}
