// SPDX-License-Identifier: BSD-3-Clause
#include "engine/layers/slices.h"

#include <math.h>
#include <stdlib.h>

#include "engine/layers/kernels.h"

// The radius of the slice after r >= 0. Large radii lie a fixed part of their radius apart, which nobody sees. There is
// no slice between 0 and 1: a disc no larger than its pixel would be as sharp as the pixel, while a mixture of 0 and 1
// is not.
static float next_radius(const struct hf_layers_settings *set, float r)
{
    const float far_out = r / 32;
    if (r < 1)
        return r + 1;
    if (set->fine > 1)
        return r + fminf(fmaxf(0.5f, r / 4), fmaxf(1, r / 16)) * set->spacing / 2;
    // A mixture of two discs shows where one is much larger than the other, so small radii lie closer.
    return r + fmaxf(fminf(fmaxf(1, floorf(r / (float)(2 + set->fine))), set->spacing), far_out);
}

static int level_of(const struct hf_layers_settings *set, float radius)
{
    const float r = fabsf(radius);
    return r < set->half ? 0 : r < set->quarter ? 1 : r < set->eighth ? 2 : 3;
}

// Hidden samples are guesses, so every other slice of theirs is left out, if its neighbours have at most a quarter of
// the resolution and lie within an eighth of its radius of each other. n: the slice's number, counted from the focus.
static int is_left_out(const struct hf_layers_settings *set, int n, float before, float r)
{
    return n % 2 && level_of(set, before) > 1 && next_radius(set, r) - before <= r / 8;
}

// The largest part of a sample that a cover draws: that of the slice it stands for, at the cover's radius.
#define HF_LAYERS_COVER 0.875f

// Rows on one side of a disc, including the middle one.
static int disc_rows(double r)
{
    return r > 0 ? (int)ceil(r - 0.5) + 1 : 1;
}

// A disc of radius r, `wide` times as wide as high. r 0: the pixel itself.
static void make_disc(struct hf_slice *s, double r, double wide, struct hf_disc_row *row)
{
    const double pi = 3.14159265358979323846;
    s->rows = disc_rows(r);
    s->row = row;
    s->scale = 1;
    s->reach = 0;
    double sum = 0, from = r > 0 ? hf_half_disc(r, -0.5) : 0;
    for (int d = 0; d < s->rows; d++) {
        const double to = r > 0 ? hf_half_disc(r, d + 0.5) : 0, h = r > 0 ? (to - from) * wide : 0.5;
        from = to;
        const double whole = floor(h - 0.5);
        row[d].n = h < 0.5 ? -1 : (int)whole;
        row[d].f = (float)(h < 0.5 ? 2 * h : h - 0.5 - whole);
        sum += (d ? 4 : 2) * h;
        s->reach = row[d].n + 1 > s->reach ? row[d].n + 1 : s->reach;
    }
    if (r > 0)
        s->scale = (float)(1 / (sum > 0 ? sum : pi * r * r * wide));
    s->reach = s->rows - 1 > s->reach ? s->rows - 1 : s->reach;
}

// Samples beyond the outermost slices are theirs as a whole: rounding may put a mean of radii beyond the largest of them. Weighing
// knows no slice without neighbours, so the first one's part begins to grow so far away that it is 1 wherever samples are.
#define BEYOND 0x1p100f

static void set_neighbours(struct hf_slice *slice, int count)
{
    for (int i = 0; i < count; i++) {
        struct hf_slice *s = &slice[i];
        int a = i - 1, z = i + 1;
        while (a >= 0 && slice[a].empty)
            a--;
        while (z < count && slice[z].empty)
            z++;
        const float before = a >= 0 ? slice[a].radius : 0, after = z < count ? slice[z].radius : 0;
        s->square = s->radius * s->radius;
        s->before = a >= 0 ? before : -HUGE_VALF;
        s->after = z < count ? after : HUGE_VALF;
        s->before_square = a >= 0 ? before * before : -BEYOND;
        s->before_scale = a >= 0 ? 1 / (s->square - before * before) : 1 / BEYOND;
        s->after_scale = z < count ? 1 / (after * after - s->square) : 0;
    }
}

// Count the slices and rows of discs on one side, without the slice at 0. The last one is never left out, or hidden
// samples next to it would jump when the range of radii needs the following slice.
static int count_slices(const struct hf_layers *l, float limit, size_t *rows)
{
    int n = 0;
    for (float r = 0, before = 0; r < limit || is_left_out(&l->set, n, before, r); n++) {
        before = r;
        r = next_radius(&l->set, r);
        *rows += (size_t)(2 + l->parts) * (size_t)disc_rows(r * (1 + fabsf(l->chromatic)));
    }
    return n;
}

size_t hf_layers_slice_bytes(const struct hf_layers *l, float limit)
{
    size_t rows = 3 + 2 * (size_t)disc_rows(limit);
    const size_t side = (size_t)count_slices(l, limit, &rows), n = 2 * side + 1;
    const size_t group =
        ((size_t)(2 + l->parts) * n + 2) * sizeof(struct hf_slice) + 2 * rows * sizeof(struct hf_disc_row);
    return (size_t)l->groups * group + side * sizeof(struct hf_shape_size);
}

// The relative change of a group's radius: red discs are larger behind the focus and smaller before it, blue ones the
// other way.
static float shift_of(const struct hf_layers *l, int group, float radius)
{
    const float shift = group == 0 ? l->chromatic : group == 2 ? -l->chromatic : 0;
    return radius < 0 ? -shift : shift;
}

// Make the slice of a radius, the number'th from 0. which: index in hf_shapes; 0 and 2 draw samples of single pixels.
static struct hf_disc_row *make_slice(struct hf_layers *l, struct hf_slice *s, int group, float radius, int number,
                                      int which, struct hf_disc_row *row)
{
    const int finest = which == 1, level = which == 2 ? 0 : hf_max(level_of(&l->set, radius), finest);
    const float shift = shift_of(l, group, radius);
    *s = (struct hf_slice){.radius = radius, .level = level, .sparse = which == 2};
    if (l->shaped && number > 0) {
        const struct hf_shapes *shapes = &l->shapes[l->turned && radius < 0][shift > 0 ? 1 : shift < 0 ? 2 : 0];
        s->shape = &shapes->shape[number - 1][shapes->planes == 3 ? group : 0][which];
        s->rows = 1 - s->shape->top;
        s->reach = hf_max(s->shape->reach + 1, s->rows);
        s->scale = (float)(1 / s->shape->sum);
    } else {
        make_disc(s, fabs((double)radius) * (1 + shift) / (1 << level), l->wide, row);
        row += s->rows;
    }
    s->scale /= (float)(1 << 2 * (level - finest));
    return row;
}

// Make the slices of one radius for visible and for hidden samples. before: size of the radius towards the focus.
static struct hf_disc_row *make_both(struct hf_layers *l, int group, int i, float radius, int number, float before,
                                     struct hf_disc_row *row)
{
    struct hf_slice *s = l->group[group] + i;
    row = make_slice(l, s, group, radius, number, 0, row);
    row = make_slice(l, s + l->slices, group, radius, number, 1, row);
    s[l->slices].empty = is_left_out(&l->set, number, before, fabsf(radius));
    return row;
}

// Make a group's slices of shares: one at each slice's radius, and more between two slices of lower resolution.
static struct hf_disc_row *make_shines(struct hf_layers *l, int group, int middle, struct hf_disc_row *row)
{
    struct hf_slice *of = l->group[group], *s = of + 2 * l->slices;
    l->shines = 0;
    for (int i = 0; i < l->slices && !hf_stopped(l->stop); i++) {
        const int last = i + 1 == l->slices, parts = !last && of[i].level && of[i + 1].level ? l->parts : 1;
        const float apart = last ? 0 : of[i + 1].radius - of[i].radius;
        of[i].shine = l->shines;
        for (int k = 0; k < parts; k++) {
            const float r = of[i].radius + apart * (float)k / (float)parts;
            row = make_slice(l, &s[l->shines++], group, r, abs(i - middle), 2, row);
        }
    }
    return row;
}

// Make the covers: the last full-resolution slice before the far ones, again at half the resolution, for samples that
// it shares with the next slice. A cover's part of a sample starts at 0 at the slice's own radius, or it would cover
// abruptly.
static struct hf_disc_row *make_covers(struct hf_layers *l, int group, int middle, struct hf_disc_row *row)
{
    const struct hf_slice *s = l->group[group];
    int i = middle;
    while (i + 1 < l->slices && s[i + 1].level == 0)
        i++;
    l->last = i + 1 < l->slices ? i : -1;
    for (int t = 0; t < 2 && l->last >= 0; t++) {
        struct hf_slice *c = l->group[group] + (2 + l->parts) * l->slices + t;
        const float from = s[i].radius * s[i].radius, to = s[i + 1].radius * s[i + 1].radius;
        row = make_slice(l, c, group, s[i].radius, i - middle, 1, row);
        c->scale *= t ? HF_LAYERS_COVER : HF_LAYERS_COVER / 4;
        c->before = s[i].radius;
        c->after = s[i + 1].radius;
        c->before_square = from;
        c->square = HF_LAYERS_COVER * from + (1 - HF_LAYERS_COVER) * to;
        c->radius = sqrtf(c->square);
        c->before_scale = 1 / (c->square - from);
        c->after_scale = 1 / (to - c->square);
    }
    return row;
}

static int slices_of(const struct hf_layers *l, float limit)
{
    size_t unused = 0;
    return count_slices(l, limit, &unused);
}

int hf_layers_make_shapes(struct hf_layers *l, const struct hf_image *picture, const struct hf_mem *mem)
{
    struct hf_shape_size *size = l->tables.data;
    struct hf_shape_key key = l->key;
    float r = 0;
    const int before = slices_of(l, -l->nearest), behind = slices_of(l, l->farthest), most = hf_max(before, behind);
    for (int i = 0; i < most; i++) {
        size[i].radius = r = next_radius(&l->set, r);
        size[i].level = level_of(&l->set, r);
    }
    l->most_windows = l->most_rows = 0;
    const int factors = l->chromatic != 0 ? 3 : 1;
    for (int n = 0; n < (l->turned ? 2 : 1) * factors; n++) {
        const int near = n / factors, i = n % factors;
        struct hf_shapes *s = &l->shapes[near][i];
        key.count = !l->turned ? most : near ? before : behind;
        key.rotation = l->key.rotation + (near ? 180.0f : 0);
        key.factor = 1 + (i == 1 ? fabsf(l->chromatic) : i == 2 ? -fabsf(l->chromatic) : 0);
        const int err = hf_shapes_build(s, &key, size, picture, mem, l->stop);
        if (err)
            return err;
        for (int j = 0; j < key.count; j++)
            for (int k = 0; k < 3 * s->planes; k++) {
                l->most_windows = hf_max(l->most_windows, s->shape[j][k / 3][k % 3].windows);
                l->most_rows = hf_max(l->most_rows, s->shape[j][k / 3][k % 3].rows);
            }
    }
    return HF_OK;
}

// The largest sample for which no sum exceeds the largest float. Weights of samples add up to 7 at most, and a source's
// scale is large where its shape has little area, as a narrow ring or a dark picture has.
static float largest_sample(const struct hf_layers *l)
{
    float scale = 4;
    for (int g = 0; g < l->groups; g++)
        for (int i = 0; i < 2 * l->slices + l->shines; i++)
            scale = fmaxf(scale, l->group[g][i].scale);
    return 1.7014118e38f / scale;  // 2^127: 2^125 for discs
}

void hf_layers_make_slices(struct hf_layers *l)
{
    const int near = slices_of(l, -l->nearest), far = slices_of(l, l->farthest);
    l->focus = near;
    l->slices = near + 1 + far;
    struct hf_slice *at = l->tables.data;
    for (int g = 0; g < l->groups; g++, at += (2 + l->parts) * l->slices + 2)
        l->group[g] = at;
    struct hf_disc_row *row = (struct hf_disc_row *)at;
    l->most_tiles = 0;
    for (int g = 0; g < l->groups; g++) {
        row = make_both(l, g, near, 0, 0, 0, row);
        for (int side = -1; side <= 1; side += 2) {
            float before = 0, r;
            for (int i = 1; i <= (side < 0 ? near : far) && !hf_stopped(l->stop); i++, before = r) {
                r = next_radius(&l->set, before);
                row = make_both(l, g, near + side * i, (float)side * r, i, before, row);
            }
        }
        row = make_shines(l, g, near, row);
        if (hf_stopped(l->stop))
            return;
        for (int t = 0; t < 3; t++)
            set_neighbours(l->group[g] + t * l->slices, t < 2 ? l->slices : l->shines);
        row = make_covers(l, g, near, row);
        for (int i = 0; i < 2 * l->slices + l->shines; i++)
            l->most_tiles = hf_max(l->most_tiles, hf_layers_tiles_around(l->group[g] + i));
    }
    l->largest = largest_sample(l);
    hf_layers_use_group(l, 0);
}

void hf_layers_use_group(struct hf_layers *l, int group)
{
    l->slice = l->group[group];
    l->behind = l->slice + l->slices;
    l->shine = l->behind + l->slices;
    l->cover = l->slice + (2 + l->parts) * l->slices;
    l->group_used = group;
}

// Whether a slice is the first of two that views of the near stack take for one; the second is farther from the focus. Their
// number is counted from the focus, so a nearer sample elsewhere changes no pair.
static int begins_pair(const struct hf_layers *l, int i)
{
    const int n = l->focus - i;
    return l->set.near_only && n > 0 && n % 2 && l->slice[i].level > 0;
}

int hf_layers_view_slice(const struct hf_layers *l, int i)
{
    return begins_pair(l, i + 1) ? i + 1 : i;
}

double hf_layers_view_radius(const struct hf_layers *l, int group, int i)
{
    const float own = l->group[group][i].radius, r = begins_pair(l, i) ? (own - next_radius(&l->set, -own)) / 2 : own;
    return (double)r * (1 + (double)shift_of(l, group, r));
}

int hf_layers_tiles_around(const struct hf_slice *s)
{
    return (((s->reach + 3 + HF_LAYERS_MARGIN) << s->level) + HF_LAYERS_TILE - 1) / HF_LAYERS_TILE;
}

void hf_layers_show_slices(const void *own, const struct hf_frame *f, int y, float *row)
{
    const struct hf_layers *l = own;
    const float *radius = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 0, y);
    for (int x = 0; x < l->width && l->slices; x++) {
        int i = 0;
        while (i + 2 < l->slices && l->slice[i + 1].radius <= radius[x])
            i++;
        const float from = l->slice[i].radius, step = l->slices > 1 ? l->slice[i + 1].radius - from : 1;
        row[x] = (float)i + hf_saturate((radius[x] - from) / step);
    }
}
