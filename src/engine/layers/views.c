// SPDX-License-Identifier: BSD-3-Clause
// Views of a cell, block by block: where they are needed, the planes that they read, and how they join the slices.
#include "engine/layers/views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/layers/parts.h"

enum {
    COLUMNS = HF_LAYERS_VIEWS_COLUMNS,
    ROWS = HF_LAYERS_VIEWS_ROWS,
    WIDTH = COLUMNS * TILE,
    HEIGHT = ROWS * TILE,
    PIXELS = WIDTH * HEIGHT,
    RUN = 2,    // tiles of a row that are made together
    SPARE = 16  // floats after a row
};
_Static_assert(COLUMNS *ROWS <= 32, "a bit for each tile");

// At a pixel some views may meet no sample and stay open. They take the mean of what other views see behind the focus,
// if at least this part of all views sees something there; with fewer, part of it is the mean of all that is seen.
// Slices have the same rule (HF_LAYERS_FAINT), but there less is open. Measured with two surfaces known and 192 views:
// with a half 43.2 dB on `fence` and 36.3 on `foliage`, with a tenth 46.2 and 36.7, with a fiftieth 46.5 and 37.0, but
// then one surface alone loses 0.06 on `foliage`.
#define FAINT (1.0f / 16)

// Planes of a slice, under construction.
struct plane {
    float *at;
    ptrdiff_t row, channel;
    int level, around;  // around: tiles on each side of the block
    uint32_t tiles;     // a bit for each tile of the block that the slice reaches
};

struct block {
    struct hf_cell c;  // only what hf_layers_place_sources() places
    struct plane *plane;
    struct hf_view_plane *list;
    float *memory;                       // of planes
    float blend[ROWS + 1][COLUMNS + 1];  // how far views count at the corners of the tiles
    // Of the block's pixels: means of the views as in hf_view_row, and what a cat's eye leaves of them.
    float *near[5], *beyond[5], *total;
};

// How far the blur of radius 1 goes.
static double wide_of(const struct hf_layers *l)
{
    return l->lens_reach * (1 + fabs((double)l->chromatic));
}

// How far a slice's blur goes, in pixels.
static double radius_of(const struct hf_layers *l, int slice)
{
    return fabs((double)l->slice[slice].radius) * wide_of(l);
}

// Views of large radii lie far apart, so their slices need no more than this: log2 of the pixel size.
static int level_of(double r)
{
    return r < 16 ? 0 : r < 32 ? 1 : r < 64 ? 2 : 3;
}

// Set the size of a slice's planes; returns how many floats they take.
static size_t shape_plane(const struct hf_layers *l, int slice, struct plane *p)
{
    const double r = radius_of(l, slice);
    p->level = level_of(r);
    // A displacement is rounded to a whole pixel.
    p->around = ((int)ceil(r) + 1 + (1 << p->level) + TILE - 1) / TILE;
    p->channel = WIDTH + 2 * p->around * TILE + SPARE;
    p->row = p->channel * (l->channels + 1);
    return (size_t)p->row * (size_t)((HEIGHT + 2 * p->around * TILE) >> p->level);
}

// Whether views show a slice.
static int is_in(const struct hf_layers *l, int slice)
{
    return radius_of(l, slice) <= (double)HF_LAYERS_VIEWS_MOST;
}

static size_t place(struct block *b, float *memory)
{
    const struct hf_layers *l = b->c.l;
    struct hf_scratch m = {.memory = memory};
    hf_layers_place_sources(&b->c, &m);
    b->plane = (struct plane *)(void *)hf_layers_take(&m, (size_t)l->slices * sizeof *b->plane / sizeof(float), 0);
    b->list =
        (struct hf_view_plane *)(void *)hf_layers_take(&m, (size_t)l->slices * sizeof *b->list / sizeof(float), 0);
    for (int i = 0; i < 5; i++) {
        b->near[i] = hf_layers_take(&m, PIXELS, 0);
        b->beyond[i] = hf_layers_take(&m, PIXELS, 0);
    }
    b->total = hf_layers_take(&m, PIXELS, 0);
    b->memory = hf_layers_take(&m, 0, 0);
    for (int i = 0; i < l->slices; i++) {
        struct plane p;
        m.used += is_in(l, i) ? (shape_plane(l, i, &p) + 15) & ~(size_t)15 : 0;
    }
    return m.used;
}

size_t hf_layers_views_floats(const struct hf_layers *l)
{
    struct block b = {.c = {.l = l, .columns = COLUMNS, .rows = ROWS}};
    return l->set.views && l->levels ? place(&b, NULL) : 0;
}

// ---- where ----

// Pixels between two ranges of tiles; 0 if they touch.
static int apart(int a, int b)
{
    return (abs(a - b) - 1) * TILE > 0 ? (abs(a - b) - 1) * TILE : 0;
}

// How far views count in a tile: fully where something is hidden whose light may come there, and not where light comes
// from radii too large for them.
static float blend_at(const struct hf_layers *l, int column, int row)
{
    const float most = hf_larger(-l->nearest, l->farthest) * (float)wide_of(l);
    const int n = (int)fminf(most, 65536) / TILE + 2;
    float much = 0, small = 1;
    for (int y = hf_max(row - n, 0); y < hf_min(row + n + 1, l->rows); y++)
        for (int x = hf_max(column - n, 0); x < hf_min(column + n + 1, l->columns); x++) {
            const struct hf_layers_crossing *t = &l->crossing[y * l->columns + x];
            const float away = (float)hf_max(apart(x, column), apart(y, row));
            const float reach = t->reach * (float)wide_of(l), near = hf_saturate((reach - away) * (1.0f / TILE) + 1);
            const float over = near * hf_saturate((reach - 0.75f * HF_LAYERS_VIEWS_MOST) * (4 / HF_LAYERS_VIEWS_MOST));
            much = hf_larger(t->much * near, much);
            small = 1 - over < small ? 1 - over : small;
        }
    return much * small;
}

// Find how far views count at the corners of tiles. Returns 0 if they do not at all.
static int find_blend(struct block *b)
{
    const struct hf_layers *l = b->c.l;
    const int column = b->c.x0 / TILE, row = b->c.y0 / TILE;
    float tile[ROWS + 2][COLUMNS + 2];
    int any = 0;
    for (int y = 0; y < ROWS + 2; y++)
        for (int x = 0; x < COLUMNS + 2; x++)
            tile[y][x] = blend_at(l, hf_min(hf_max(column + x - 1, 0), l->columns - 1),
                                  hf_min(hf_max(row + y - 1, 0), l->rows - 1));
    for (int y = 0; y <= ROWS; y++)
        for (int x = 0; x <= COLUMNS; x++) {
            b->blend[y][x] =
                hf_larger(hf_larger(tile[y][x], tile[y][x + 1]), hf_larger(tile[y + 1][x], tile[y + 1][x + 1]));
            any |= b->blend[y][x] > 0;
        }
    return any;
}

static int is_blended(const struct block *b, int tx, int ty)
{
    return b->blend[ty][tx] > 0 || b->blend[ty][tx + 1] > 0 || b->blend[ty + 1][tx] > 0 || b->blend[ty + 1][tx + 1] > 0;
}

// ---- planes ----

struct taker {
    struct plane *p;
    int channels;
};

static void add_row(float *to, const float *in, int n, int level)
{
    for (int i = 0; i < n << level; i++)
        to[i] += in[i >> level];
}

static void take_row(void *cookie, const float *in, ptrdiff_t channel, int x, int y, int n)
{
    const struct taker *t = cookie;
    struct plane *p = t->p;
    const int size = TILE >> p->level, left = -p->around * size, right = COLUMNS * size - left,
              high = ROWS * size + p->around * size;
    if (y < left || y >= high)
        return;
    const int from = x > left ? x : left, to = x + n < right ? x + n : right;
    if (from >= to)
        return;
    float *out = p->at + y * p->row + from * (1 << p->level);
    in += from - x;
    for (int c = 0; c < t->channels; c++)
        add_row(out + (c + 1) * p->channel, in + c * channel, to - from, p->level);
    add_row(out, in + t->channels * channel, to - from, p->level);
}

// A slice at the resolution that views need, of samples of pixels (finest 0) or of quads.
static struct hf_slice slice_of(const struct hf_layers *l, const struct hf_slice *from, const struct plane *p,
                                int finest)
{
    struct hf_slice s = *from;
    s.level = p->level;
    s.shape = NULL;
    s.rows = s.reach = (int)ceil(fabs((double)s.radius) * wide_of(l)) >> p->level;
    s.scale = 1 / (float)(1 << 2 * (p->level - finest));
    return s;
}

static uint32_t touched_tiles(const struct block *b)
{
    uint32_t tiles = 0;
    for (int ty = 0; ty < b->c.rows; ty++)
        for (int tx = 0; tx < b->c.columns; tx++)
            tiles |= (uint32_t)(*hf_layers_map_at(&b->c.touched, tx, ty) != 0) << (ty * COLUMNS + tx);
    return tiles;
}

// Whether samples of a kind reach the block; begins the planes if they are the first.
static int reach(struct block *b, int i, enum hf_kind kind, const struct hf_slice *s, size_t *used)
{
    struct plane *p = &b->plane[i];
    if (!hf_layers_mark_used(&b->c, i, kind) || !hf_layers_mark_touched(&b->c, s, &b->c.touched))
        return 0;
    const uint32_t tiles = touched_tiles(b);
    if (tiles && !p->tiles) {
        const size_t n = shape_plane(b->c.l, i, p);
        memset(b->memory + *used, 0, sizeof(float) * n);
        p->at = b->memory + *used + (p->around * TILE >> p->level) * p->row + p->around * TILE;
        *used += (n + 15) & ~(size_t)15;
    }
    p->tiles |= tiles;
    return tiles != 0;
}

// Gather what a slice's planes hold: sums of samples, without their highlights.
static void gather(struct block *b, int i, size_t *used)
{
    const struct hf_layers *l = b->c.l;
    const struct hf_samples *samples = b->c.samples;
    struct plane *p = &b->plane[i];
    struct taker to = {.p = p, .channels = l->channels};
    shape_plane(l, i, p);
    const struct hf_slice seen = slice_of(l, &l->slice[i], p, 0);
    if (reach(b, i, HF_KIND_SEEN, &seen, used)) {
        const struct hf_build build = {.s = &seen,
                                       .set = &samples->seen,
                                       .weight = samples->seen.weight,
                                       .share = l->set.highlights && l->slice[i].level > 0 ? samples->share : NULL,
                                       .channels = l->channels + 1,
                                       .more = &samples->mixed};
        hf_layers_take_sources(&b->c, &build, take_row, &to);
    }
    const int quads = !l->known && p->level > 0;
    const struct hf_slice behind = slice_of(l, l->known ? &l->slice[i] : &l->behind[i], p, quads);
    if (reach(b, i, HF_KIND_HIDDEN, &behind, used)) {
        const struct hf_build build = {.s = &behind,
                                       .set = &samples->hidden,
                                       .weight = samples->hidden.weight,
                                       .finest = quads,
                                       .spread = !quads && !l->known,
                                       .channels = l->channels + 1,
                                       .more = &samples->beyond};
        hf_layers_take_sources(&b->c, &build, take_row, &to);
    }
}

// Colours of a slice are means of its samples. Weights are divided by the number of views, so sums of theirs are means
// and cannot overflow.
static void divide(const struct plane *p, int channels, int views)
{
    const int size = TILE >> p->level, first = -p->around * size, rows = ROWS * size + 2 * p->around * size;
    for (int y = first; y < first + rows; y++) {
        float *w = p->at + y * p->row - p->around * TILE;
        for (int c = 1; c <= channels; c++) {
            float *v = p->at + y * p->row + c * p->channel - p->around * TILE;
            for (int x = 0; x < (int)p->channel - SPARE; x++)
                v[x] = v[x] / (w[x] > 1e-30f ? w[x] : 1e-30f);
        }
        for (int x = 0; x < (int)p->channel - SPARE; x++)
            w[x] *= 1 / (float)views;
    }
}

// Make the planes of all slices that reach the block.
static void make_planes(struct block *b)
{
    const struct hf_layers *l = b->c.l;
    size_t used = 0;
    for (int i = 0; i < l->slices && !hf_stopped(l->stop); i++) {
        struct plane *p = &b->plane[i];
        *p = (struct plane){0};
        if (!is_in(l, i))
            continue;
        gather(b, i, &used);
        if (p->tiles)
            divide(p, l->channels, l->set.views);
    }
}

// ---- rows ----

// The planes that reach a run of tiles, nearest first. Returns how many.
static int list_planes(const struct block *b, uint32_t tiles, struct hf_view_plane *to, int *far)
{
    const struct hf_layers *l = b->c.l;
    int n = 0;
    *far = 0;
    for (int i = 0; i < l->slices; i++) {
        const struct plane *p = &b->plane[i];
        if (!(p->tiles & tiles))
            continue;
        *far += l->slice[i].radius <= 0;
        to[n++] =
            (struct hf_view_plane){.at = p->at,
                                   .row = p->row,
                                   .channel = p->channel,
                                   .level = p->level,
                                   .shift = (const int16_t(*)[2])l->shift[l->group_used] + (ptrdiff_t)i * l->set.views};
    }
    return n;
}

// Make the views of a run of tiles.
static void make_run(const struct block *b, int tx, int ty, int n)
{
    struct hf_view_plane *plane = b->list;
    const struct hf_layers *l = b->c.l;
    const double corner = 1 / hypot(l->width, l->height), cat = (double)l->key.cat_eye;
    struct hf_view_row row = {.plane = plane,
                              .views = l->set.views,
                              .one = 1 / (float)l->set.views,
                              .channels = l->channels,
                              .x = tx * TILE,
                              .n = n * TILE};
    uint32_t tiles = 0;
    float eye_x[WIDTH];
    struct hf_view_eye eye = {
        .x = eye_x, .sharp = hf_layers_view_sharp(l->set.views), .point = (const float(*)[3])l->point[l->group_used]};
    for (int i = 0; i < n; i++)
        tiles |= (uint32_t)1 << (ty * COLUMNS + tx + i);
    row.planes = list_planes(b, tiles, plane, &row.far);
    for (int x = 0; x < WIDTH; x++)
        eye_x[x] = (float)(cat * (2 * fmin(b->c.x0 + x + 0.5, l->width) - l->width) * corner);
    for (int y = ty * TILE; y < (ty + 1) * TILE && !hf_stopped(l->stop); y++) {
        const int at = y * WIDTH + tx * TILE;
        for (int i = 0; i < 5; i++) {
            row.near[i] = b->near[i] + at;
            row.beyond[i] = b->beyond[i] + at;
        }
        row.y = y;
        eye.y = (float)(cat * (2 * fmin(b->c.y0 + y + 0.5, l->height) - l->height) * corner);
        eye.total = b->total + at;
        row.eye = cat > 0 ? &eye : NULL;
        b->c.k->views(&row);
    }
}

// ---- result ----

// The weight of a pixel's views, with what they leave open filled, but for what light covers (lit). *fill: the factor for what
// they see behind the focus. total: the weight of views that leave nothing open.
static float weight_of(const struct block *b, int at, float total, float lit, float *fill)
{
    const float near = b->near[4][at], far = b->beyond[4][at], hole = total * (1 - lit) - near - far;
    *fill = hole > 0 ? 1 + hole / hf_larger(far, FAINT * total) : 1;
    return near + *fill * far;
}

// Put a tile's views in the place of what slices made, as far as they count.
static void mix_tile(const struct block *b, const struct hf_cell *of, int tx, int ty, float *const out[4],
                     ptrdiff_t stride)
{
    const struct hf_layers *l = b->c.l;
    const float *top = &b->blend[ty][tx], *low = &b->blend[ty + 1][tx];
    for (int y = 0; y < TILE; y++) {
        float light[6][TILE];
        hf_layers_light_row(of, tx + (b->c.x0 - of->x0) / TILE, ty * TILE + y + b->c.y0 - of->y0,
                            (float *[]){light[0], light[1], light[2], light[3], light[4], light[5]});
        for (int x = 0; x < TILE; x++) {
            const int at = (ty * TILE + y) * WIDTH + tx * TILE + x;
            const float u = ((float)x + 0.5f) / TILE, v = ((float)y + 0.5f) / TILE;
            const float blend = (1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * low[0] + u * low[1]);
            const float total = l->key.cat_eye > 0 ? b->total[at] : 1;
            float fill;
            const float w = weight_of(b, at, total, light[4][x], &fill), rest = hf_larger(1 - light[4][x], 0);
            if (!(w > 0 && blend > 0))
                continue;
            for (int i = 0; i < l->channels; i++) {
                float *to = &out[i][y * stride + x];
                float own = rest * ((b->near[i][at] + fill * b->beyond[i][at]) / w) + light[i][x];
                if (i == 3)
                    own = fabsf(own - 1) < HF_LAYERS_OPAQUE ? 1 : own;
                *to = blend < 1 ? (1 - blend) * *to + blend * own : own;
            }
        }
    }
}

static void make_block(struct block *b, const struct hf_cell *of, float *const out[4], ptrdiff_t stride)
{
    const struct hf_layers *l = b->c.l;
    if (!find_blend(b))
        return;
    hf_layers_find_present(&b->c);
    hf_layers_mark_plain(&b->c);
    memset(b->c.source.at - (l->most_tiles * TILE + AROUND), 0, sizeof(float) * (size_t)b->c.source.row * TILE);
    make_planes(b);
    const int left = (b->c.x0 - of->x0) / TILE, top = (b->c.y0 - of->y0) / TILE;
    for (int ty = 0; ty < b->c.rows; ty++)
        for (int tx = 0; tx < b->c.columns; tx += RUN) {
            const int n = hf_min(RUN, b->c.columns - tx);
            if (is_blended(b, tx, ty) || (n > 1 && is_blended(b, tx + 1, ty)))
                make_run(b, tx, ty, n);
        }
    for (int ty = 0; ty < b->c.rows && !hf_stopped(l->stop); ty++)
        for (int tx = 0; tx < b->c.columns; tx++) {
            float *to[4] = {NULL};
            for (int i = 0; i < l->channels; i++)
                to[i] = out[i] + ty * TILE * stride + tx * TILE;
            if (is_blended(b, tx, ty) && !hf_layers_is_sharp(of, tx + left, ty + top))
                mix_tile(b, of, tx, ty, to, stride);
        }
}

void hf_layers_put_views(const struct hf_cell *c, float *memory, float *const out[4], ptrdiff_t stride)
{
    for (int ty = 0; ty < c->rows; ty += ROWS)
        for (int tx = 0; tx < c->columns && !hf_stopped(c->l->stop); tx += COLUMNS) {
            struct block b = {.c = {.l = c->l,
                                    .samples = c->samples,
                                    .k = c->k,
                                    .x0 = c->x0 + tx * TILE,
                                    .y0 = c->y0 + ty * TILE,
                                    .columns = hf_min(COLUMNS, c->columns - tx),
                                    .rows = hf_min(ROWS, c->rows - ty)}};
            float *to[4] = {NULL};
            for (int i = 0; i < c->l->channels; i++)
                to[i] = out[i] + ty * TILE * stride + tx * TILE;
            place(&b, memory);
            make_block(&b, c, to, stride);
        }
}
