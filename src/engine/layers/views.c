// SPDX-License-Identifier: BSD-3-Clause
// Views of a cell, block by block: where they are needed, and how they join the slices.
#include "engine/layers/view_block.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RUN = HF_LAYERS_VIEW_RUN };

// At a pixel some views may meet no sample and stay open. They take the mean of what other views see behind the focus,
// if at least this part of all views sees something there; with fewer, part of it is the mean of all that is seen.
// Slices have the same rule (HF_LAYERS_FAINT), but there less is open. Measured with two surfaces known and 192 views:
// with a half 43.2 dB on `fence` and 36.3 on `foliage`, with a tenth 46.2 and 36.7, with a fiftieth 46.5 and 37.0, but
// then one surface alone loses 0.06 on `foliage`.
#define FAINT (1.0f / 16)

// rim: the pixels that are made around the block on each side.
static size_t place(struct hf_view_block *b, struct hf_rect rim, float *memory)
{
    const struct hf_layers *l = b->c.l;
    struct hf_scratch m = {.memory = memory};
    b->unit = l->set.near_only;
    b->tile = TILE >> b->unit;
    b->made = (struct hf_rect){-rim.x0, -rim.y0, b->c.columns * b->tile + rim.x1, b->c.rows * b->tile + rim.y1};
    b->stride = (b->made.x1 - b->made.x0 + RUN - 1) / RUN * RUN;
    hf_layers_place_sources(&b->c, &m);
    const size_t pixels = (size_t)b->stride * (size_t)(b->made.y1 - b->made.y0);
    for (int i = 0; i < 5; i++) {
        b->near[i] = hf_layers_take(&m, pixels, 0);
        b->beyond[i] = hf_layers_take(&m, pixels, 0);
    }
    b->total = hf_layers_take(&m, pixels, 0);
    b->across = hf_layers_take(&m, (size_t)b->stride + 16, 16);
    hf_layers_place_planes(b, &m);
    return m.used;
}

// The tiles of a block for which views are made at once. Planes of the frame's pixels are large.
static void size_block(const struct hf_layers *l, int columns, int rows, int *wide, int *high)
{
    *wide = hf_min(columns, l->set.near_only ? 20 : 8);
    *high = hf_min(rows, l->set.near_only ? HF_LAYERS_BLOCK_ROWS : 4);
}

size_t hf_layers_views_floats(const struct hf_layers *l, int columns, int rows)
{
    struct hf_view_block b = {.c = {.l = l}};
    if (!(l->set.views && l->levels))
        return 0;
    size_block(l, columns, rows, &b.c.columns, &b.c.rows);
    return place(&b, (struct hf_rect){1, 1, 1, 1}, NULL);
}

// ---- where ----

// Whether light of a tile comes to another one, dx and dy tiles away: 1 or 0, and between them a part.
static float near_to(const struct hf_layers_crossing *t, float wide, int dx, int dy)
{
    const int between = hf_max(hf_max(abs(dx), abs(dy)) - 1, 0);
    return hf_saturate((t->reach * wide - (float)(between * TILE)) * (1.0f / TILE) + 1);
}

// How far views count in a tile: fully where something is hidden whose light may come there. The near stack asks only the tiles
// beside it what is hidden: 34.31 dB on `foliage`, 34.41 with all that reach it, for twice the time.
static float much_at(const struct hf_layers *l, int column, int row, int n)
{
    const float wide = (float)hf_layers_view_width(l);
    float much = 0;
    for (int y = hf_max(row - n, 0); y < hf_min(row + n + 1, l->rows); y++)
        for (int x = hf_max(column - n, 0); x < hf_min(column + n + 1, l->columns); x++) {
            const struct hf_layers_crossing *t = &l->crossing[y * l->columns + x];
            if (t->much > much)
                much = hf_larger(l->set.near_only ? t->much : t->much * near_to(t, wide, x - column, y - row), much);
        }
    return much;
}

// How far no light comes to a tile from radii too large for views.
static float small_at(const struct hf_layers *l, int column, int row, int n)
{
    const float wide = (float)hf_layers_view_width(l), large = hf_layers_view_most(l);
    float small = 1;
    for (int y = hf_max(row - n, 0); y < hf_min(row + n + 1, l->rows); y++)
        for (int x = hf_max(column - n, 0); x < hf_min(column + n + 1, l->columns); x++) {
            const struct hf_layers_crossing *t = &l->crossing[y * l->columns + x];
            const float over = hf_saturate((t->reach * wide - 0.75f * large) * (4 / large));
            if (over > 0)
                small = fminf(1 - near_to(t, wide, x - column, y - row) * over, small);
        }
    return small;
}

static float blend_at(const struct hf_layers *l, int column, int row)
{
    const int near_only = l->set.near_only;
    const float most = (near_only ? -l->nearest : hf_larger(-l->nearest, l->farthest)) * (float)hf_layers_view_width(l);
    const int n = (int)fminf(most, 65536) / TILE + 2;
    const float much = much_at(l, column, row, near_only ? 1 : n);
    return much > 0 ? much * small_at(l, column, row, n) : 0;
}

int hf_layers_find_views(struct hf_cell *c)
{
    const struct hf_layers *l = c->l;
    const int column = c->x0 / TILE, row = c->y0 / TILE;
    int any = 0;
    for (int i = 0; i < c->corners * (c->rows + 3); i++)
        c->blend[i - c->corners - 1] = 0;
    // A corner has the most of its four tiles.
    for (int ty = -2; ty <= c->rows + 1; ty++)
        for (int tx = -2; tx <= c->columns + 1; tx++) {
            const float much =
                blend_at(l, hf_min(hf_max(column + tx, 0), l->columns - 1), hf_min(hf_max(row + ty, 0), l->rows - 1));
            any |= much > 0;
            for (int y = hf_max(ty, -1); y <= hf_min(ty + 1, c->rows + 1); y++)
                for (int x = hf_max(tx, -1); x <= hf_min(tx + 1, c->columns + 1); x++) {
                    float *at = &c->blend[y * c->corners + x];
                    *at = hf_larger(much, *at);
                }
        }
    // The slices of a tile are upsampled with a pixel of the tiles around it.
    for (int ty = -1; ty <= c->rows; ty++)
        for (int tx = -1; tx <= c->columns; tx++) {
            int whole = l->set.near_only;
            for (int y = hf_max(ty - 1, -1); y <= hf_min(ty + 2, c->rows + 1); y++)
                for (int x = hf_max(tx - 1, -1); x <= hf_min(tx + 2, c->columns + 1); x++)
                    whole &= c->blend[y * c->corners + x] >= 1;
            *hf_layers_map_at(&c->seen_by_views, tx, ty) = (uint8_t)whole;
        }
    return any;
}

// Whether the slice's blur shows a tile's samples anywhere.
static int is_shown(const struct hf_cell *c, int by, int tx, int ty)
{
    for (int y = hf_max(ty - by, -1); y <= hf_min(ty + by, c->rows); y++)
        for (int x = hf_max(tx - by, -1); x <= hf_min(tx + by, c->columns); x++)
            if (*hf_layers_map_at(&c->touched, x, y))
                return 1;
    return 0;
}

int hf_layers_leave_to_views(struct hf_cell *c, const struct hf_slice *s)
{
    const int by = hf_layers_blur_tiles(s);
    int left = 0;
    if (!hf_layers_views_are_near(c))
        return 1;
    for (int ty = -1; ty <= c->rows; ty++)
        for (int tx = -1; tx <= c->columns; tx++) {
            uint8_t *touched = hf_layers_map_at(&c->touched, tx, ty);
            const uint8_t seen = *hf_layers_map_at(&c->seen_by_views, tx, ty);
            *hf_layers_map_at(&c->left, tx, ty) = *touched & seen;
            *touched &= !seen;
            left |= *touched;
        }
    for (int ty = c->box.y0; left && ty < c->box.y1; ty++)
        for (int tx = c->box.x0; tx < c->box.x1; tx++)
            if (*hf_layers_map_at(&c->used, tx, ty) && !is_shown(c, by, tx, ty))
                *hf_layers_map_at(&c->used, tx, ty) = 0;
    return left;
}

static int is_blended(const struct hf_cell *c, struct hf_rect tiles)
{
    for (int y = tiles.y0; y <= tiles.y1; y++)
        for (int x = tiles.x0; x <= tiles.x1; x++)
            if (c->blend[y * c->corners + x] > 0)
                return 1;
    return 0;
}

// How far views count at a pixel of a tile.
static float blend_in(const struct hf_view_block *b, int tx, int ty, int x, int y)
{
    const float *top = &b->c.blend[ty * b->c.corners + tx], *low = top + b->c.corners;
    const float u = ((float)x + 0.5f) / (float)b->tile, v = ((float)y + 0.5f) / (float)b->tile;
    return (1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * low[0] + u * low[1]);
}

// ---- rows ----

static ptrdiff_t pixel_at(const struct hf_view_block *b, int x, int y)
{
    return (y - b->made.y0) * b->stride + x - b->made.x0;
}

// The number of the tile that holds pixel i.
static int tile_of(int i, int tile)
{
    return i < 0 ? -1 : i / tile;
}

// Where a pixel lies for a cat's eye: its distance from the middle of the frame, `size` pixels wide or high.
static float eye_at(const struct hf_view_block *b, int first, int i, int size)
{
    const struct hf_layers *l = b->c.l;
    const double at = first + (i + 0.5) * (1 << b->unit);
    return (float)((double)l->key.cat_eye * (2 * fmin(at, size) - size) / hypot(l->width, l->height));
}

// Make the views of pixels x to x + n in rows y0 to y1.
static void make_run(const struct hf_view_block *b, int x, int n, int y0, int y1)
{
    const struct hf_layers *l = b->c.l;
    const struct hf_rect tiles = {tile_of(x, b->tile), tile_of(y0, b->tile),
                                  tile_of(hf_min(x + n, b->made.x1) - 1, b->tile) + 1, tile_of(y1 - 1, b->tile) + 1};
    if (!is_blended(&b->c, tiles))
        return;
    struct hf_view_row row = {.plane = b->list,
                              .views = l->set.views,
                              .one = 1 / (float)l->set.views,
                              .channels = l->channels,
                              .part = l->view_part,
                              .x = x,
                              .n = n};
    struct hf_view_eye eye = {.x = b->across,
                              .sharp = hf_layers_view_sharp(l->set.views),
                              .point = (const float(*)[3])l->point[l->group_used]};
    row.planes = hf_layers_list_planes(b, tiles, b->list, &row.far);
    for (int y = y0; y < y1 && !hf_stopped(l->stop); y++) {
        const ptrdiff_t at = pixel_at(b, x, y);
        for (int i = 0; i < 5; i++) {
            row.near[i] = b->near[i] + at;
            row.beyond[i] = b->beyond[i] + at;
        }
        row.y = y;
        eye.y = eye_at(b, b->c.y0, y, l->height);
        eye.total = b->total + at;
        row.eye = l->key.cat_eye > 0 ? &eye : NULL;
        b->c.k->views(&row);
    }
}

// ---- result ----

// The weight of a pixel's views, with what they leave open filled, but for what light covers (lit). *fill: the factor for what
// they see behind the focus. total: the weight of views that leave nothing open.
static float weight_of(const struct hf_view_block *b, ptrdiff_t at, float total, float lit, float *fill)
{
    const float near = b->near[4][at], far = b->beyond[4][at], hole = total * (1 - lit) - near - far;
    *fill = hole > 0 ? 1 + hole / hf_larger(far, FAINT * total) : 1;
    return near + *fill * far;
}

// The weight of views that leave nothing open at a pixel.
static float total_at(const struct hf_view_block *b, ptrdiff_t at)
{
    return b->c.l->key.cat_eye > 0 ? b->total[at] : 1;
}

// Blend what views see into what slices made. Where slices left all to views, their memory may hold anything: it is not used.
static float mixed(float own, float seen, float blend)
{
    return blend < 1 ? (1 - blend) * own + blend * seen : seen;
}

// Put a tile's views in the place of what slices made, as far as they count.
static void mix_tile(const struct hf_view_block *b, const struct hf_cell *of, int tx, int ty, float *const out[4],
                     ptrdiff_t stride)
{
    const struct hf_layers *l = b->c.l;
    const int at_x = tx + (b->c.x0 - of->x0) / TILE;
    for (int y = 0; y < TILE; y++) {
        float light[6][TILE];
        hf_layers_light_row(of, at_x, at_x + 1, ty * TILE + y + b->c.y0 - of->y0,
                            (float *[]){light[0], light[1], light[2], light[3], light[4], light[5]});
        for (int x = 0; x < TILE; x++) {
            const ptrdiff_t at = pixel_at(b, tx * TILE + x, ty * TILE + y);
            const float blend = blend_in(b, tx, ty, x, y), total = total_at(b, at);
            float fill;
            const float w = weight_of(b, at, total, light[4][x], &fill), rest = hf_larger(1 - light[4][x], 0);
            if (!(w > 0 && blend > 0))
                continue;
            for (int i = 0; i < l->channels; i++) {
                float own = rest * ((b->near[i][at] + fill * b->beyond[i][at]) / w) + light[i][x];
                if (i == 3)
                    own = fabsf(own - 1) < HF_LAYERS_OPAQUE ? 1 : own;
                float *to = &out[i][y * stride + x];
                *to = mixed(*to, own, blend);
            }
        }
    }
}

// The same for the whole block.
static void mix_block(const struct hf_view_block *b, const struct hf_cell *of, float *const out[4], ptrdiff_t stride)
{
    for (int ty = 0; ty < b->c.rows && !hf_stopped(b->c.l->stop); ty++)
        for (int tx = 0; tx < b->c.columns; tx++) {
            float *to[4] = {NULL};
            for (int i = 0; i < b->c.l->channels; i++)
                to[i] = out[i] + ty * TILE * stride + tx * TILE;
            if (is_blended(&b->c, (struct hf_rect){tx, ty, tx + 1, ty + 1}) &&
                !hf_layers_is_sharp(of, tx + (b->c.x0 - of->x0) / TILE, ty + (b->c.y0 - of->y0) / TILE))
                mix_tile(b, of, tx, ty, to, stride);
        }
}

// Put a row of values, each divided by its pixel's total, in the place of what the near stack holds. value NULL: ones.
static void put_row(float *restrict to, const float *restrict value, const float *restrict total,
                    const float *restrict blend, int n)
{
    for (int x = 0; x < n; x++) {
        const float v = mixed(to[x], value ? value[x] / total[x] : 1, blend[x]);
        to[x] = blend[x] > 0 && total[x] > 0 ? v : to[x];
    }
}

// Put what views see in the place of what the near stack holds, as far as they count: in row y of a tile.
static void mix_near_row(const struct hf_view_block *b, const struct hf_cell *of, int tx, int ty, int y)
{
    const struct hf_layers *l = b->c.l;
    const struct hf_stack_row r = hf_layers_stack_at(of, NEAR, (b->c.x0 - of->x0) / 2, (b->c.y0 - of->y0) / 2 + y);
    const int x0 = hf_max(tx * b->tile, b->made.x0), n = hf_min((tx + 1) * b->tile, b->made.x1) - x0;
    const ptrdiff_t at = pixel_at(b, x0, y);
    float blend[TILE], total[TILE];
    for (int i = 0; i < n; i++) {
        blend[i] = blend_in(b, tx, ty, x0 + i - tx * b->tile, y - ty * b->tile);
        total[i] = total_at(b, at + i);
    }
    for (int i = 0; i < l->channels; i++)
        put_row(r.colour[i] + x0, b->near[i] + at, total, blend, n);
    put_row(r.weight + x0, b->near[4] + at, total, blend, n);
    put_row(r.behind + x0, NULL, total, blend, n);
}

static void mix_near(const struct hf_view_block *b, const struct hf_cell *of)
{
    for (int y = b->made.y0; y < b->made.y1; y++) {
        const int ty = tile_of(y, b->tile);
        for (int tx = tile_of(b->made.x0, b->tile); tx <= tile_of(b->made.x1 - 1, b->tile); tx++)
            if (b->blended[ty + 1] >> (tx + 1) & 1)
                mix_near_row(b, of, tx, ty, y);
    }
}

static int make_block(struct hf_view_block *b)
{
    const struct hf_layers *l = b->c.l;
    if (!is_blended(&b->c,
                    (struct hf_rect){tile_of(b->made.x0, b->tile), tile_of(b->made.y0, b->tile),
                                     tile_of(b->made.x1 - 1, b->tile) + 1, tile_of(b->made.y1 - 1, b->tile) + 1}))
        return 0;
    for (int ty = -1; ty <= b->c.rows; ty++) {
        uint64_t row = 0;
        for (int tx = -1; tx <= b->c.columns; tx++)
            row |= (uint64_t)is_blended(&b->c, (struct hf_rect){tx, ty, tx + 1, ty + 1}) << (tx + 1);
        b->blended[ty + 1] = row;
    }
    hf_layers_find_present(&b->c);
    hf_layers_mark_plain(&b->c);
    memset(b->c.source.at - (l->most_tiles * TILE + AROUND), 0, sizeof(float) * (size_t)b->c.source.row * TILE);
    hf_layers_make_planes(b);
    for (int i = 0; i < b->stride; i++)
        b->across[b->made.x0 + i] = eye_at(b, b->c.x0, b->made.x0 + i, l->width);
    for (int y = b->made.y0, next; y < b->made.y1; y = next) {
        next = hf_min((tile_of(y, b->tile) + 1) * b->tile, b->made.y1);
        for (int x = b->made.x0; x < b->made.x1; x += RUN)
            make_run(b, x, hf_min(RUN, (b->made.x1 - x + 15) & ~15), y, next);
    }
    return !hf_stopped(l->stop);
}

// The pixels that the near stack has around a cell (MARGIN) are made with the blocks beside them.
static struct hf_rect rim_of(const struct hf_cell *c, const struct hf_view_block *b)
{
    const int x = (b->c.x0 - c->x0) / TILE, y = (b->c.y0 - c->y0) / TILE;
    return c->l->set.near_only
               ? (struct hf_rect){x == 0, y == 0, x + b->c.columns == c->columns, y + b->c.rows == c->rows}
               : (struct hf_rect){0, 0, 0, 0};
}

// The tiles of a cell where views of the near stack count, there or in the pixels around the cell.
static struct hf_rect near_tiles(const struct hf_cell *c)
{
    struct hf_rect r = {c->columns, c->rows, 0, 0};
    for (int ty = -1; ty <= c->rows; ty++)
        for (int tx = -1; tx <= c->columns; tx++) {
            if (is_blended(c, (struct hf_rect){tx, ty, tx + 1, ty + 1})) {
                const int x = hf_layers_within(tx, 0, c->columns - 1), y = hf_layers_within(ty, 0, c->rows - 1);
                r = (struct hf_rect){hf_min(r.x0, x), hf_min(r.y0, y), hf_max(r.x1, x + 1), hf_max(r.y1, y + 1)};
            }
        }
    return r;
}

void hf_layers_put_views(const struct hf_cell *c, float *memory, float *const out[4], ptrdiff_t stride)
{
    const struct hf_layers *l = c->l;
    int wide, high;
    size_block(l, c->columns, c->rows, &wide, &high);
    const struct hf_rect r = l->set.near_only ? near_tiles(c) : (struct hf_rect){0, 0, c->columns, c->rows};
    for (int ty = r.y0; ty < r.y1; ty += high)
        for (int tx = r.x0; tx < r.x1 && !hf_stopped(l->stop); tx += wide) {
            struct hf_view_block b = {.c = {.l = l,
                                            .samples = c->samples,
                                            .k = c->k,
                                            .x0 = c->x0 + tx * TILE,
                                            .y0 = c->y0 + ty * TILE,
                                            .columns = hf_min(wide, r.x1 - tx),
                                            .rows = hf_min(high, r.y1 - ty),
                                            .blend = c->blend + ty * c->corners + tx,
                                            .corners = c->corners}};
            place(&b, rim_of(c, &b), memory);
            if (!make_block(&b))
                continue;
            float *to[4] = {NULL};
            for (int i = 0; !l->set.near_only && i < l->channels; i++)
                to[i] = out[i] + ty * TILE * stride + tx * TILE;
            if (l->set.near_only)
                mix_near(&b, c);
            else
                mix_block(&b, c, to, stride);
        }
}
