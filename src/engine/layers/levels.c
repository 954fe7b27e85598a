// SPDX-License-Identifier: BSD-3-Clause
// The levels of hidden samples: where each is needed, and how they are made.
#include <math.h>
#include <string.h>

#include "engine/layers/band.h"
#include "pixel/pass_c.h"

int hf_layers_hidden_reach(const struct hf_layers *l)
{
    return l->levels ? (1 << l->levels) + HF_LAYERS_SMOOTH : 0;
}

static int blocks_of(int n)
{
    return (n + HF_HIDDEN_BLOCK - 1) / HF_HIDDEN_BLOCK;
}

static size_t block_count(const struct hf_layers *l, int width, int height)
{
    const int around = 2 * blocks_of(hf_layers_hidden_reach(l));
    return (size_t)(blocks_of(width) + around) * (size_t)(blocks_of(height) + around);
}

// Floats for what a band notes of its blocks, in whole cache lines.
static size_t block_floats(const struct hf_layers *l, int width, int height)
{
    return (5 * block_count(l, width, height) + 15) & ~(size_t)15;
}

// Where a band begins in a plane of a row: at a cache line, so that a vector of a block that is merged or smoothed lies in one line
// and not in two. The pass Hidden takes 0.94 of its time so (AVX-512).
static int lead_floats(const struct hf_layers *l)
{
    return (hf_layers_hidden_reach(l) + 15) / 16 * 16 + HF_HIDDEN_PAD;
}

// A plane of a row, with what the search reads beside the band.
static int plane_floats(const struct hf_layers *l, int width)
{
    return (width + 15) / 16 * 16 + 2 * lead_floats(l);
}

size_t hf_hidden_row_floats(const struct hf_layers *l, int width)
{
    return (size_t)(l->channels + 2) * (size_t)plane_floats(l, width);
}

struct hf_hidden_ring hf_hidden_ring(const struct hf_hidden_band *b, int turn, float **memory)
{
    const int plane = plane_floats(b->l, b->r.x1 - b->r.x0);
    struct hf_hidden_ring ring = {.first = b->r.y0 - b->reach, .turn = turn};
    struct hf_layers_set *s = &ring.set;
    float **const at[6] = {&s->colour[0], &s->colour[1], &s->colour[2], &s->weight, &s->radius, &s->colour[3]};
    for (int i = 0; i < b->l->channels + 2; i++)
        *at[i] = *memory + i * plane + lead_floats(b->l) - b->r.x0;
    s->stride = plane * (b->l->channels + 2);
    *memory += (size_t)turn * (size_t)s->stride;
    return ring;
}

// Rows of level j that are kept: from the first that is tapped until all levels after it have got as far.
static int level_rows(const struct hf_layers *l)
{
    return (1 << l->levels) + 1;
}

// Rows that are merged into level j, and those between.
static int merged_rows(int j)
{
    return (1 << j) + 1;
}

size_t hf_hidden_band_floats(const struct hf_layers *l, int width, int height)
{
    size_t rows = 0;
    for (int j = 1; j < l->levels; j++)
        rows += (size_t)(level_rows(l) + merged_rows(j));
    return rows * hf_hidden_row_floats(l, width) + block_floats(l, width, height);
}

static void place_blocks(struct hf_hidden_band *b, float **memory)
{
    const int width = b->r.x1 - b->r.x0, height = b->r.y1 - b->r.y0;
    const size_t count = block_count(b->l, width, height);
    b->columns = blocks_of(width);
    b->rows = blocks_of(height);
    b->around = blocks_of(b->reach);
    b->stride = b->columns + 2 * b->around;
    const ptrdiff_t first = b->around * b->stride + b->around;
    b->farthest = *memory + first;
    b->within = b->farthest + count;
    uint8_t *bytes = (uint8_t *)(b->within - first + count);
    b->needed = bytes + first;
    b->wide = b->needed + count;
    for (int j = 0; j < HF_LAYERS_LEVELS; j++)
        b->made[j] = b->wide + (size_t)(j + 1) * count;
    *memory += block_floats(b->l, width, height);
}

struct hf_layers_range hf_hidden_range(const struct hf_hidden_band *b, const float *radius, const float *weight,
                                       ptrdiff_t stride, int n, int rows)
{
    struct hf_layers_range range = {HUGE_VALF, -HUGE_VALF};
    hf_layers_kernels(b->f)->extremes(radius, weight, stride, n, rows, &range);
    return range;
}

// Mark the blocks that have one at most `by` blocks away that needs at least `least` levels: along rows, then columns.
static void spread(const struct hf_hidden_band *b, int least, int by, uint8_t *out)
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

// Find the farthest radius within each block's reach.
static void find_farthest(struct hf_hidden_band *b)
{
    const struct hf_buf *at = &b->f->buf[HF_LAYERS_BUF_QUADS_AT];
    const struct hf_rect r = {b->r.x0 - b->reach, b->r.y0 - b->reach, b->r.x1 + b->reach, b->r.y1 + b->reach};
    for (int y = -b->around; y < b->rows + b->around && !hf_stopped(b->f->s->stop); y++)
        for (int x = -b->around; x < b->columns + b->around; x++) {
            const int x0 = hf_max(b->r.x0 + x * HF_HIDDEN_BLOCK, r.x0),
                      x1 = hf_min(b->r.x0 + (x + 1) * HF_HIDDEN_BLOCK, r.x1);
            const int y0 = hf_max(b->r.y0 + y * HF_HIDDEN_BLOCK, r.y0),
                      y1 = hf_min(b->r.y0 + (y + 1) * HF_HIDDEN_BLOCK, r.y1);
            b->farthest[y * b->stride + x] =
                hf_hidden_range(b, hf_at(at, 1, x0, y0), hf_at(at, 0, x0, y0), at->stride, x1 - x0, y1 - y0).high;
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
static void find_needed(struct hf_hidden_band *b)
{
    const struct hf_buf *at = &b->f->buf[HF_LAYERS_BUF_QUADS_AT];
    for (int y = 0; y < b->rows && !hf_stopped(b->f->s->stop); y++)
        for (int x = 0; x < b->columns; x++) {
            const int n = hf_min(b->r.x1 - b->r.x0 - x * HF_HIDDEN_BLOCK, HF_HIDDEN_BLOCK),
                      rows = hf_min(b->r.y1 - b->r.y0 - y * HF_HIDDEN_BLOCK, HF_HIDDEN_BLOCK);
            const float *nearest = hf_at(at, 2, b->r.x0 + x * HF_HIDDEN_BLOCK, b->r.y0 + y * HF_HIDDEN_BLOCK);
            // Rounding of the means is allowed for.
            const float low = hf_hidden_range(b, nearest, NULL, at->stride, n, rows).low;
            const float behind = b->within[y * b->stride + x] - low + HF_HIDDEN_ROUNDED;
            uint8_t *needed = &b->needed[y * b->stride + x];
            for (*needed = behind > 1; *needed && *needed < b->l->levels && behind > hf_layers_level_from(*needed);)
                ++*needed;
        }
}

// Beyond the frame everything equals its border. So beyond a level's reach its rows are all alike, and only the last of
// them is made.
static int row_of(const struct hf_hidden_band *b, int level, int y)
{
    const int reach = (1 << level) - 1, last = b->f->s->half_height - 1 + reach;
    return y < -reach ? -reach : y < last ? y : last;
}

// The columns of a level that are made: x0 to before x1.
static void columns_of(const struct hf_hidden_band *b, int level, int *x0, int *x1)
{
    const int around = (1 << b->l->levels) - (1 << level), reach = (1 << level) - 1;
    *x0 = hf_max(b->r.x0 - around, -reach);
    *x1 = hf_min(b->r.x1 + around, b->f->s->half_width + reach);
}

// How a level's samples are merged: three along a row, and then the results of three rows.
struct merge {
    struct hf_layers_set from, to;
    int row[3], out, dx;  // the rows in `from`, the row in `to`, and the distance of columns
    int x0, x1;           // columns that are made
    float slope;
};

static const uint8_t *marks_of(const struct hf_hidden_band *b, int level, int y)
{
    return b->made[level] + ((y - b->r.y0 + b->around * HF_HIDDEN_BLOCK) / HF_HIDDEN_BLOCK - b->around) * b->stride;
}

// Merge three rows or columns into a row, where its blocks are marked.
static void merge_row(const struct hf_hidden_band *b, const struct merge *m, const uint8_t *marks)
{
    const int channels = b->l->channels;
    for (int start = -b->around, end; start < b->columns + b->around; start = end) {
        // A block that is made in part is merged by itself, so that vectors of the others lie in one cache line each.
        const int whole = b->r.x0 + start * HF_HIDDEN_BLOCK >= m->x0;
        for (end = start + 1; whole && end < b->columns + b->around && !marks[end] == !marks[start];)
            end++;
        const int x = hf_max(b->r.x0 + start * HF_HIDDEN_BLOCK, m->x0),
                  n = hf_min(b->r.x0 + end * HF_HIDDEN_BLOCK, m->x1) - x;
        float *in[3][6] = {{NULL}}, *out[6];
        if (!marks[start] || n <= 0)
            continue;
        for (int i = 0; i < 3; i++)
            hf_hidden_planes(&m->from, channels, x + (i - 1) * m->dx, m->row[i], in[i]);
        hf_hidden_planes(&m->to, channels, x, m->out, out);
        hf_layers_kernels(b->f)->merge((const float *const(*)[6])in, channels, m->slope, n, out);
    }
}

// Repeat the first and last columns that are made into those that are read beyond them, where blocks are marked.
static void repeat_ends(const struct hf_hidden_band *b, int level, const struct merge *m, const uint8_t *marks)
{
    const int first = b->r.x0, more = 3 << level, around = (1 << b->l->levels) - (1 << level);
    const int from[2] = {hf_max(first - around, m->x0 - more), m->x1},
              to[2] = {m->x0, hf_min(b->r.x1 + around, m->x1 + more)};
    for (int side = 0; side < 2; side++) {
        const int like = side ? m->x1 - 1 : m->x0;
        float *plane[6] = {NULL};
        if (!marks[(like - first + b->around * HF_HIDDEN_BLOCK) / HF_HIDDEN_BLOCK - b->around])
            continue;
        hf_hidden_planes(&m->to, b->l->channels, 0, m->out, plane);
        for (int c = 0; c < 6; c++)
            for (int x = from[side]; plane[c] && x < to[side]; x++)
                plane[c][x] = plane[c][like];
    }
}

static struct hf_layers_set set_of(const struct hf_hidden_band *b, int level)
{
    return level ? b->level[level].set : b->quads;
}

static int level_row(const struct hf_hidden_band *b, int level, int y)
{
    const int row = row_of(b, level, y);
    return level ? hf_hidden_ring_row(&b->level[level], row) : row;
}

void hf_hidden_level(const struct hf_hidden_band *b, int level, int x, int y, float *out[6])
{
    const struct hf_layers_set set = set_of(b, level);
    hf_hidden_planes(&set, b->l->channels, x, level_row(b, level, y), out);
}

// All levels take up row y of level 0: each merges the row that the one before it has just made along itself, and then
// those three rows that are now complete.
static void take_up(const struct hf_hidden_band *b, int y)
{
    const int levels = b->l->levels, top = b->r.y0, low = b->r.y1;
    for (int j = 1; j < levels; j++) {
        const int step = 1 << (j - 1), reach = (1 << levels) - (1 << j);
        struct merge m = {
            .from = set_of(b, j - 1), .to = b->merged[j].set, .dx = step, .slope = 1 / hf_layers_level_from(j)};
        columns_of(b, j, &m.x0, &m.x1);
        if (y >= top - reach - step && y < low + reach + step && y == row_of(b, j - 1, y)) {
            m.row[0] = m.row[1] = m.row[2] = level_row(b, j - 1, y);
            m.out = hf_hidden_ring_row(&b->merged[j], y);
            merge_row(b, &m, marks_of(b, j - 1, y));
        }
        y -= step;
        if (y < top - reach || y >= low + reach || y != row_of(b, j, y))
            continue;
        m.from = b->merged[j].set;
        m.to = b->level[j].set;
        m.dx = 0;
        for (int i = 0; i < 3; i++)
            m.row[i] = hf_hidden_ring_row(&b->merged[j], row_of(b, j - 1, y + (i - 1) * step));
        m.out = level_row(b, j, y);
        merge_row(b, &m, marks_of(b, j, y));
        repeat_ends(b, j, &m, marks_of(b, j, y));
    }
}

// How many rows of level 0 the search of a row needs below it, and the levels need above the first.
static int lag(const struct hf_hidden_band *b)
{
    return (1 << b->l->levels) - 1;
}

void hf_hidden_advance(struct hf_hidden_band *b, int y)
{
    for (; b->next <= y + lag(b) && !hf_stopped(b->f->s->stop); b->next++)
        take_up(b, b->next);
}

// Mark the blocks in which each level is read.
static void find_made(struct hf_hidden_band *b)
{
    for (int j = 0; j < b->l->levels; j++) {
        memset(b->made[j] - b->around * b->stride - b->around, 0,
               (size_t)b->stride * (size_t)(b->rows + 2 * b->around));
        for (int k = j + 1; k <= b->l->levels; k++)
            spread(b, k, blocks_of((1 << k) - (1 << j)), b->made[j]);
    }
}

float *hf_hidden_begin(struct hf_hidden_band *b, float *memory)
{
    for (int j = 1; j < b->l->levels; j++) {
        b->level[j] = hf_hidden_ring(b, level_rows(b->l), &memory);
        b->merged[j] = hf_hidden_ring(b, merged_rows(j), &memory);
    }
    b->next = b->r.y0 - lag(b);
    place_blocks(b, &memory);
    find_farthest(b);
    find_needed(b);
    find_made(b);
    return memory;
}
