// SPDX-License-Identifier: BSD-3-Clause
// One cell of the result, slice by slice from front to back.
#include <string.h>

#include "engine/layers/parts.h"
#include "engine/layers/views.h"

float *hf_layers_take(struct hf_scratch *m, size_t n, ptrdiff_t at)
{
    float *p = m->memory ? m->memory + m->used + at : NULL;
    m->used += (n + 15) & ~(size_t)15;
    return p;
}

static struct hf_window take_window(struct hf_scratch *m, int width, int height, int channels)
{
    struct hf_window w = {.channel = LEFT + width + RIGHT};
    w.row = w.channel * channels;
    w.at = hf_layers_take(m, (size_t)w.row * (size_t)(height + 2 * MARGIN), MARGIN * w.row + LEFT);
    return w;
}

static struct hf_tile_map take_map(struct hf_scratch *m, int columns, int rows, int around)
{
    struct hf_tile_map map = {.stride = columns + 2 * around};
    const size_t n = (size_t)map.stride * (size_t)(rows + 2 * around) + 7;  // see hf_layers_next_run()
    uint8_t *start = (uint8_t *)hf_layers_take(m, (n + sizeof(float) - 1) / sizeof(float), 0);
    map.at = start ? start + around * map.stride + around : NULL;
    return map;
}

void hf_layers_place_sources(struct hf_cell *c, struct hf_scratch *m)
{
    const int width = c->columns * TILE, channels = c->l->channels, n = c->l->most_tiles;
    const int wide = width + 2 * n * TILE + 2 * AROUND;
    const size_t words = (size_t)(4 * c->l->words + c->l->share_words);
    c->present = (uint64_t *)hf_layers_take(m, 2 * words * (size_t)(c->rows + 2 * n), 0);
    c->used = take_map(m, c->columns, c->rows, n);
    c->plain = take_map(m, c->columns, c->rows, n);
    c->filled = take_map(m, c->columns, TILE / 2, n);
    c->touched = take_map(m, c->columns, c->rows, 1);
    c->source.channel = wide;
    c->source.row = (ptrdiff_t)wide * (channels + 1);
    c->source.at = hf_layers_take(m, (size_t)c->source.row * TILE, n * TILE + AROUND);
    c->any = (uint8_t *)hf_layers_take(m, (size_t)wide / 16 / sizeof(float) + 1, 0);
    for (int i = 0; i < 6; i++)
        c->line[i] = hf_layers_take(m, (size_t)wide, 0);
}

// Place what highlights take.
static void place_lights(struct hf_cell *c, struct hf_scratch *m)
{
    const int width = c->columns * TILE, height = c->rows * TILE;
    if (!c->l->set.highlights)
        return;
    c->shone = take_map(m, c->columns, c->rows, 1);
    c->shine = take_window(m, width, height, c->l->channels + 1);
    for (int i = 0; i < 2; i++)
        c->light[i] = take_window(m, width, height, c->l->channels + 2);
    c->passed = take_map(m, c->columns, c->rows, c->l->most_tiles);
    c->cut_off = hf_layers_take(m, hf_layers_cut_floats(c), 0);
    c->cover = hf_layers_take(m, hf_layers_cover_floats(c), 0);
}

// Place a cell's scratch in memory; returns how many floats it takes.
static size_t place(struct hf_cell *c, float *memory)
{
    struct hf_scratch m = {.memory = memory};
    const int width = c->columns * TILE, height = c->rows * TILE, channels = c->l->channels;
    hf_layers_place_sources(c, &m);
    c->shape = hf_layers_take(&m, hf_layers_shape_floats(c->l, c->columns, c->rows), 0);
    place_lights(c, &m);
    c->corners = c->columns + 3;
    c->blend = hf_layers_take(&m, (size_t)c->corners * (size_t)(c->rows + 3), c->corners + 1);
    c->seen_by_views = take_map(&m, c->columns, c->rows, 1);
    c->left = take_map(&m, c->columns, c->rows, 1);
    c->fresh = take_map(&m, c->columns, c->rows, 1);
    struct hf_tile_map *const maps[] = {&c->near, &c->far, &c->middle, &c->begun, &c->lit[0], &c->lit[1], &c->covered};
    for (int i = 0; i < 7; i++)
        *maps[i] = take_map(&m, c->columns, c->rows, 1);
    for (int i = 0; i <= HF_LAYERS_COARSEST; i++)
        c->clean[i] = take_map(&m, c->columns, c->rows, 1);
    for (int i = 0; i <= HF_LAYERS_COARSEST; i++)
        c->sum[i] = take_window(&m, width >> i, height >> i, channels + 1);
    for (int i = 0; i < 3; i++)
        c->stack[i] = take_window(&m, i == MIDDLE ? width : width / 2, i == MIDDLE ? height : height / 2,
                                  channels + (i == MIDDLE ? 4 : 3));
    const struct hf_window lift = take_window(&m, width / 2, height / 2, 1);
    c->lift = lift.at;
    c->lift_row = lift.row;
    c->none = hf_layers_take(&m, (size_t)width + AROUND, 0);
    c->whole = hf_layers_take(&m, (size_t)width + AROUND, 0);
    for (int i = 0; i < 5; i++)
        c->row[i] = hf_layers_take(&m, (size_t)width + AROUND, 0);
    for (int i = 0; i < 6; i++)
        c->light_row[i] = hf_layers_take(&m, (size_t)width + AROUND, 0);
    return m.used;
}

size_t hf_layers_cell_floats(const struct hf_layers *l, int width, int height)
{
    struct hf_cell c = {.l = l, .columns = width / TILE, .rows = height / TILE};
    return place(&c, NULL) + hf_layers_views_floats(l, c.columns, c.rows);
}

void hf_layers_cell(const struct hf_layers *l, const struct hf_samples *samples, const struct hf_layers_kernels *k,
                    struct hf_rect r, float *memory, float *const out[4], ptrdiff_t stride)
{
    struct hf_cell c = {.l = l,
                        .samples = samples,
                        .k = k,
                        .x0 = r.x0,
                        .y0 = r.y0,
                        .columns = (r.x1 - r.x0) / TILE,
                        .rows = (r.y1 - r.y0) / TILE};
    float *rest = memory + place(&c, memory);
    c.views = l->set.views && l->levels && hf_layers_find_views(&c);
    hf_layers_find_present(&c);
    hf_layers_mark_plain(&c);
    memset(c.source.at - (l->most_tiles * TILE + AROUND), 0, sizeof(float) * (size_t)c.source.row * TILE);
    struct hf_tile_map *const maps[] = {&c.near,    &c.far,      &c.middle,   &c.begun,    &c.lit[0],  &c.lit[1],
                                        &c.covered, &c.clean[0], &c.clean[1], &c.clean[2], &c.clean[3]};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        for (int ty = -1; ty <= c.rows; ty++)
            memset(hf_layers_map_at(maps[i], -1, ty), 0, (size_t)c.columns + 2);
    int i = 0;
    memset(c.none, 0, sizeof(float) * (size_t)(c.columns * TILE + AROUND));
    for (int x = 0; x < c.columns * TILE; x++)
        c.whole[x] = 1;
    while (i < l->slices && l->slice[i].level > 0 && l->slice[i].radius < 0 && !hf_stopped(l->stop))
        hf_layers_put_slice(&c, i++);
    hf_layers_draw_lights(&c, NEAR);
    if (hf_layers_views_are_near(&c) && c.opened[NEAR])
        hf_layers_put_views(&c, rest, out, stride);
    hf_layers_begin_middle(&c);
    for (; i < l->slices && !hf_stopped(l->stop); i++) {
        hf_layers_put_slice(&c, i);
        if (i == l->last)
            hf_layers_cover(&c);
    }
    hf_layers_draw_lights(&c, FAR);
    if (!hf_stopped(l->stop))
        hf_layers_finish_cell(&c, out, stride);
    if (c.views && !l->set.near_only)
        hf_layers_put_views(&c, rest, out, stride);
}
