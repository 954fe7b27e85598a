// SPDX-License-Identifier: BSD-3-Clause
#include "layers/slices.h"

#include <math.h>

// The radius after r >= 0. Far out, slices lie a share of their radius apart, which nobody sees.
static float next_radius(const struct hf_layers_settings *set, float r)
{
    const float far_out = r / 32;
    if (set->fine)
        return r + fminf(fmaxf(0.5f, r / 4), fmaxf(1, r / 16)) * set->spacing / 2;
    return r < 2                        ? r + fminf(1, set->spacing)
           : r == 2 && set->spacing > 2 ? set->spacing
                                        : r + fmaxf(set->spacing, far_out);
}

static int level_of(const struct hf_layers_settings *set, float radius)
{
    const float r = fabsf(radius);
    return r < set->half ? 0 : r < set->quarter ? 1 : r < 4 * set->quarter ? 2 : 3;
}

// Rows on one side of a disc, the middle one counted.
static int disc_rows(double r)
{
    return r > 0 ? (int)ceil(r - 0.5) + 1 : 1;
}

// Integral from 0 to t of the half-width of the rows of a disc of radius r.
static double half_disc(double r, double t)
{
    t = t > r ? r : t < -r ? -r : t;
    return (t * sqrt(r * r - t * t) + r * r * asin(t / r)) / 2;
}

// A disc of radius r, wide times as wide. r 0: the pixel itself.
static void make_disc(struct hf_slice *s, double r, double wide, struct hf_disc_row *row)
{
    const double pi = 3.14159265358979323846;
    s->rows = disc_rows(r);
    s->row = row;
    s->scale = 1;
    s->reach = 0;
    double sum = 0;
    for (int d = 0; d < s->rows; d++) {
        const double h = r > 0 ? (half_disc(r, d + 0.5) - half_disc(r, d - 0.5)) * wide : 0.5;
        const double whole = floor(h - 0.5);
        row[d].n = h < 0.5 ? -1 : (int)whole;
        row[d].f = (float)(h < 0.5 ? h : h - 0.5 - whole);
        sum += (d ? 4 : 2) * h;
        s->reach = row[d].n + 1 > s->reach ? row[d].n + 1 : s->reach;
    }
    if (r > 0)
        s->scale = (float)(1 / (sum > 0 ? sum : pi * r * r * wide));
    s->reach = s->rows - 1 > s->reach ? s->rows - 1 : s->reach;
}

static void set_neighbours(struct hf_slice *slice, int count)
{
    for (int i = 0; i < count; i++) {
        struct hf_slice *s = &slice[i];
        const float before = i ? slice[i - 1].radius : 0, after = i + 1 < count ? slice[i + 1].radius : 0;
        s->square = s->radius * s->radius;
        s->before = i ? before : -HUGE_VALF;
        s->after = i + 1 < count ? after : HUGE_VALF;
        s->before_square = before * before;
        s->before_scale = i ? 1 / (s->square - before * before) : 0;
        s->after_scale = i + 1 < count ? 1 / (after * after - s->square) : 0;
    }
}

// Slices and rows of discs on one side, the one at 0 not counted.
static int count_slices(const struct hf_layers_settings *set, float limit, size_t *rows)
{
    int n = 0;
    for (float r = 0; r < limit; n++) {
        r = next_radius(set, r);
        *rows += 3 * (size_t)disc_rows(r);
    }
    return n;
}

size_t hf_layers_slice_bytes(const struct hf_layers *l, float limit)
{
    size_t rows = 3;
    const int n = 2 * count_slices(&l->set, limit, &rows) + 1;
    return 3 * (size_t)n * sizeof(struct hf_slice) + 2 * rows * sizeof(struct hf_disc_row);
}

// One radius as all three tables hold it.
static struct hf_disc_row *make_slice(struct hf_layers *l, int i, float radius, struct hf_disc_row *row)
{
    const int level = level_of(&l->set, radius), coarse = level > 1 ? level : 1;
    struct hf_slice *const tables[3] = {l->slice, l->behind, l->shine};
    const int levels[3] = {level, coarse, 0}, finest[3] = {0, 1, 0};
    for (int t = 0; t < 3; t++) {
        struct hf_slice *s = &tables[t][i];
        *s = (struct hf_slice){.radius = radius, .level = levels[t]};
        make_disc(s, fabs((double)radius) / (1 << levels[t]), l->wide, row);
        s->scale /= (float)(1 << 2 * (levels[t] - finest[t]));
        row += s->rows;
    }
    return row;
}

void hf_layers_make_slices(struct hf_layers *l)
{
    size_t unused = 0;
    const int near = count_slices(&l->set, -l->nearest, &unused), far = count_slices(&l->set, l->farthest, &unused);
    l->slices = near + 1 + far;
    l->slice = l->tables.data;
    l->behind = l->slice + l->slices;
    l->shine = l->behind + l->slices;
    struct hf_disc_row *row = (struct hf_disc_row *)(l->shine + l->slices);
    float r = 0;
    row = make_slice(l, near, 0, row);
    for (int i = 1; i <= near; i++)
        row = make_slice(l, near - i, -(r = next_radius(&l->set, r)), row);
    r = 0;
    for (int i = 1; i <= far; i++)
        row = make_slice(l, near + i, r = next_radius(&l->set, r), row);
    set_neighbours(l->slice, l->slices);
    set_neighbours(l->behind, l->slices);
    set_neighbours(l->shine, l->slices);
}

int hf_layers_tiles_around(const struct hf_slice *s)
{
    return (((s->reach + 3 + HF_LAYERS_MARGIN) << s->level) + HF_LAYERS_TILE - 1) / HF_LAYERS_TILE;
}

int hf_layers_most_tiles(const struct hf_layers *l)
{
    int most = 0;
    for (int i = 0; i < l->slices; i++) {
        const struct hf_slice *all[3] = {&l->slice[i], &l->behind[i], &l->shine[i]};
        for (int j = 0; j < 3; j++) {
            const int n = hf_layers_tiles_around(all[j]);
            most = n > most ? n : most;
        }
    }
    return most;
}
