// SPDX-License-Identifier: BSD-3-Clause
// The levels of hidden samples, and the search in them.
#include <math.h>
#include <string.h>

#include "engine/layers/hidden.h"
#include "pixel/pass_c.h"

// Samples searched at once; floats around a row; size of the blocks that are known to need a search or not.
enum { STEP = 128, PAD = 32, BLOCK = 16 };
#define ROUNDED 0.01f  // rounding may put a mean of radii this far above the largest of them

int hf_layers_hidden_reach(const struct hf_layers *l)
{
    return l->levels ? (1 << l->levels) + HF_LAYERS_SMOOTH : 0;
}

// The levels of a band, with the rows that it reads above and below.
struct band {
    const struct hf_frame *f;
    const struct hf_layers *l;
    struct hf_rect r;
    int reach;
    struct hf_layers_set level[HF_LAYERS_LEVELS], across, found;
    struct hf_hidden_line line[HF_LAYERS_LINES];
    struct hf_hidden_tap tap[HF_LAYERS_LEVELS][9];  // with the samples of a row
    float *nearest;                                 // least visible radius in each quad; `width` quads per row
    int width;
    // Blocks; (0, 0) is the band's first, and there are more around it. farthest: largest radius in a block; within:
    // largest radius within the search's reach; needed: how many levels are searched; made: whether each level is made.
    int columns, rows, around, stride;
    float *farthest, *within;
    uint8_t *needed, *wide, *made[HF_LAYERS_LEVELS];  // wide: scratch, also of one row's levels
};

static size_t plane_floats(const struct hf_layers *l, int width, int height)
{
    const size_t reach = (size_t)hf_layers_hidden_reach(l);
    return (((size_t)width + 2 * reach + 15) / 16 * 16 + 2 * PAD) * ((size_t)height + 2 * reach);
}

static int blocks_of(int n)
{
    return (n + BLOCK - 1) / BLOCK;
}

static size_t block_count(const struct hf_layers *l, int width, int height)
{
    const int around = 2 * blocks_of(hf_layers_hidden_reach(l));
    return (size_t)(blocks_of(width) + around) * (size_t)(blocks_of(height) + around);
}

size_t hf_layers_hidden_floats(const struct hf_layers *l, int width, int height)
{
    height += 2 * HF_LAYERS_SMOOTH;
    return (size_t)(l->levels + 1) * (size_t)(l->channels + 2) * plane_floats(l, width, height) +
           (size_t)blocks_of(width) * BLOCK * (size_t)height + 5 * block_count(l, width, height) + PAD;
}

static struct hf_layers_set place(const struct band *b, float **memory)
{
    const int width = b->r.x1 - b->r.x0, height = b->r.y1 - b->r.y0;
    struct hf_layers_set s = {.stride = (width + 2 * b->reach + 15) / 16 * 16 + 2 * PAD};
    float **const plane[6] = {&s.colour[0], &s.colour[1], &s.colour[2], &s.weight, &s.radius, &s.colour[3]};
    for (int i = 0; i < b->l->channels + 2; i++) {
        *plane[i] = *memory + (b->reach - b->r.y0) * s.stride + b->reach + PAD - b->r.x0;
        *memory += plane_floats(b->l, width, height);
    }
    return s;
}

static void place_blocks(struct band *b, float **memory)
{
    const int width = b->r.x1 - b->r.x0, height = b->r.y1 - b->r.y0;
    const size_t count = block_count(b->l, width, height);
    b->columns = blocks_of(width);
    b->rows = blocks_of(height);
    b->around = blocks_of(b->reach);
    b->stride = b->columns + 2 * b->around;
    b->width = b->columns * BLOCK;
    const ptrdiff_t first = b->around * b->stride + b->around;
    b->nearest = *memory;
    b->farthest = b->nearest + (size_t)b->width * (size_t)height + first;
    b->within = b->farthest + count;
    uint8_t *bytes = (uint8_t *)(b->within - first + count);
    b->needed = bytes + first;
    b->wide = b->needed + count;
    for (int j = 0; j < HF_LAYERS_LEVELS; j++)
        b->made[j] = b->wide + (size_t)(j + 1) * count;
    *memory += (size_t)b->width * (size_t)height + 5 * count;
}

static void planes_of(const struct hf_layers_set *s, int channels, int x, int y, float *out[6])
{
    const ptrdiff_t at = y * s->stride + x;
    for (int c = 0; c < channels; c++)
        out[c] = s->colour[c] + at;
    out[4] = s->weight + at;
    out[5] = s->radius + at;
}

// The range of the radii in a block; without weights all samples count.
static struct hf_layers_range range_of(const struct band *b, const float *radius, const float *weight, ptrdiff_t stride,
                                       int n, int rows)
{
    struct hf_layers_range range = {HUGE_VALF, -HUGE_VALF};
    hf_layers_kernels(b->f)->extremes(radius, weight, NULL, stride, n, rows, &range);
    return range;
}

// Mark the blocks that have one at most `by` blocks away that needs at least `least` levels: along rows, then columns.
static void spread(const struct band *b, int least, int by, uint8_t *out)
{
    for (int y = 0; y < b->rows; y++)
        for (int x = -b->around; x < b->columns + b->around; x++) {
            uint8_t any = 0;
            for (int i = hf_max(x - by, 0); i <= hf_min(x + by, b->columns - 1); i++)
                any |= b->needed[y * b->stride + i] >= least;
            b->wide[y * b->stride + x] = any;
        }
    for (int y = -b->around; y < b->rows + b->around; y++)
        for (int x = -b->around; x < b->columns + b->around; x++)
            for (int i = hf_max(y - by, 0); i <= hf_min(y + by, b->rows - 1); i++)
                out[y * b->stride + x] |= b->wide[i * b->stride + x];
}

// Find the nearest visible radius of each quad, and the farthest radius within each block's reach.
static void find_farthest(struct band *b)
{
    const struct hf_buf *at = &b->f->buf[HF_LAYERS_BUF_QUADS_AT];
    const struct hf_rect r = {b->r.x0 - b->reach, b->r.y0 - b->reach, b->r.x1 + b->reach, b->r.y1 + b->reach};
    for (int y = b->r.y0; y < b->r.y1 && !hf_stopped(b->f->s->stop); y++) {
        const float *radius[4], *weight[4];
        hf_layers_quad_rows(b->f, b->r.x0, y, radius, weight);
        hf_layers_kernels(b->f)->nearest(radius, weight, b->r.x1 - b->r.x0, b->nearest + (y - b->r.y0) * b->width);
    }
    for (int y = -b->around; y < b->rows + b->around && !hf_stopped(b->f->s->stop); y++)
        for (int x = -b->around; x < b->columns + b->around; x++) {
            const int x0 = hf_max(b->r.x0 + x * BLOCK, r.x0), x1 = hf_min(b->r.x0 + (x + 1) * BLOCK, r.x1);
            const int y0 = hf_max(b->r.y0 + y * BLOCK, r.y0), y1 = hf_min(b->r.y0 + (y + 1) * BLOCK, r.y1);
            b->farthest[y * b->stride + x] =
                range_of(b, hf_at(at, 1, x0, y0), hf_at(at, 0, x0, y0), at->stride, x1 - x0, y1 - y0).high;
        }
    // Along rows, then along columns in place: each result goes to a row that is no longer read.
    for (int y = -b->around; y < b->rows + b->around; y++)
        for (int x = 0; x < b->columns; x++) {
            float high = -HUGE_VALF;
            for (int j = x - b->around; j <= x + b->around; j++)
                high = fmaxf(b->farthest[y * b->stride + j], high);
            b->within[y * b->stride + x] = high;
        }
    for (int y = 0; y < b->rows; y++)
        for (int x = 0; x < b->columns; x++) {
            float high = -HUGE_VALF;
            for (int i = y - b->around; i <= y + b->around; i++)
                high = fmaxf(b->within[i * b->stride + x], high);
            b->within[(y - b->around) * b->stride + x] = high;
        }
    b->within -= b->around * b->stride;
}

// The levels that blocks need to find what lies at least a pixel of radius behind their nearest surface; 0: there is
// nothing.
static void find_needed(struct band *b)
{
    for (int y = 0; y < b->rows && !hf_stopped(b->f->s->stop); y++)
        for (int x = 0; x < b->columns; x++) {
            const int n = hf_min(b->r.x1 - b->r.x0 - x * BLOCK, BLOCK),
                      rows = hf_min(b->r.y1 - b->r.y0 - y * BLOCK, BLOCK);
            const float *nearest = b->nearest + y * BLOCK * b->width + x * BLOCK;
            // Rounding of the means is allowed for.
            const float low = range_of(b, nearest, NULL, b->width, n, rows).low;
            const float behind = b->within[y * b->stride + x] - low + ROUNDED;
            uint8_t *needed = &b->needed[y * b->stride + x];
            for (*needed = behind > 1; *needed && *needed < b->l->levels && behind > hf_layers_level_from(*needed);)
                ++*needed;
        }
}

// Beyond the frame everything equals its border. So beyond a level's reach its rows are all alike, and only the last of
// them is made.
static int row_of(const struct band *b, int level, int y)
{
    const int reach = (1 << level) - 1, last = b->f->s->half_height - 1 + reach;
    return y < -reach ? -reach : y < last ? y : last;
}

// The columns of a level that are made: x0 to before x1.
static void columns_of(const struct band *b, int level, int *x0, int *x1)
{
    const int around = (1 << b->l->levels) - (1 << level), reach = (1 << level) - 1;
    *x0 = hf_max(b->r.x0 - around, -reach);
    *x1 = hf_min(b->r.x1 + around, b->f->s->half_width + reach);
}

// How a level's samples are merged: three along a row, and then the results of three rows.
struct merge {
    const struct hf_layers_set *from, *to;
    int row[3], dx;  // in `from`: the rows, and the distance of columns
    int x0, x1;      // columns that are made
    float slope;
};

// Merge three rows or columns into row `to`, which stands for row y of a level, where its blocks are marked.
static void merge_row(const struct band *b, const struct merge *m, const uint8_t *marks, int y, int to)
{
    const int channels = b->l->channels;
    const uint8_t *row = marks + ((y - b->r.y0 + b->around * BLOCK) / BLOCK - b->around) * b->stride;
    for (int start = -b->around, end; start < b->columns + b->around; start = end) {
        for (end = start + 1; end < b->columns + b->around && !row[end] == !row[start];)
            end++;
        const int x = hf_max(b->r.x0 + start * BLOCK, m->x0), n = hf_min(b->r.x0 + end * BLOCK, m->x1) - x;
        float *in[3][6] = {{NULL}}, *out[6];
        if (!row[start] || n <= 0)
            continue;
        for (int i = 0; i < 3; i++)
            planes_of(m->from, channels, x + (i - 1) * m->dx, m->row[i], in[i]);
        planes_of(m->to, channels, x, to, out);
        hf_layers_kernels(b->f)->merge((const float *const(*)[6])in, channels, m->slope, n, out);
    }
}

// Repeat the first and last columns that are made into those that are read beyond them, where blocks are marked.
static void repeat_ends(const struct band *b, int level, const uint8_t *marks, int x0, int x1, int y)
{
    const int first = b->r.x0 - b->around * BLOCK, more = 3 << level, around = (1 << b->l->levels) - (1 << level);
    const int from[2] = {hf_max(b->r.x0 - around, x0 - more), x1}, to[2] = {x0, hf_min(b->r.x1 + around, x1 + more)};
    const uint8_t *row = marks + ((y - b->r.y0 + b->around * BLOCK) / BLOCK - b->around) * b->stride - b->around;
    for (int side = 0; side < 2; side++) {
        const int like = side ? x1 - 1 : x0;
        float *plane[6] = {NULL};
        if (!row[(like - first) / BLOCK])
            continue;
        planes_of(&b->level[level], b->l->channels, 0, y, plane);
        for (int c = 0; c < 6; c++)
            for (int x = from[side]; plane[c] && x < to[side]; x++)
                plane[c][x] = plane[c][like];
    }
}

// The row in which level j keeps the merged row y. The ring holds as many rows as level j merges, and those between.
static int ring_row(const struct band *b, int j, int y)
{
    const int first = b->r.y0 - b->reach, before = (1 << j) - 2 + j - 1;
    return first + before + (y - first) % ((1 << j) + 1);
}

// Make level j where later levels and the search read it. All levels advance together, row by row, so what the level
// before has just made is still in the cache.
static void make_levels(struct band *b)
{
    const int levels = b->l->levels, top = b->r.y0, low = b->r.y1, most = (1 << levels) - 1;
    for (int j = 0; j < levels; j++) {
        memset(b->made[j] - b->around * b->stride - b->around, 0,
               (size_t)b->stride * (size_t)(b->rows + 2 * b->around));
        for (int k = j + 1; k <= levels; k++)
            spread(b, k, blocks_of((1 << k) - (1 << j)), b->made[j]);
    }
    for (int newest = top - most; newest < low + most && !hf_stopped(b->f->s->stop); newest++)
        for (int j = 1, y = newest; j < levels && !hf_stopped(b->f->s->stop); j++) {
            const int step = 1 << (j - 1), reach = (1 << levels) - (1 << j);
            struct merge m = {.from = &b->level[j - 1],
                              .to = &b->across,
                              .row = {y, y, y},
                              .dx = step,
                              .slope = 1 / hf_layers_level_from(j)};
            columns_of(b, j, &m.x0, &m.x1);
            if (y >= top - reach - step && y < low + reach + step && y == row_of(b, j - 1, y))
                merge_row(b, &m, b->made[j - 1], y, ring_row(b, j, y));
            y -= step;
            if (y < top - reach || y >= low + reach || y != row_of(b, j, y))
                continue;
            m.from = &b->across;
            m.to = &b->level[j];
            m.dx = 0;
            for (int i = 0; i < 3; i++)
                m.row[i] = ring_row(b, j, row_of(b, j - 1, y + (i - 1) * step));
            merge_row(b, &m, b->made[j], y, y);
            repeat_ends(b, j, b->made[j], m.x0, m.x1, y);
        }
}

// The lines through a sample of level 0: row, column and both diagonals, no longer than the levels' reach.
static void make_lines(struct band *b)
{
    static const int step[HF_LAYERS_STEPS] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16},
                     along[HF_LAYERS_LINES][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    for (int k = 0; k < HF_LAYERS_LINES; k++) {
        struct hf_hidden_line *line = &b->line[k];
        const ptrdiff_t apart = along[k][1] * b->level[0].stride + along[k][0];
        line->steps = 0;
        for (int i = 0; i < HF_LAYERS_STEPS && step[i] <= 1 << b->l->levels; i++, line->steps++) {
            line->side[0][i] = step[i] * apart;
            line->side[1][i] = -step[i] * apart;
            line->away[i] = (float)step[i] * (k < 2 ? 1 : 1.41421356f);
            line->least[i] = hf_layers_line_least(line->away[i]);
        }
    }
}

// An upper bound of how far behind its nearest surface a run of a row may find anything, rounding allowed for.
static float farthest_behind(const struct band *b, const float *nearest, int x, int n, int y)
{
    const float *within = b->within + (y - b->r.y0) / BLOCK * b->stride;
    float high = -HUGE_VALF;
    for (int i = (x - b->r.x0) / BLOCK; i * BLOCK < x - b->r.x0 + n; i++)
        high = fmaxf(within[i], high);
    return high - range_of(b, nearest, NULL, 0, n, 1).low + ROUNDED;
}

// Add surfaces that continue between opposite sides. Steps beyond the reach of that bound are left out.
static void find_between(const struct band *b, const float *nearest, float behind, int x, int n, int y,
                         float *const sum[7])
{
    float *in[6] = {NULL};
    planes_of(&b->level[0], b->l->channels, x, y, in);
    for (int k = 0; k < HF_LAYERS_LINES; k++) {
        const struct hf_hidden_line *line = &b->line[k];
        int steps = line->steps;
        while (steps > 0 && behind * (1.0f / 3) + (1 - line->away[steps - 1]) < -ROUNDED)
            steps--;
        hf_layers_kernels(b->f)->between(line, steps, (const float *const *)in, b->l->channels, nearest, n, sum);
    }
}

// How levels are tapped: where a tap's ramp begins and how steep it is. It begins at a radius half a step before the tap, but
// not before the level is needed.
static void make_taps(struct band *b)
{
    static const float distance[3] = {0, 1, 1.41421356f}, share[3] = {1, 0.5f, 0.25f};
    float part = 1;
    for (int j = 0; j < b->l->levels; j++, part /= 256)
        for (int i = 0; i < 9; i++) {
            const int of = (i % 3 != 1) + (i / 3 != 1);
            const float away = distance[of], step = (float)(2 << j), full = (of || !j ? away + 0.5f : 1.5f) * step,
                        from = fmaxf((away - 0.5f) * step, hf_layers_level_from(j));
            b->tap[j][i] = (struct hf_hidden_tap){.from = from,
                                                  .scale = 1 / (full - from),
                                                  .part = part * share[of],
                                                  .whole = HF_LAYERS_REACHED / part,
                                                  .least = fmaxf(from, 1)};
        }
}

// The taps of a row: with its samples, from column 0 on.
static void place_taps(struct band *b, int y)
{
    for (int j = 0; j < b->l->levels; j++)
        for (int i = 0; i < 9; i++)
            planes_of(&b->level[j], b->l->channels, (i % 3 - 1) * (1 << j), row_of(b, j, y + (i / 3 - 1) * (1 << j)),
                      (float **)b->tap[j][i].in);
}

static void find(const struct band *b, int x, int n, int y, int levels)
{
    const struct hf_layers_kernels *k = hf_layers_kernels(b->f);
    const int channels = b->l->channels;
    const float *nearest = b->nearest + (y - b->r.y0) * b->width + x - b->r.x0;
    _Alignas(64) float memory[7][STEP + PAD];
    float *sum[7], *out[6] = {NULL};
    for (int i = 0; i < 7; i++) {
        sum[i] = memory[i];
        memset(sum[i], 0, sizeof(float) * (size_t)(n + BLOCK));  // clears the rest of the last vector too
    }
    const float behind = farthest_behind(b, nearest, x, n, y);
    const struct hf_hidden_tap *taps[9 * HF_LAYERS_LEVELS];
    int count = 0;
    for (int j = 0; j < levels; j++)
        for (int i = 0; i < 9; i++)
            if (behind > b->tap[j][i].least)
                taps[count++] = &b->tap[j][i];
    k->taps(taps, count, x, channels, nearest, n, sum);
    find_between(b, nearest, behind, x, n, y, sum);
    const float *radius[4], *weight[4];
    hf_layers_quad_rows(b->f, x, y, radius, weight);
    planes_of(&b->found, channels, x, y, out);
    k->found((const float *const *)sum, radius, weight, channels, n, out);
}

// The next run of blocks in a row that need equally many levels; at most STEP samples.
struct run {
    int x, n, needed, end;
};

static const uint8_t *needed_in(const struct band *b, int y)
{
    return b->needed + (y - b->r.y0) / BLOCK * b->stride;
}

static int next_run(const struct band *b, const uint8_t *needed, struct run *run)
{
    const int start = run->end;
    if (start >= b->columns)
        return 0;
    for (run->end++; run->end < b->columns && needed[run->end] == needed[start] && (run->end - start) * BLOCK < STEP;)
        run->end++;
    run->x = b->r.x0 + start * BLOCK;
    run->n = hf_min(b->r.x0 + run->end * BLOCK, b->r.x1) - run->x;
    run->needed = needed[start];
    return 1;
}

// Whether anything may lie at least a pixel of radius behind one of a block's quads in row y.
static int is_behind(const struct band *b, int block, int y)
{
    const float *nearest = b->nearest + (y - b->r.y0) * b->width + block * BLOCK,
                before = b->within[(y - b->r.y0) / BLOCK * b->stride + block] - 1 + ROUNDED;
    const int n = hf_min(b->r.x1 - b->r.x0 - block * BLOCK, BLOCK);
    int any = 0;
    for (int x = 0; x < n; x++)
        any |= nearest[x] < before;
    return any;
}

// Search a row of the band where one of a block's quads needs it. Beyond the frame nothing is hidden.
static void find_row(struct band *b, int y)
{
    const uint8_t *needed = needed_in(b, y);
    float *weight = b->found.weight + y * b->found.stride;
    int any = 0;
    for (int i = 0; i < b->columns; i++)
        any |= b->wide[i] = needed[i] && is_behind(b, i, y) ? needed[i] : 0;
    if (any)
        place_taps(b, y);
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, b->wide, &run);)
        if (run.needed)
            find(b, run.x, run.n, y, run.needed);
        else
            memset(weight + run.x, 0, sizeof(float) * (size_t)run.n);
    memset(weight + b->r.x0 - HF_LAYERS_SMOOTH, 0, sizeof(float) * HF_LAYERS_SMOOTH);
    memset(weight + b->r.x1, 0, sizeof(float) * HF_LAYERS_SMOOTH);
}

// Neighbouring samples may come from different levels. Means along rows, then along columns, hide those steps.
static void smooth_along(const struct band *b, int y)
{
    const int channels = b->l->channels;
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, needed_in(b, y), &run);) {
        float *in[HF_LAYERS_TAPS][6] = {{NULL}}, *out[6] = {NULL};
        planes_of(&b->across, channels, run.x, y, out);
        for (int i = 0; i < HF_LAYERS_TAPS; i++)
            planes_of(&b->found, channels, run.x + i - HF_LAYERS_SMOOTH, y, in[i]);
        if (run.needed)
            hf_layers_kernels(b->f)->smooth((const float *const(*)[6])in, NULL, channels, run.n, out);
        else
            memset(out[4], 0, sizeof(float) * (size_t)run.n);
    }
    float *weight = b->across.weight + y * b->across.stride;
    memset(weight + b->r.x0 - HF_LAYERS_SMOOTH, 0, sizeof(float) * HF_LAYERS_SMOOTH);
    memset(weight + b->r.x1, 0, sizeof(float) * HF_LAYERS_SMOOTH);
}

static void smooth_down(const struct band *b, int colour, int at, int y)
{
    static const float none[STEP + PAD];
    const int channels = b->l->channels;
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, needed_in(b, y), &run);) {
        float *in[HF_LAYERS_TAPS][6] = {{NULL}}, *out[6] = {NULL};
        hf_row(&b->f->buf[colour], channels, run.x, y, out);
        out[4] = hf_at(&b->f->buf[at], 0, run.x, y);
        out[5] = hf_at(&b->f->buf[at], 1, run.x, y);
        for (int i = 0; i < HF_LAYERS_TAPS; i++) {
            const int from = y + i - HF_LAYERS_SMOOTH, inside = from >= b->r.y0 && from < b->r.y1;
            planes_of(&b->across, channels, run.x, inside ? from : y, in[i]);
            in[i][4] = inside ? in[i][4] : (float *)none;
        }
        const float *const along[2] = {in[HF_LAYERS_SMOOTH][4], in[HF_LAYERS_SMOOTH][5]};
        if (run.needed)
            hf_layers_kernels(b->f)->smooth((const float *const(*)[6])in, along, channels, run.n, out);
        else
            memset(out[4], 0, sizeof(float) * (size_t)run.n);
    }
}

// A near sample that was found takes the place of the visible one, and the next search looks behind it. That search
// accepts only samples less than half as near, because it is the last: of three blades before a wall it must find the
// wall. A found sample that is far or in focus needs none behind it; the far field's blur fills the gap there. One that
// covers little of its quad hides as little as one that is hardly near.
static void look_behind(const struct band *b, int y)
{
    const float *weight = b->found.weight + y * b->found.stride, *radius = b->found.radius + y * b->found.stride;
    float *nearest = b->nearest + (y - b->r.y0) * b->width - b->r.x0;
    for (int x = b->r.x0; x < b->r.x1; x++) {
        const float part = hf_saturate(HF_LAYERS_WHOLE * weight[x]), half = radius[x] * 0.5f;
        nearest[x] = !(part > 0) || radius[x] >= -1 ? HUGE_VALF : part < 1 ? part * (half + 1) - 1 : half;
    }
}

// A sample behind one that is hardly near counts less, so nothing appears at once when the latter comes nearer.
static void begin_softly(const struct band *b, int y)
{
    float *weight = b->found.weight + y * b->found.stride;
    const float *nearest = b->nearest + (y - b->r.y0) * b->width - b->r.x0;
    for (int x = b->r.x0; x < b->r.x1; x++)
        weight[x] = weight[x] * hf_saturate(-1 - nearest[x]);
}

// Search and smooth rows r into two buffers. again: another search will look behind what was found.
static void search(struct band *b, struct hf_rect r, int colour, int at, int again)
{
    for (int y = b->r.y0; y < b->r.y1 && !hf_stopped(b->f->s->stop); y++) {
        find_row(b, y);
        if (again)
            look_behind(b, y);
        else
            begin_softly(b, y);
        smooth_along(b, y);
    }
    for (int y = r.y0; y < r.y1 && !hf_stopped(b->f->s->stop); y++)
        smooth_down(b, colour, at, y);
}

// Set alpha to 1 where no alpha was searched, for readers of the samples.
static void fill_alpha(const struct hf_frame *f, struct hf_rect r, int colour)
{
    for (int y = r.y0; y < r.y1; y++) {
        float *alpha = hf_at(&f->buf[colour], 3, r.x0, y);
        for (int x = 0; x < r.x1 - r.x0; x++)
            alpha[x] = 1;
    }
}

// Find the hidden samples of a band.
static void find_hidden(const struct hf_frame *f, struct hf_rect r)
{
    struct hf_layers l = *hf_layers(f->s);
    const int channels = l.channels;
    struct band b = {.f = f, .l = &l, .r = r, .reach = hf_layers_hidden_reach(&l)};
    const struct hf_buf *colour = &f->buf[HF_LAYERS_BUF_QUADS], *at = &f->buf[HF_LAYERS_BUF_QUADS_AT];
    float *memory = f->work;
    l.channels = hf_layers_drawn(&l);
    b.r.y0 = hf_max(r.y0 - HF_LAYERS_SMOOTH, 0);
    b.r.y1 = hf_min(r.y1 + HF_LAYERS_SMOOTH, f->s->half_height);
    b.level[0] = (struct hf_layers_set){.weight = at->ch[0], .radius = at->ch[1], .stride = colour->stride};
    memcpy(b.level[0].colour, colour->ch, sizeof colour->ch);
    b.across = place(&b, &memory);
    b.found = place(&b, &memory);
    for (int j = 1; j < l.levels; j++)
        b.level[j] = place(&b, &memory);
    place_blocks(&b, &memory);
    find_farthest(&b);
    find_needed(&b);
    make_lines(&b);
    make_taps(&b);
    make_levels(&b);
    search(&b, r, HF_LAYERS_BUF_HIDDEN, HF_LAYERS_BUF_HIDDEN_AT, 1);
    find_needed(&b);
    search(&b, r, HF_LAYERS_BUF_BEYOND, HF_LAYERS_BUF_BEYOND_AT, 0);
    if (l.channels == channels)
        return;
    fill_alpha(f, r, HF_LAYERS_BUF_HIDDEN);
    fill_alpha(f, r, HF_LAYERS_BUF_BEYOND);
}

void hf_layers_hidden_pass(const struct hf_frame *f, struct hf_rect r)
{
    const int levels = hf_layers(f->s)->levels;
    if (levels)
        find_hidden(f, r);
    hf_layers_bound_border(f, r);
    if (!levels)
        return;
    if (hf_layers(f->s)->guessed) {
        hf_layers_set_colours(f, HF_LAYERS_BUF_HIDDEN, r, 0);
        hf_layers_set_colours(f, HF_LAYERS_BUF_BEYOND, r, 0);
    }
    if (!hf_stopped(f->s->stop) && !hf_layers(f->s)->known)
        hf_layers_mark_hidden(f, r);
}
