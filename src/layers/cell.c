// SPDX-License-Identifier: BSD-3-Clause
// One cell of the result: slice by slice from front to back. What lies before the focus and behind it is put together
// at half resolution, what is near the focus at full resolution, and these three at the end.
#include "layers/cell.h"

#include <string.h>

#include "layers/slices.h"

enum { TILE = HF_LAYERS_TILE, MARGIN = HF_LAYERS_MARGIN, LEFT = 16, RIGHT = 32, AROUND = 64 };

// Planes around a cell: at is channel 0 of its first pixel.
struct window {
    float *at;
    ptrdiff_t channel, row;
};

// A map of tiles: those of the cell from (0, 0) on, and some on every side.
struct map {
    uint8_t *at;
    int stride;
};

enum { SEEN = 1, MIXED = 2, BRIGHT = 4 };

struct cell {
    const struct hf_layers *l;
    const struct hf_samples *samples;
    const struct hf_layers_kernels *k;
    int x0, y0, columns, rows;  // of tiles
    struct map used;            // tiles that have samples of the slice
    struct map touched;         // tiles that its blur reaches, one more around the cell
    struct map shone;           // the same of its shares at full resolution
    struct map near, far, middle;
    struct window source, sum[HF_LAYERS_COARSEST + 1], shine;
    struct window stack[3], light[2];  // near, far, middle; what shines of near and far
    float *line[5];                    // sums at full resolution, on their way to the source's
    float *row[5];                     // upsampled
    float *part;                       // how much of a slice shows, half resolution
    ptrdiff_t part_row;
};

enum { NEAR, FAR, MIDDLE };

static struct hf_layers_range range_at(const struct cell *c, const struct hf_layers_range *map, int tx, int ty)
{
    const struct hf_layers *l = c->l;
    int x = c->x0 / TILE + tx, y = c->y0 / TILE + ty;
    x = x < 0 ? 0 : x < l->columns ? x : l->columns - 1;
    y = y < 0 ? 0 : y < l->rows ? y : l->rows - 1;
    return map[y * l->columns + x];
}

static int is_bright(const struct cell *c, int tx, int ty)
{
    const struct hf_layers *l = c->l;
    int x = c->x0 / TILE + tx, y = c->y0 / TILE + ty;
    x = x < 0 ? 0 : x < l->columns ? x : l->columns - 1;
    y = y < 0 ? 0 : y < l->rows ? y : l->rows - 1;
    return l->bright[y * l->columns + x];
}

static uint8_t *map_at(const struct map *m, int tx, int ty)
{
    return m->at + (ptrdiff_t)ty * m->stride + tx;
}

static int meets(struct hf_layers_range r, const struct hf_slice *s)
{
    return r.low < s->after && r.high > s->before && r.low <= r.high;
}

// Mark the tiles around the cell that have samples of the slice. Returns 0 if there are none.
static int mark_used(struct cell *c, const struct hf_slice *s, int hidden, int shares)
{
    const int n = hf_layers_tiles_around(s);
    int any = 0;
    for (int ty = -n; ty < c->rows + n; ty++)
        for (int tx = -n; tx < c->columns + n; tx++) {
            int bits = 0;
            if (hidden) {
                bits = meets(range_at(c, c->l->hidden_range, tx, ty), s) ? SEEN : 0;
            } else if (shares) {
                bits = is_bright(c, tx, ty) && meets(range_at(c, c->l->seen_range, tx, ty), s) ? SEEN : 0;
            } else {
                bits = (meets(range_at(c, c->l->seen_range, tx, ty), s) ? SEEN : 0) |
                       (meets(range_at(c, c->l->mixed_range, tx, ty), s) ? MIXED : 0);
            }
            *map_at(&c->used, tx, ty) = (uint8_t)bits;
            any |= bits;
        }
    return any;
}

// Tiles of the cell, and one around it, that the blur of what is used reaches.
static int mark_touched(struct cell *c, const struct hf_slice *s, struct map *to)
{
    const int n = hf_layers_tiles_around(s), reach = ((s->reach + 3) << s->level) + TILE - 1, by = reach / TILE;
    int any = 0;
    for (int ty = -1; ty <= c->rows; ty++)
        memset(map_at(to, -1, ty), 0, (size_t)c->columns + 2);
    for (int ty = -n; ty < c->rows + n; ty++)
        for (int tx = -n; tx < c->columns + n; tx++) {
            if (!*map_at(&c->used, tx, ty))
                continue;
            const int a = tx - by > -1 ? tx - by : -1, b = tx + by < c->columns ? tx + by : c->columns;
            const int top = ty - by > -1 ? ty - by : -1, low = ty + by < c->rows ? ty + by : c->rows;
            for (int y = top; y <= low && a <= b; y++)
                memset(map_at(to, a, y), 1, (size_t)(b - a + 1));
            any |= a <= b && top <= low;
        }
    return any;
}

// The next run of set tiles from *tx on, up to `end`; returns its end, or *tx if there is none.
static int next_run(const struct map *m, int *tx, int ty, int end, int bits)
{
    while (*tx < end && !(*map_at(m, *tx, ty) & bits))
        ++*tx;
    int to = *tx;
    while (to < end && (*map_at(m, to, ty) & bits))
        to++;
    return to;
}

// Rows of a level that belong to a row of tiles, one of those around the cell included.
static void clip_rows(const struct cell *c, int level, int ty, int *y0, int *y1)
{
    const int margin = level ? MARGIN : 0, size = TILE >> level;
    *y0 = ty * size > -margin ? ty * size : -margin;
    *y1 = (ty + 1) * size < c->rows * size + margin ? (ty + 1) * size : c->rows * size + margin;
}

// Grow columns to whole vectors, so that no lane lies in two spans.
static void align(int *x0, int *x1)
{
    *x0 = (*x0 + LEFT) / 16 * 16 - LEFT;
    *x1 = (*x1 + LEFT + 15) / 16 * 16 - LEFT;
}

// Pixels of a level.
struct span {
    int x0, x1, tx;  // tx: where to look for the next; -1 at first
};

// The next columns that runs of tiles cover. 0: there are none.
static int next_span(const struct cell *c, const struct map *m, int level, int ty, struct span *s)
{
    const int margin = level ? MARGIN : 0, size = TILE >> level, last = c->columns * size + margin;
    int found = 0;
    for (int end; (end = next_run(m, &s->tx, ty, c->columns + 1, 1)) > s->tx; s->tx = end) {
        int x0 = s->tx * size > -margin ? s->tx * size : -margin, x1 = end * size < last ? end * size : last;
        if (x0 >= x1)
            continue;
        align(&x0, &x1);
        if (found && x0 > s->x1)
            break;
        s->x0 = found ? s->x0 : x0;
        s->x1 = x1;
        found = 1;
    }
    return found;
}

// Zero what the slice's blur reaches and what is read around that.
static void clear_touched(const struct cell *c, const struct map *m, const struct window *w, int level, int channels)
{
    const int margin = level ? MARGIN : 0, height = c->rows * (TILE >> level), around = level ? 2 : 0;
    for (int ty = -1; ty <= c->rows; ty++)
        for (struct span s = {.tx = -1}; next_span(c, m, level, ty, &s);) {
            const int x0 = s.x0 - 16 > -LEFT ? s.x0 - 16 : -LEFT;
            const int right = (c->columns * (TILE >> level)) + RIGHT, x1 = s.x1 + 16 < right ? s.x1 + 16 : right;
            int y0, y1;
            clip_rows(c, level, ty, &y0, &y1);
            y0 = y0 - around > -margin ? y0 - around : -margin;
            y1 = y1 + around < height + margin ? y1 + around : height + margin;
            for (int y = y0; y < y1; y++)
                for (int i = 0; i < channels; i++)
                    memset(w->at + y * w->row + i * w->channel + x0, 0, sizeof(float) * (size_t)(x1 - x0));
        }
}

// Samples and their planes from a pixel on.
static void planes_at(const struct hf_layers *l, const struct hf_layers_set *set, const float *weight, int x, int y,
                      const float *in[6])
{
    const ptrdiff_t at = (ptrdiff_t)y * set->stride + x;
    for (int i = 0; i < l->channels; i++)
        in[i] = set->colour[i] + at;
    in[4] = weight + at;
    in[5] = set->radius + at;
}

// Where a channel's row of sources begins: channel `channels` is the weight.
static float *source_at(const struct cell *c, int i, int x, int y)
{
    return c->source.at + y * c->source.row + i * c->source.channel + x;
}

struct build {
    const struct hf_slice *s;
    const struct hf_layers_set *set;
    const float *weight, *share;
    int finest;  // log2 of the pixels of its samples
    int channels;
    int mixed;  // samples behind mixed edges belong to it
};

// The sources of one row of a run of tiles.
static void build_run(const struct cell *c, const struct build *b, int tx, int end, int ty, int y)
{
    const struct hf_layers *l = c->l;
    const int level = b->s->level - b->finest, size = TILE >> b->finest, n = (end - tx) * size, rows = 1 << level;
    const int px = (c->x0 >> b->finest) + tx * size, py = (c->y0 >> b->finest) + ty * size + (y << level);
    const float *in[6] = {NULL};
    float *out[5];
    for (int i = 0; i < 5; i++)
        out[i] = level ? c->line[i] : source_at(c, i < 4 ? i : l->channels, tx * size, y);
    planes_at(l, b->set, b->weight, px, py, in);
    c->k->weigh(b->s, in, b->share ? b->share + (ptrdiff_t)py * b->set->stride + px : NULL, b->set->stride, rows,
                l->channels, n, 0, out);
    for (int from = tx, to; b->mixed && (to = next_run(&c->used, &from, ty, end, MIXED)) > from; from = to) {
        float *more[5];
        for (int i = 0; i < 5; i++)
            more[i] = out[i] + (from - tx) * size;
        planes_at(l, &c->samples->mixed, c->samples->mixed.weight, c->x0 + from * size, py, in);
        c->k->weigh(b->s, in, NULL, c->samples->mixed.stride, rows, l->channels, (to - from) * size, 1, more);
    }
    for (int i = 0; i < b->channels; i++) {
        float *line = out[i < l->channels ? i : 4], *to = source_at(c, i, tx * (TILE >> b->s->level), y);
        for (int j = level; j > 0; j--)
            c->k->fold(line, n >> (level - j + 1), j > 1 ? line : to);
    }
}

static void build_row(const struct cell *c, const struct build *b, int ty)
{
    const int n = hf_layers_tiles_around(b->s);
    for (int tx = -n, end; (end = next_run(&c->used, &tx, ty, c->columns + n, ~0)) > tx; tx = end)
        for (int y = 0; y < TILE >> b->s->level; y++)
            build_run(c, b, tx, end, ty, y);
}

// Also what vectors have written past the last tile.
static void clear_row(const struct cell *c, const struct build *b, int ty)
{
    const int n = hf_layers_tiles_around(b->s), size = TILE >> b->s->level;
    for (int tx = -n, end; (end = next_run(&c->used, &tx, ty, c->columns + n, ~0)) > tx; tx = end)
        for (int y = 0; y < size; y++)
            for (int i = 0; i <= c->l->channels; i++)
                memset(source_at(c, i, tx * size, y), 0, sizeof(float) * (size_t)((end - tx) * size + 16));
}

// Draw columns x0 to x1 of a row of tiles' sources.
static void draw_span(const struct cell *c, const struct build *b, int ty, int x0, int x1, const struct window *to)
{
    const struct hf_slice *s = b->s;
    const int size = TILE >> s->level, margin = s->level ? MARGIN : 0, height = c->rows * size;
    for (int y = 0; y < size; y++)
        for (int i = 0; i < b->channels; i++) {
            const int at = ty * size + y;
            c->k->disc(s, source_at(c, i, x0, y), x1 - x0, -margin - at, height + margin - at,
                       to->at + at * to->row + i * to->channel + x0, to->row);
        }
}

// Draw the sources of a row of tiles into the window. Spans lie on vectors, and what is between two is 0 in both.
static void draw_row(const struct cell *c, const struct build *b, int ty, const struct window *to)
{
    const struct hf_slice *s = b->s;
    const int n = hf_layers_tiles_around(s), size = TILE >> s->level, margin = s->level ? MARGIN : 0;
    const int last = c->columns * size + margin;
    int x0 = 0, x1 = 0;
    for (int tx = -n, end; (end = next_run(&c->used, &tx, ty, c->columns + n, ~0)) > tx; tx = end) {
        int a = tx * size - s->reach, z = end * size + s->reach;
        a = a > -margin ? a : -margin;
        z = z < last ? z : last;
        if (a >= z)
            continue;
        align(&a, &z);
        if (x1 > x0 && a > x1) {
            draw_span(c, b, ty, x0, x1, to);
            x0 = a;
        } else if (x1 <= x0) {
            x0 = a;
        }
        x1 = z;
    }
    if (x1 > x0)
        draw_span(c, b, ty, x0, x1, to);
}

static void blur(const struct cell *c, const struct build *b, const struct map *touched, const struct window *to)
{
    const int n = hf_layers_tiles_around(b->s), size = TILE >> b->s->level, margin = b->s->level ? MARGIN : 0;
    clear_touched(c, touched, to, b->s->level, b->channels);
    for (int ty = -n; ty < c->rows + n; ty++) {
        int tx = -n;
        if (next_run(&c->used, &tx, ty, c->columns + n, ~0) == tx || (ty + 1) * size + b->s->rows <= -margin ||
            ty * size - b->s->rows >= c->rows * size + margin)
            continue;
        build_row(c, b, ty);
        draw_row(c, b, ty, to);
        clear_row(c, b, ty);
    }
}

// Bring what a level holds of touched tiles to the next finer one.
static void refine(struct cell *c, const struct map *touched, int level)
{
    const struct window *from = &c->sum[level], *to = &c->sum[level - 1];
    const int height = c->rows * (TILE >> (level - 1)) + MARGIN;
    for (int ty = -1; ty <= c->rows; ty++)
        for (struct span s = {.tx = -1}; next_span(c, touched, level - 1, ty, &s);) {
            int y0, y1;
            clip_rows(c, level - 1, ty, &y0, &y1);
            y0 = y0 - 1 > -MARGIN ? y0 - 1 : -MARGIN;
            y1 = y1 + 1 < height ? y1 + 1 : height;
            for (int y = y0; y < y1; y++)
                for (int i = 0; i <= c->l->channels; i++) {
                    const float *a = from->at + (y >> 1) * from->row + i * from->channel + s.x0 / 2;
                    c->k->up(a, a + (y & 1 ? from->row : -from->row), (s.x1 - s.x0) / 2,
                             to->at + y * to->row + i * to->channel + s.x0);
                }
        }
}

static struct hf_stack_row stack_at(const struct cell *c, int stack, int x, int y)
{
    const struct window *w = &c->stack[stack];
    float *p = w->at + y * w->row + x;
    struct hf_stack_row r = {.weight = p + c->l->channels * w->channel, .open = p + (c->l->channels + 1) * w->channel};
    for (int i = 0; i < c->l->channels; i++)
        r.colour[i] = p + i * w->channel;
    return r;
}

// Put the sums of a slice under what a stack holds.
static void put_under(struct cell *c, int stack, int level, int hidden, int keep_part)
{
    const int finest = stack == MIDDLE ? 0 : 1, channels = c->l->channels;
    while (level > finest + 1)
        refine(c, &c->touched, level--);
    const struct window *from = &c->sum[level];
    for (int ty = -1; ty <= c->rows; ty++)
        for (struct span s = {.tx = -1}; next_span(c, &c->touched, finest, ty, &s);) {
            int y0, y1;
            clip_rows(c, finest, ty, &y0, &y1);
            for (int y = y0; y < y1; y++) {
                const struct hf_stack_row to = stack_at(c, stack, s.x0, y);
                const float *in[5];
                for (int i = 0; i <= channels; i++) {
                    const float *a = from->at + (y >> (level - finest)) * from->row + i * from->channel;
                    const int as = i < channels ? i : 4;
                    in[as] = level > finest ? c->row[as] : a + s.x0;
                    if (level > finest)
                        c->k->up(a + s.x0 / 2, a + s.x0 / 2 + (y & 1 ? from->row : -from->row), (s.x1 - s.x0) / 2,
                                 c->row[as]);
                }
                c->k->blend(&to, channels, in, hidden, s.x1 - s.x0,
                            keep_part ? c->part + y * c->part_row + s.x0 : NULL);
            }
        }
}

static void mark(const struct cell *c, const struct map *from, struct map *to)
{
    for (int ty = -1; ty <= c->rows; ty++)
        for (int tx = -1; tx <= c->columns; tx++)
            *map_at(to, tx, ty) |= *map_at(from, tx, ty);
}

// Shares of highlights, at full resolution, where the slice shows.
static void put_light(struct cell *c, int stack, const struct hf_slice *wide)
{
    const struct hf_layers *l = c->l;
    const struct build b = {.s = wide, .set = &c->samples->seen, .weight = c->samples->share, .channels = l->channels};
    if (!mark_used(c, wide, 0, 1) || !mark_touched(c, wide, &c->shone))
        return;
    blur(c, &b, &c->shone, &c->shine);
    const struct window *to = &c->light[stack];
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0, end; (end = next_run(&c->shone, &tx, ty, c->columns, 1)) > tx; tx = end)
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                const int x0 = tx * TILE, n = (end - tx) * TILE;
                const float *a = c->part + (y >> 1) * c->part_row + (x0 >> 1);
                c->k->up(a, a + (y & 1 ? c->part_row : -c->part_row), n / 2, c->row[0]);
                for (int i = 0; i < l->channels; i++) {
                    const float *in = c->shine.at + y * c->shine.row + i * c->shine.channel + x0;
                    float *out = to->at + y * to->row + i * to->channel + x0;
                    for (int x = 0; x < n; x++)
                        out[x] = c->row[0][x] * in[x] + out[x];
                }
            }
}

static void put_slice(struct cell *c, int i)
{
    const struct hf_layers *l = c->l;
    const struct hf_slice *s = &l->slice[i], *behind = &l->behind[i];
    const int stack = s->level == 0 ? MIDDLE : s->radius < 0 ? NEAR : FAR;
    struct map *reached = stack == NEAR ? &c->near : stack == FAR ? &c->far : &c->middle;
    if (mark_used(c, s, 0, 0) && mark_touched(c, s, &c->touched)) {
        const int shares = l->set.highlights && s->level > 0;
        const struct build b = {.s = s,
                                .set = &c->samples->seen,
                                .weight = c->samples->seen.weight,
                                .share = shares ? c->samples->share : NULL,
                                .channels = l->channels + 1,
                                .mixed = 1};
        blur(c, &b, &c->touched, &c->sum[s->level]);
        put_under(c, stack, s->level, 0, shares);
        if (s->radius != 0)
            mark(c, &c->touched, reached);
        if (shares)
            put_light(c, stack, &l->shine[i]);
    }
    if (l->levels && mark_used(c, behind, 1, 0) && mark_touched(c, behind, &c->touched)) {
        const struct build b = {.s = behind,
                                .set = &c->samples->hidden,
                                .weight = c->samples->hidden.weight,
                                .finest = 1,
                                .channels = l->channels + 1};
        blur(c, &b, &c->touched, &c->sum[behind->level]);
        put_under(c, stack, behind->level, 1, 0);
        mark(c, &c->touched, reached);
    }
}

// An empty stack.
static void open_stack(const struct cell *c, int stack)
{
    const int finest = stack == MIDDLE ? 0 : 1, size = TILE >> finest, margin = finest ? MARGIN : 0;
    for (int y = -margin; y < c->rows * size + margin; y++) {
        const struct hf_stack_row r = stack_at(c, stack, -margin, y);
        const int n = c->columns * size + 2 * margin;
        for (int i = 0; i < c->l->channels; i++)
            memset(r.colour[i], 0, sizeof(float) * (size_t)n);
        memset(r.weight, 0, sizeof(float) * (size_t)n);
        for (int x = 0; x < n; x++)
            r.open[x] = 1;
        for (int i = 0; finest && i < c->l->channels; i++) {
            const struct window *w = &c->light[stack];
            for (int j = 0; j < 2 && y >= 0 && y < c->rows * size; j++)
                memset(w->at + (2 * y + j) * w->row + i * w->channel, 0, sizeof(float) * (size_t)(c->columns * TILE));
        }
    }
}

// Is a tile nothing but sharp pixels that nothing else reaches?
static int is_sharp(const struct cell *c, int tx, int ty)
{
    const struct hf_layers_range r = range_at(c, c->l->seen_range, tx, ty), m = range_at(c, c->l->mixed_range, tx, ty);
    return r.low == 0 && r.high == 0 && m.low > m.high && !*map_at(&c->near, tx, ty) && !*map_at(&c->far, tx, ty) &&
           !*map_at(&c->middle, tx, ty);
}

// The pixels themselves.
static void copy_tile(const struct cell *c, int tx, int ty, float *const out[4], ptrdiff_t stride)
{
    const struct hf_layers_set *s = &c->samples->seen;
    for (int i = 0; i < c->l->channels; i++)
        for (int y = ty * TILE; y < (ty + 1) * TILE; y++)
            memcpy(out[i] + y * stride + tx * TILE, s->colour[i] + (c->y0 + y) * s->stride + c->x0 + tx * TILE,
                   sizeof(float) * TILE);
}

// A row of a stack at full resolution: its colours and weight.
static void raise(const struct cell *c, int stack, int x, int n, int y, float *const out[5])
{
    const struct window *w = &c->stack[stack], *light = &c->light[stack];
    for (int i = 0; i <= c->l->channels; i++) {
        const float *a = w->at + (y >> 1) * w->row + i * w->channel + (x >> 1);
        float *to = out[i < c->l->channels ? i : 4];
        c->k->up(a, a + (y & 1 ? w->row : -w->row), n / 2, to);
        const float *in = light->at + y * light->row + i * light->channel + x;
        for (int j = 0; i < c->l->channels && j < n; j++)
            to[j] += in[j];
    }
}

// The near stack lies before what is near the focus.
static void begin_middle(const struct cell *c)
{
    open_stack(c, MIDDLE);
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0, end; (end = next_run(&c->near, &tx, ty, c->columns, 1)) > tx; tx = end)
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                const struct hf_stack_row r = stack_at(c, MIDDLE, tx * TILE, y);
                float *const out[5] = {r.colour[0], r.colour[1], r.colour[2], r.colour[3], r.weight};
                raise(c, NEAR, tx * TILE, (end - tx) * TILE, y, out);
                for (int x = 0; x < (end - tx) * TILE; x++)
                    r.open[x] = r.weight[x] < 1 ? 1 - r.weight[x] : 0;
            }
}

static void finish(const struct cell *c, float *const out[4], ptrdiff_t stride)
{
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0, end; tx < c->columns; tx = end) {
            const int far = *map_at(&c->far, tx, ty);
            for (end = tx + 1; end < c->columns && *map_at(&c->far, end, ty) == far;)
                end++;
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                const struct hf_stack_row r = stack_at(c, MIDDLE, tx * TILE, y);
                float *to[4] = {NULL};
                const float *own[6] = {NULL};
                planes_at(c->l, &c->samples->seen, c->samples->seen.weight, c->x0 + tx * TILE, c->y0 + y, own);
                for (int i = 0; i < c->l->channels; i++)
                    to[i] = out[i] + y * stride + tx * TILE;
                if (far)
                    raise(c, FAR, tx * TILE, (end - tx) * TILE, y, c->row);
                c->k->finish(&r, far ? (const float *const *)c->row : NULL, own, c->l->channels, (end - tx) * TILE, to);
            }
        }
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0; tx < c->columns; tx++)
            if (is_sharp(c, tx, ty))
                copy_tile(c, tx, ty, out, stride);
}

// Scratch; without memory, only how much of it would be taken.
struct scratch {
    float *memory;
    size_t used;
};

static float *take(struct scratch *m, size_t n, ptrdiff_t at)
{
    float *p = m->memory ? m->memory + m->used + at : NULL;
    m->used += (n + 15) & ~(size_t)15;
    return p;
}

static struct window take_window(struct scratch *m, int width, int height, int channels)
{
    struct window w = {.channel = LEFT + width + RIGHT};
    w.row = w.channel * channels;
    w.at = take(m, (size_t)w.row * (size_t)(height + 2 * MARGIN), MARGIN * w.row + LEFT);
    return w;
}

static struct map take_map(struct scratch *m, int columns, int rows, int around)
{
    struct map map = {.stride = columns + 2 * around};
    const size_t n = (size_t)map.stride * (size_t)(rows + 2 * around);
    uint8_t *start = (uint8_t *)take(m, (n + sizeof(float) - 1) / sizeof(float), 0);
    map.at = start ? start + around * map.stride + around : NULL;
    return map;
}

// Place a cell's scratch; returns how much it is.
static size_t place(struct cell *c, float *memory)
{
    struct scratch m = {.memory = memory};
    const int width = c->columns * TILE, height = c->rows * TILE, channels = c->l->channels,
              n = hf_layers_most_tiles(c->l);
    const int wide = width + 2 * n * TILE + 2 * AROUND;
    c->used = take_map(&m, c->columns, c->rows, n);
    struct map *const maps[] = {&c->touched, &c->shone, &c->near, &c->far, &c->middle};
    for (int i = 0; i < 5; i++)
        *maps[i] = take_map(&m, c->columns, c->rows, 1);
    c->source.channel = wide;
    c->source.row = (ptrdiff_t)wide * (channels + 1);
    c->source.at = take(&m, (size_t)c->source.row * TILE, n * TILE + AROUND);
    for (int i = 0; i <= HF_LAYERS_COARSEST; i++)
        c->sum[i] = take_window(&m, width >> i, height >> i, channels + 1);
    c->shine = take_window(&m, width, height, channels);
    for (int i = 0; i < 3; i++)
        c->stack[i] = take_window(&m, i == MIDDLE ? width : width / 2, i == MIDDLE ? height : height / 2, channels + 2);
    for (int i = 0; i < 2; i++)
        c->light[i] = take_window(&m, width, height, channels);
    const struct window part = take_window(&m, width / 2, height / 2, 1);
    c->part = part.at;
    c->part_row = part.row;
    for (int i = 0; i < 5; i++) {
        c->line[i] = take(&m, (size_t)wide, 0);
        c->row[i] = take(&m, (size_t)width + AROUND, 0);
    }
    return m.used;
}

size_t hf_layers_cell_floats(const struct hf_layers *l, int width, int height)
{
    struct cell c = {.l = l, .columns = width / TILE, .rows = height / TILE};
    return place(&c, NULL);
}

void hf_layers_cell(const struct hf_layers *l, const struct hf_samples *samples, const struct hf_layers_kernels *k,
                    struct hf_rect r, float *memory, float *const out[4], ptrdiff_t stride)
{
    struct cell c = {.l = l,
                     .samples = samples,
                     .k = k,
                     .x0 = r.x0,
                     .y0 = r.y0,
                     .columns = (r.x1 - r.x0) / TILE,
                     .rows = (r.y1 - r.y0) / TILE};
    place(&c, memory);
    memset(c.source.at - (hf_layers_most_tiles(l) * TILE + AROUND), 0, sizeof(float) * (size_t)c.source.row * TILE);
    // Where a slice does not reach, its light is 0 whatever part of it shows.
    memset(c.part - MARGIN * c.part_row - LEFT, 0,
           sizeof(float) * (size_t)c.part_row * (size_t)(c.rows * TILE / 2 + 2 * MARGIN));
    struct map *const maps[] = {&c.near, &c.far, &c.middle};
    for (int i = 0; i < 3; i++)
        for (int ty = -1; ty <= c.rows; ty++)
            memset(map_at(maps[i], -1, ty), 0, (size_t)c.columns + 2);
    int i = 0;
    open_stack(&c, NEAR);
    open_stack(&c, FAR);
    while (i < l->slices && l->slice[i].level > 0 && l->slice[i].radius < 0)
        put_slice(&c, i++);
    begin_middle(&c);
    for (; i < l->slices; i++)
        put_slice(&c, i);
    finish(&c, out, stride);
}
