// SPDX-License-Identifier: BSD-3-Clause
// From which points of the lens views are made, and where slices lie seen from them.
#include <math.h>

#include "engine/layers/shape.h"
#include "engine/layers/slices.h"
#include "engine/layers/views.h"

// The size at which an aperture's shape is looked up, and the columns that it may have.
enum { SIZE = 64, COLUMNS = 4 * SIZE + 3 };

// 1 / the golden ratio: its multiples fill a line evenly. With v / n they are a lattice that fills a square evenly.
#define GOLDEN 0.61803398874989485

static double evenly(int v)
{
    const double at = 0.5 + v * GOLDEN;
    return at - floor(at);
}

static struct hf_shape_end part_of(const struct hf_shape *s, const struct hf_shape_row *row, int i)
{
    if (!s->weight)
        return s->end[row->first + i];
    const float middle = (float)(row->left + i);
    return (struct hf_shape_end){middle - 0.5f, middle + 0.5f, s->weight[row->first + i]};
}

// Where a row reaches `most` of its sum. Returns the sum.
static double row_at(const struct hf_shape *s, const struct hf_shape_row *row, double most, double *place)
{
    double sum = 0;
    for (int i = 0; i < row->count; i++) {
        const struct hf_shape_end e = part_of(s, row, i);
        const double more = ((double)e.b - (double)e.a) * (double)e.weight;
        if (sum < most && more > 0)
            *place = (double)e.a + fmin((most - sum) / (double)e.weight, (double)e.b - (double)e.a);
        sum += more;
    }
    return sum;
}

// The sums of a shape's rows or columns, from the first on.
struct sums {
    int first, count;
    double of[COLUMNS], all;
};

static void sum_rows(const struct hf_shape *s, struct sums *to)
{
    double unused;
    *to = (struct sums){.first = s->top, .count = hf_min(s->rows, COLUMNS)};
    for (int i = 0; i < to->count; i++)
        to->all += to->of[i] = row_at(s, &s->row[i], 0, &unused);
}

static void sum_columns(const struct hf_shape *s, double wide, struct sums *to)
{
    *to = (struct sums){.first = -COLUMNS / 2, .count = COLUMNS, .all = 0};
    for (int y = 0; y < s->rows; y++)
        for (int i = 0; i < s->row[y].count; i++) {
            const struct hf_shape_end e = part_of(s, &s->row[y], i);
            const double a = (double)e.a / wide, b = (double)e.b / wide;
            for (int x = hf_max((int)floor(a + 0.5), to->first); x <= (int)floor(b + 0.5) && x < to->first + COLUMNS;
                 x++) {
                const double part = (fmin(b, x + 0.5) - fmax(a, x - 0.5)) * (double)e.weight;
                to->of[x - to->first] += part > 0 ? part : 0;
                to->all += part > 0 ? part : 0;
            }
        }
}

// Where the sums reach the part u of all; *in: the row or column.
static double place_of(const struct sums *s, double u, int *in)
{
    double sum = 0;
    for (int i = 0; i < s->count; i++) {
        if (s->of[i] > 0 && (sum + s->of[i] >= u * s->all)) {
            *in = i;
            return s->first + i - 0.5 + (u * s->all - sum) / s->of[i];
        }
        sum += s->of[i];
    }
    *in = -1;
    return 0;  // a black picture
}

// A point of the lens stands for what lies around it, and is half cut when the second circle's rim passes it; but nothing is
// cut of a point beside the aperture's rim while both circles are one.
static float left_at_rim(const float point[2], int n)
{
    const float inside = (1 - hypotf(point[0], point[1])) * hf_layers_view_sharp(n);
    return 1 - hf_larger(inside < 0.5f ? inside : 0.5f, 0);
}

// Points of a shape, as dense as its light. A vertical or a horizontal edge shows how evenly points lie across it: so
// the sums of rows and columns are exact, to half a point.
static void place_points(const struct hf_shape *s, double wide, int n, float (*point)[3])
{
    struct sums rows, columns;
    sum_rows(s, &rows);
    sum_columns(s, wide, &columns);
    for (int v = 0; v < n; v++) {
        int row;
        double x = 0;
        point[v][1] = (float)(place_of(&rows, (v + 0.5) / n, &row) / SIZE);
        if (row >= 0)
            row_at(s, &s->row[row], evenly(v) * rows.of[row], &x);
        point[v][0] = (float)(x / (SIZE * wide));
    }
    float was[HF_LAYERS_MOST_VIEWS];
    for (int v = 0; v < n; v++)
        was[v] = point[v][0];
    for (int v = 0; v < n; v++) {
        int rank = 0, column;
        for (int i = 0; i < n; i++)
            rank += was[i] < was[v] || (was[i] == was[v] && i < v);
        point[v][0] = (float)(place_of(&columns, (rank + 0.5) / n, &column) / SIZE);
        point[v][2] = left_at_rim(point[v], n);
    }
}

// The light of a shape around a point of the lens, as far as the next points.
static double light_around(const struct hf_shape *s, double wide, int n, const float point[2])
{
    const double half = SIZE * sqrt(M_PI / n) / 2, x = (double)point[0] * SIZE * wide, y = (double)point[1] * SIZE;
    double sum = 0;
    for (int i = 0; i < s->rows; i++) {
        const double at = s->top + i, high = fmin(at + 0.5, y + half) - fmax(at - 0.5, y - half);
        for (int k = 0; k < s->row[i].count && high > 0; k++) {
            const struct hf_shape_end e = part_of(s, &s->row[i], k);
            const double across = fmin((double)e.b, x + half * wide) - fmax((double)e.a, x - half * wide);
            sum += across > 0 ? high * across * (double)e.weight : 0;
        }
    }
    return sum;
}

// The near stack is made from the same points of every aperture but a picture, and each counts by the aperture's light around it:
// displacements are whole pixels, so points that move with the aperture's shape would let the picture jump.
static int make_parts(struct hf_layers *l, const struct hf_shape_key *key, const struct hf_shape_size *size,
                      const struct hf_mem *mem)
{
    const int n = l->set.views;
    struct hf_shape_key disc = *key;
    double all = 0;
    disc.blades = 0;
    disc.rotation = disc.roundness = disc.ring = 0;
    int err = hf_shapes_build(&l->lens, &disc, size, NULL, mem, l->stop);
    if (err)
        return err;
    for (int g = 0; g < l->groups; g++)
        place_points(&l->lens.shape[0][0][2], l->wide, n, l->point[g]);
    if (!key->blades && !(key->ring > 0)) {
        l->view_part = NULL;
        return HF_OK;
    }
    for (int v = 0; v < n; v++)
        l->view_part[v] = (float)light_around(&l->lens.shape[0][0][2], l->wide, n, l->point[0][v]);
    err = hf_shapes_build(&l->lens, key, size, NULL, mem, l->stop);
    for (int v = 0; !err && v < n; v++)
        all += l->view_part[v] =
            (float)light_around(&l->lens.shape[0][0][2], l->wide, n, l->point[0][v]) / l->view_part[v];
    for (int v = 0; !err && v < n; v++)
        l->view_part[v] = (float)(l->view_part[v] * n / all);
    return err;
}

static int make_points(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem)
{
    struct hf_shape_key key = l->key;
    const struct hf_shape_size size = {.radius = SIZE};
    key.count = 1;
    key.factor = 1;
    if (!picture)
        return make_parts(l, &key, &size, mem);
    l->view_part = NULL;
    const int err = hf_shapes_build(&l->lens, &key, &size, picture, mem, l->stop);
    for (int g = 0; !err && g < l->groups && !hf_stopped(l->stop); g++)
        place_points(&l->lens.shape[0][l->lens.planes == 3 ? g : 0][2], l->wide, l->set.views, l->point[g]);
    return err ? err : hf_stopped(l->stop) ? HF_ERR_CANCELLED : HF_OK;
}

// How far out a point lies along a row or a column, in radii; at least 1. Not by fmax: gcc 12 for aarch64 stops with an
// internal error where it vectorizes two of them as one reduction.
static double farthest_point(const struct hf_layers *l)
{
    double most = 1;
    for (int g = 0; g < l->groups; g++)
        for (int v = 0; v < l->set.views; v++) {
            const double across = fabs((double)l->point[g][v][0]) * l->wide, down = fabs((double)l->point[g][v][1]);
            if (across > most)
                most = across;
            if (down > most)
                most = down;
        }
    return most;
}

int hf_layers_make_views(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem)
{
    const size_t n = (size_t)l->set.views, slices = (size_t)l->slices, groups = (size_t)l->groups;
    if (hf_block_grow(&l->views,
                      n * sizeof *l->view_part + groups * n * (sizeof *l->point[0] + slices * sizeof *l->shift[0]),
                      mem))
        return HF_ERR_MEMORY;
    char *at = l->views.data;
    l->view_part = (float *)(void *)at;
    at += n * sizeof *l->view_part;
    for (size_t g = 0; g < groups; g++) {
        l->point[g] = (float(*)[3])(void *)(at + g * n * sizeof *l->point[0]);
        l->shift[g] =
            (int16_t(*)[2])(void *)(at + groups * n * sizeof *l->point[0] + g * n * slices * sizeof *l->shift[0]);
    }
    const int err = make_points(l, picture, mem);
    if (err)
        return err;
    l->lens_reach = farthest_point(l);
    for (int g = 0; g < l->groups; g++)
        for (int i = 0; i < l->slices; i++) {
            const double pixel = 1 << l->set.near_only, r = hf_layers_view_radius(l, g, i) / pixel;
            for (int v = 0; v < l->set.views && fabs(r) <= 2 * (double)hf_layers_view_most(l); v++) {
                l->shift[g][i * l->set.views + v][0] = (int16_t)floor(0.5 - r * l->wide * (double)l->point[g][v][0]);
                l->shift[g][i * l->set.views + v][1] = (int16_t)floor(0.5 - r * (double)l->point[g][v][1]);
            }
        }
    return HF_OK;
}
