// SPDX-License-Identifier: BSD-3-Clause
// Draws a row of sources as shapes.
//
// A cat's eye has another shape at each place: the aperture cut by a second circle. That circle is the one at the pixel
// drawn to, as in a lens, so opaque surfaces stay opaque. Along columns this is exact. Along rows the shapes of nodes
// are blended; from one node to the next the circle moves by at most STEP pixels, or a seventh more. Their distance is a
// power of two. Before it doubles, every second node fades out.
#include <math.h>
#include <string.h>

#include "engine/layers/parts.h"
#include "engine/layers/shape.h"

static const double STEP = 1.5;
enum { CLOSEST = 4, FARTHEST = 256 };  // pixels from one node to the next
enum { MOST_CHORDS = 1 << 23 };        // kept; with more than these, each is computed where it is read

// Scratch of a cell: the windows of a row. For a cat's eye also the visible part of a node, the runs of a shape, and
// for each node the circle's rows and the sum that they leave of the shape.
struct places {
    float *window, *part, *sum, *chord;
    struct hf_shape_run *run;
    struct hf_shape_row *row;
    ptrdiff_t plane;
};

static size_t whole(size_t n)
{
    return (n + 15) & ~(size_t)15;
}

// Nodes lie at multiples of a power of two. wide: how far only every second of them counts, 0 to 1.
static int node_apart(const struct hf_layers *l, const struct hf_slice *s, float *wide)
{
    const double pixels = hypot(l->width, l->height) / (1 << s->level);
    const double far = STEP * pixels / (2 * l->key.cat_eye * s->shape->radius * fmax(l->key.wide, 1));
    int n = CLOSEST;
    while (2 * n <= far && n < FARTHEST)
        n *= 2;
    *wide = n < FARTHEST && far > 1.75 * n ? (float)(4 * far / n - 7) : 0;
    return n;
}

// Nodes in a row, and in a whole cell of that many tiles.
static int nodes_across(const struct hf_layers *l, const struct hf_slice *s, int columns)
{
    float unused;
    return (columns * (TILE >> s->level) + 2 * AROUND) / node_apart(l, s, &unused) + 5;
}

static size_t nodes_of(const struct hf_layers *l, const struct hf_slice *s, int columns, int rows)
{
    return (size_t)nodes_across(l, s, columns) * (size_t)(rows * (TILE >> s->level) + 2 * MARGIN);
}

// How many chords that many nodes have; 0: too many to keep.
static size_t chords_of(const struct hf_shape *s, size_t nodes)
{
    const size_t n = nodes * (size_t)s->rows;
    return n <= MOST_CHORDS ? n : 0;
}

// Places everything except the nodes, which are made for each slice; returns the floats used.
static size_t place(const struct hf_layers *l, int columns, float *memory, struct places *p)
{
    const int around = HF_LAYERS_TILE * l->most_tiles, width = columns * TILE;
    *p = (struct places){.plane = (ptrdiff_t)whole((size_t)(width + 2 * around) + 2 * AROUND)};
    const size_t windows = (size_t)l->most_windows * (l->key.cat_eye > 0 ? (size_t)l->channels + 1 : 1);
    const size_t part = (size_t)p->plane * windows;
    const size_t row = part + whole((size_t)width + 2 * AROUND);
    const size_t run = row + whole((size_t)l->most_rows * sizeof(struct hf_shape_row) / sizeof(float));
    const size_t sum = run + whole((size_t)l->most_rows * HF_SHAPE_RUNS * sizeof(struct hf_shape_run) / sizeof(float));
    if (memory) {
        p->window = memory + around + AROUND;
        p->part = memory + part;
        p->row = (struct hf_shape_row *)(void *)(memory + row);
        p->run = (struct hf_shape_run *)(void *)(memory + run);
        p->sum = memory + sum;
    }
    return sum;
}

size_t hf_layers_shape_floats(const struct hf_layers *l, int columns, int rows)
{
    struct places p;
    size_t most = 0;
    if (!l->shaped)
        return 0;
    for (int i = 0; l->key.cat_eye > 0 && i < 3 * l->slices * l->groups; i++) {
        const struct hf_slice *s = &l->group[i / (3 * l->slices)][i % (3 * l->slices)];
        const size_t n = s->shape ? nodes_of(l, s, columns, rows) : 0;
        // A smaller cell may keep its chords where this one has too many.
        const size_t chords = n * (size_t)(n ? s->shape->rows : 0);
        const size_t need = whole(n) + (chords < MOST_CHORDS ? chords : MOST_CHORDS);
        most = need > most ? need : most;
    }
    return place(l, columns, NULL, &p) + most;
}

// A drawing job: row y of sources from column x0 on; `in` points to its first channel.
struct draw {
    const struct hf_cell *c;
    const struct hf_build *b;
    const struct hf_shape *shape;
    const float *in;
    int y, x0, x1;
    const struct hf_window *to;
    int from, end;  // rows that are wanted
    struct places at;
    int across;     // nodes in a row
    double corner;  // 1 / the frame's diagonal
};

// Sums of 2^k pixels of a channel, as far as the shape reads.
static void make_windows(const struct draw *d, const float *in, float *window)
{
    const int reach = d->shape->reach, n = d->x1 - d->x0 + 2 * reach + 1;
    float *to = window - reach - 1;
    memcpy(to, in - reach - 1, sizeof(float) * (size_t)(n + 16));
    for (int k = 1; k < d->shape->windows; k++, to += d->at.plane)
        d->c->k->pairs(to, 1 << (k - 1), n + 16 - (1 << k), to + d->at.plane);
}

static float *target(const struct draw *d, int channel, int y)
{
    return d->to->at + y * d->to->row + channel * d->to->channel + d->x0;
}

static void draw_runs(const struct draw *d)
{
    const struct hf_shape *s = d->shape;
    for (int i = 0; i < d->b->channels; i++) {
        make_windows(d, d->in + i * d->c->source.channel, d->at.window);
        for (int y = hf_max(d->from, d->y + s->top); y < hf_min(d->end, d->y + s->top + s->rows); y++) {
            const struct hf_shape_row *row = &s->row[y - d->y - s->top];
            if (row->count)
                d->c->k->runs(s->run + row->first, row->count, d->at.window, d->at.plane, NULL, d->x1 - d->x0,
                              target(d, i, y));
        }
    }
}

static void draw_weights(const struct draw *d)
{
    const struct hf_shape *s = d->shape;
    for (int i = 0; i < d->b->channels; i++)
        for (int y = hf_max(d->from, d->y + s->top); y < hf_min(d->end, d->y + s->top + s->rows); y++) {
            const struct hf_shape_row *row = &s->row[y - d->y - s->top];
            if (row->count)
                d->c->k->weights(s->weight + row->first, row->count, d->in + i * d->c->source.channel - row->left,
                                 d->x1 - d->x0, target(d, i, y));
        }
}

// Draw highlights one by one, because they are few.
static void stamp(const struct draw *d, const float *in, int channel, int x)
{
    const struct hf_shape *s = d->shape;
    for (int y = hf_max(d->from, d->y + s->top); y < hf_min(d->end, d->y + s->top + s->rows); y++) {
        const struct hf_shape_row *row = &s->row[y - d->y - s->top];
        const int a = hf_max(x + row->left, 0), z = hf_min(x + row->left + row->count, d->x1 - d->x0);
        if (z > a)
            d->c->k->stamp(s->weight + row->first + a - x - row->left, z - a, in[x], target(d, channel, y) + a);
    }
}

static void draw_stamps(const struct draw *d)
{
    const int n = d->x1 - d->x0, reach = d->shape->reach;
    for (int i = 0; i < d->b->channels; i++) {
        const float *in = d->in + i * d->c->source.channel;
        for (int x = -reach; x < n + reach; x++)
            if (in[x] != 0)
                stamp(d, in, i, x);
    }
}

// ---- the cat's eye ----

// The second circle at a pixel of the level, relative to the shape's middle.
struct circle {
    double x, y, r;
};

static struct circle circle_at(const struct draw *d, int x, int y)
{
    const struct hf_layers *l = d->c->l;
    const struct hf_slice *s = d->b->s;
    const double size = 1 << s->level, toward = (s->radius < 0 ? -1 : 1) * l->key.cat_eye * d->shape->radius;
    const double px = fmin(fmax((x + 0.5) * size, 0), l->width), py = fmin(fmax((y + 0.5) * size, 0), l->height);
    return (struct circle){toward * (2 * px - l->width) * d->corner * l->key.wide,
                           toward * (2 * py - l->height) * d->corner, d->shape->radius};
}

// Half the circle's width in a row of the shape: its mean between the heights that the shape covers, as the shape's own ends
// are. So a circle around a shape cuts nothing from it, however small both are. from, to: half the circle's area up to
// these heights.
static float chord_of(const struct hf_shape_row *row, double from, double to, double wide)
{
    return (float)((to - from) / ((double)row->low - row->top) * wide);
}

static double half_up_to(const struct circle *c, double height)
{
    return hf_half_disc(c->r, height - c->y);
}

// Cut a run by the circle; returns 0 if nothing is left.
static int cut(const struct hf_shape_end *e, float middle, float half, float *a, float *b)
{
    *a = fmaxf(e->a, middle - half);
    *b = fminf(e->b, middle + half);
    return *b > *a;
}

// The sum of what the circle leaves of the shape at a node. It also keeps the circle's rows. Both stay until the next
// slice.
static float sum_at(const struct draw *d, const struct circle *c, size_t node)
{
    const struct hf_shape *s = d->shape;
    if (d->at.sum[node] >= 0)
        return d->at.sum[node];
    double sum = 0, to = 0, end = -HUGE_VAL;  // `to` belongs to height `end`, where the next row mostly begins
    for (int i = 0; i < s->rows; i++) {
        const struct hf_shape_row *row = &s->row[i];
        float a, b;
        if (!row->count)
            continue;
        const double top = s->top + i + row->top, from = top == end ? to : half_up_to(c, top);
        end = s->top + i + row->low;
        to = half_up_to(c, end);
        const float chord = chord_of(row, from, to, d->c->l->key.wide);
        if (d->at.chord)
            d->at.chord[node * (size_t)s->rows + (size_t)i] = chord;
        for (int j = row->first; j < row->first + row->count; j++)
            if (cut(&s->end[j], (float)c->x, chord, &a, &b))
                sum += (double)s->end[j].weight * ((double)b - a);
    }
    return d->at.sum[node] = (float)sum;
}

// Of the shape around pixel (x, y), cut the row that contains the sources; returns its number of runs. If the circle
// leaves nothing of the shape, the shape is the pixel itself.
static int cut_row(const struct draw *d, int column, int x, int y, struct hf_shape_run *run)
{
    const struct hf_shape *s = d->shape;
    const size_t node = (size_t)(y + MARGIN) * (size_t)d->across + (size_t)column;
    const struct circle c = circle_at(d, x, y + (d->c->y0 >> d->b->s->level));
    const float sum = sum_at(d, &c, node);
    const int i = y - d->y - s->top;
    const struct hf_shape_row *row = &s->row[i];
    int n = 0;
    float a, b;
    if (sum <= 0) {
        run[0] = hf_shape_run_of(-0.5f, 0.5f, (float)s->sum);
        return y == d->y;
    }
    const double top = s->top + i + row->top, low = s->top + i + row->low;
    const float chord = d->at.chord  ? d->at.chord[node * (size_t)s->rows + (size_t)i]
                        : row->count ? chord_of(row, half_up_to(&c, top), half_up_to(&c, low), d->c->l->key.wide)
                                     : 0;
    for (int j = row->first; j < row->first + row->count; j++)
        if (cut(&s->end[j], (float)c.x, chord, &a, &b))
            run[n++] = hf_shape_run_of(a, b, (float)(s->end[j].weight * (s->sum / sum)));
    return n;
}

static int floor_to(int x, int n)
{
    return x - (x % n + n) % n;
}

// Draw the shape of the node at column x. narrow and wide: weights of its ramps to the next node, and to the one after it.
static void draw_node(const struct draw *d, int column, int x, int apart, float narrow, float wide)
{
    const struct hf_shape *s = d->shape;
    const int left = d->c->x0 >> d->b->s->level, around = wide > 0 ? 2 * apart : apart,
              first = hf_max(floor_to(x - around + 1 - d->x0 - left, 16), 0),
              last = hf_min(x + around - d->x0 - left, d->x1 - d->x0);
    if (first >= last)
        return;
    for (int i = first; i < ((last + 15) & ~15); i++) {
        const float away = fabsf((float)(i + d->x0 + left - x)) / (float)apart;
        d->at.part[i] = narrow * hf_saturate(1 - away) + wide * hf_saturate(1 - 0.5f * away);
    }
    const int y0 = hf_max(d->from, d->y + s->top), y1 = hf_min(d->end, d->y + s->top + s->rows);
    for (int y = y0; y < y1; y++) {
        struct hf_shape_row *row = &d->at.row[y - y0];
        row->first = (y - y0) * HF_SHAPE_RUNS;
        row->count = cut_row(d, column, x, y, d->at.run + row->first);
    }
    for (int i = 0; i < d->b->channels; i++)
        for (int y = y0; y < y1; y++)
            if (d->at.row[y - y0].count)
                d->c->k->runs(d->at.run + d->at.row[y - y0].first, d->at.row[y - y0].count,
                              d->at.window + i * d->at.plane * d->c->l->most_windows + first, d->at.plane,
                              d->at.part + first, last - first, target(d, i, y) + first);
}

static void draw_cats_eye(const struct draw *d)
{
    float wide;
    const int apart = node_apart(d->c->l, d->b->s, &wide), left = d->c->x0 >> d->b->s->level,
              begin = floor_to(left - LEFT, apart) - apart;
    for (int i = 0; i < d->b->channels; i++)
        make_windows(d, d->in + i * d->c->source.channel, d->at.window + i * d->at.plane * d->c->l->most_windows);
    for (int x = floor_to(left + d->x0, apart) - apart; x - 2 * apart < left + d->x1 && !hf_stopped(d->c->l->stop);
         x += apart)
        draw_node(d, (x - begin) / apart, x, apart, 1 - wide, x % (2 * apart) ? 0 : wide);
}

void hf_layers_begin_shape(const struct hf_cell *c, const struct hf_slice *s)
{
    struct places p;
    const size_t n = c->l->key.cat_eye > 0 ? nodes_of(c->l, s, c->columns, c->rows) : 0;
    place(c->l, c->columns, c->shape, &p);
    for (size_t i = 0; i < n; i++)
        p.sum[i] = -1;
}

void hf_layers_draw_shape(const struct hf_cell *c, const struct hf_build *b, const float *in, int y, int x0, int x1,
                          const struct hf_window *to)
{
    const struct hf_layers *l = c->l;
    const int margin = b->s->level ? MARGIN : 0, height = c->rows * (TILE >> b->s->level);
    struct draw d = {.c = c,
                     .b = b,
                     .shape = b->s->shape,
                     .in = in,
                     .y = y,
                     .x0 = x0,
                     .x1 = x1,
                     .to = to,
                     .from = -margin,
                     .end = height + margin};
    place(l, c->columns, c->shape, &d.at);
    if (d.shape->weight && b->s->sparse) {
        draw_stamps(&d);
    } else if (d.shape->weight) {
        draw_weights(&d);
    } else if (l->key.cat_eye > 0) {
        d.corner = 1 / hypot(l->width, l->height);
        d.across = nodes_across(l, b->s, c->columns);
        const size_t nodes = nodes_of(l, b->s, c->columns, c->rows);
        d.at.chord = chords_of(d.shape, nodes) ? d.at.sum + whole(nodes) : NULL;
        draw_cats_eye(&d);
    } else {
        draw_runs(&d);
    }
}
