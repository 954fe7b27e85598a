// SPDX-License-Identifier: BSD-3-Clause
// One slice of a cell: gather its sources, and draw their discs.
#include <string.h>

#include "engine/layers/parts.h"

void hf_layers_clear_tiles(const struct hf_cell *c, const struct hf_tile_map *m, const struct hf_window *w, int level,
                           int first, int channels)
{
    const int margin = level ? MARGIN : 0, height = c->rows * (TILE >> level), around = level ? 2 : 0;
    for (int ty = -1; ty <= c->rows && !hf_stopped(c->l->stop); ty++)
        for (struct hf_span s = {.tx = -1}; hf_layers_next_span(c, m, level, ty, &s);) {
            const int x0 = s.x0 - 16 > -LEFT ? s.x0 - 16 : -LEFT;
            // When a coarse level is refined, partial vectors read farther.
            const int more = level > 2 ? 32 : 16;
            const int right = (c->columns * (TILE >> level)) + RIGHT, x1 = s.x1 + more < right ? s.x1 + more : right;
            int y0, y1;
            hf_layers_clip_rows(c, level, ty, &y0, &y1);
            y0 = y0 - around > -margin ? y0 - around : -margin;
            y1 = y1 + around < height + margin ? y1 + around : height + margin;
            for (int y = y0; y < y1; y++)
                for (int i = first; i < channels; i++)
                    memset(w->at + y * w->row + i * w->channel + x0, 0, sizeof(float) * (size_t)(x1 - x0));
        }
}

void hf_layers_planes_at(const struct hf_layers *l, const struct hf_layers_set *set, const float *weight, int x, int y,
                         const float *in[6])
{
    const ptrdiff_t at = (ptrdiff_t)y * set->stride + x;
    for (int i = 0; i < l->channels; i++)
        in[i] = set->colour[i] + at;
    in[4] = weight + at;
    in[5] = set->radius + at;
}

// Where a channel's row of sources begins; channel `channels` is the weight.
static float *source_at(const struct hf_cell *c, int i, int x, int y)
{
    return c->source.at + y * c->source.row + i * c->source.channel + x;
}

// Turn a row of quads' samples into a row of pixels' samples: each pixel gets the part that lies before the quad's
// sample.
static void spread(const struct hf_cell *c, const struct hf_layers_set *set, int px, int py, int n, const float *in[6])
{
    const struct hf_layers_set *before[2] = {&c->samples->seen, &c->samples->mixed};
    const float *of[6] = {NULL}, *radius[4], *weight[4];
    hf_layers_planes_at(c->l, set, set->weight, px >> 1, py >> 1, of);
    for (int i = 0; i < 4; i++) {
        weight[i] = hf_layers_at(before[i / 2], before[i / 2]->weight, px, (py & ~1) + i % 2);
        radius[i] = hf_layers_at(before[i / 2], before[i / 2]->radius, px, (py & ~1) + i % 2);
    }
    c->k->spread(of, radius, weight, py & 1, c->l->channels, n / 2, c->line);
    for (int i = 0; i < 6; i++)
        in[i] = c->line[i];
}

// How many channels of colour are built.
static int colours(const struct hf_cell *c, const struct hf_build *b)
{
    return b->first ? 0 : c->l->channels;
}

// Weigh visible samples, one run of tiles with equal `plain` bits at a time: weights that are all 1 and shares that are
// all 0 are not read.
static void weigh_seen(const struct hf_cell *c, const struct hf_build *b, int tx, int end, int ty, int px, int py,
                       float *const out[5])
{
    const ptrdiff_t stride = b->set->stride;
    for (int from = tx, to; from < end; from = to) {
        const int plain = *hf_layers_map_at(&c->plain, from, ty), lead = (from - tx) * TILE;
        const float *in[6] = {NULL}, *share = b->share ? b->share + (ptrdiff_t)py * stride + px + lead : NULL;
        float *part[5];
        for (to = from + 1; to < end && *hf_layers_map_at(&c->plain, to, ty) == plain;)
            to++;
        for (int i = 0; i < 5; i++)
            part[i] = out[i] + lead;
        hf_layers_planes_at(c->l, b->set, b->weight, px + lead, py, in);
        in[4] = plain & WHOLE ? NULL : in[4];
        c->k->weigh(b->s, in, plain & DULL ? NULL : share, stride, 1 << b->s->level, colours(c, b), (to - from) * TILE,
                    0, part, c->any + lead / 16);
    }
}

// Weigh the samples of one row of a run of tiles; (px, py) is the first of them. c->any[i] becomes nonzero if one of
// the samples 16 i to 16 i + 15 has a weight.
static void weigh_run(const struct hf_cell *c, const struct hf_build *b, int tx, int end, int ty, int px, int py,
                      float *const out[5])
{
    const struct hf_layers *l = c->l;
    const int size = TILE >> b->finest, n = (end - tx) * size, rows = 1 << (b->s->level - b->finest);
    const float *in[6] = {NULL};
    if (b->spread)
        spread(c, b->set, px, py, n, in);
    else
        hf_layers_planes_at(l, b->set, b->weight, px, py, in);
    if (b->weight == c->samples->seen.weight)
        weigh_seen(c, b, tx, end, ty, px, py, out);
    else
        c->k->weigh(b->s, in, NULL, b->set->stride, rows, colours(c, b), n, 0, out, c->any);
    for (int from = tx, to; b->more && (to = hf_layers_next_run(&c->used, &from, ty, end, MORE)) > from; from = to) {
        // c->any counts from the start of the run in steps of 16 samples, so an 8-sample tile without these may come
        // first.
        const int lead = (from - tx) * size & ~15, at = px + lead, count = (to - tx) * size - lead;
        float *more[5];
        for (int i = 0; i < 5; i++)
            more[i] = out[i] + lead;
        if (b->spread)
            spread(c, b->more, at, py, count, in);
        else
            hf_layers_planes_at(l, b->more, b->more->weight, at, py, in);
        c->k->weigh(b->s, in, NULL, b->more->stride, rows, colours(c, b), count, 1, more, c->any + lead / 16);
    }
}

// Make the sources of row y of a run of tiles, and note where there are any. Their samples are those of tile row
// `from`.
static void build_run(const struct hf_cell *c, const struct hf_build *b, int tx, int end, int ty, int from, int y)
{
    const struct hf_layers *l = c->l;
    const int level = b->s->level - b->finest, size = TILE >> b->finest, n = (end - tx) * size;
    const int px = (c->x0 >> b->finest) + tx * size, py = (c->y0 >> b->finest) + from * size + (y << level);
    float *const to = source_at(c, 0, tx * (TILE >> b->s->level), y), *out[5];
    int some = 0;
    for (int i = 0; i < n; i += 128)
        memset(c->any + i / 16, 0, 8);  // one store, perhaps past the run's last byte but never past c->any
    for (int i = 0; i < 5; i++)
        out[i] = level ? c->line[i] : to + (i < 4 ? i : l->channels) * c->source.channel;
    weigh_run(c, b, tx, end, ty, px, py, out);
    for (int i = tx; i < end; i++) {
        const int any = c->any[(i - tx) * size / 16];
        *hf_layers_map_at(&c->filled, i, y / 2) |= (uint8_t)any;
        some |= any;
    }
    for (int i = b->first; some && level && i < b->channels; i++) {
        float *line = out[i < l->channels ? i : 4];
        for (int j = level; j > 0; j--)
            c->k->fold(line, n >> (level - j + 1), j > 1 ? line : to + i * c->source.channel);
    }
}

// Fill tiles beyond the frame with tile `like`: each of its rows has one colour.
static void repeat_tile(const struct hf_cell *c, const struct hf_build *b, int like, int tx, int end, int y)
{
    const int size = TILE >> b->s->level;
    if (tx >= end)
        return;
    const uint8_t any = *hf_layers_map_at(&c->filled, like, y / 2);
    for (int i = tx; i < end; i++)
        *hf_layers_map_at(&c->filled, i, y / 2) |= any;
    for (int i = b->first; any && i < b->channels; i++) {
        const float v = *source_at(c, i, like * size, y);
        float *to = source_at(c, i, tx * size, y);
        for (int x = 0; x < (end - tx) * size; x++)
            to[x] = v;
    }
}

// Clear row y of tile `like` again, whose samples were built only to be repeated in the tiles from tx on.
static void drop_tile(const struct hf_cell *c, const struct hf_build *b, int like, int tx, int y)
{
    const int size = TILE >> b->s->level, n = tx > like ? hf_min((tx - like) * size, size + 16) : size;
    for (int i = b->first; i < b->channels; i++)
        memset(source_at(c, i, like * size, y), 0, sizeof(float) * (size_t)n);
}

// Clear what of row y of a square's tile is not in the square.
static void keep_square(const struct hf_cell *c, const struct hf_build *b, int y)
{
    const struct hf_layers_square *s = b->square;
    const int apart = TILE - HF_LAYERS_SQUARE, inside = y >= s->dy && y < s->dy + HF_LAYERS_SQUARE;
    for (int i = b->first; i < b->channels; i++)
        if (inside)
            memset(source_at(c, i, s->tx * TILE + apart - s->dx, y), 0, sizeof(float) * HF_LAYERS_SQUARE);
        else
            memset(source_at(c, i, s->tx * TILE, y), 0, sizeof(float) * TILE);
    if (!inside)
        *hf_layers_map_at(&c->filled, s->tx, y / 2) = 0;
}

static void build_row(const struct hf_cell *c, const struct hf_build *b, int ty, int from, int y0, int y1)
{
    const int size = TILE >> b->s->level;
    const struct hf_rect with = hf_layers_tiles_with_samples(c);
    for (int i = 0; i < size / 2; i++)
        memset(hf_layers_map_at(&c->filled, c->box.x0, i), 0, (size_t)(c->box.x1 - c->box.x0));
    for (int tx = c->box.x0, end; (end = hf_layers_next_run(&c->used, &tx, ty, c->box.x1, ~0)) > tx; tx = end) {
        const int first = hf_layers_within(tx, with.x0, with.x1), last = hf_layers_within(end - 1, with.x0, with.x1);
        // The run may lie beyond the last tile that has samples, on one side of the frame.
        const int beyond = first >= end || last < tx;
        for (int y = y0; y < y1; y++) {
            if (beyond)
                *hf_layers_map_at(&c->filled, first, y / 2) = 0;
            build_run(c, b, first, last + 1, ty, from, y);
            repeat_tile(c, b, first, tx, hf_min(first, end), y);
            repeat_tile(c, b, last, hf_max(last + 1, tx), end, y);
            if (beyond)
                drop_tile(c, b, first, tx, y);
            if (b->square)
                keep_square(c, b, y);
        }
    }
}

// Also clears what vectors wrote past the last tile.
static void clear_row(const struct hf_cell *c, const struct hf_build *b, int y0, int y1)
{
    const int size = TILE >> b->s->level;
    for (int y = y0; y < y1; y += 2)
        for (int tx = c->box.x0, end; (end = hf_layers_next_run(&c->filled, &tx, y / 2, c->box.x1, ~0)) > tx; tx = end)
            for (int i = 0; i <= 2 * c->l->channels + 1; i++)
                memset(source_at(c, i / 2, tx * size, y + i % 2), 0, sizeof(float) * (size_t)((end - tx) * size + 16));
}

// Draw columns x0 to x1 of two rows of sources in a row of tiles.
static void draw_span(const struct hf_cell *c, const struct hf_build *b, int at, int y, int x0, int x1,
                      const struct hf_window *to)
{
    const struct hf_slice *s = b->s;
    const int margin = s->level ? MARGIN : 0, height = c->rows * (TILE >> s->level);
    for (int i = 0; s->shape && i < 2; i++)
        hf_layers_draw_shape(c, b, source_at(c, 0, x0, y + i), at + i, x0, x1, to);
    const struct hf_layers_sources rows = {.upper = source_at(c, b->first, x0, y),
                                           .lower = source_at(c, b->first, x0, y + 1),
                                           .plane = c->source.channel,
                                           .planes = b->channels - b->first,
                                           .n = x1 - x0,
                                           .from = -margin - at,
                                           .to = height + margin - at,
                                           .out = to->at + at * to->row + b->first * to->channel + x0,
                                           .out_plane = to->channel,
                                           .stride = to->row};
    if (!s->shape)
        c->k->disc(s, &rows);
}

// Draw two rows of sources of a row of tiles. Spans are aligned to vectors; between two spans all sources are 0.
static void draw_pair(const struct hf_cell *c, const struct hf_build *b, int ty, int y, const struct hf_window *to)
{
    const struct hf_slice *s = b->s;
    const int size = TILE >> s->level, margin = s->level ? MARGIN : 0;
    const int last = c->columns * size + margin, at = ty * size + y;
    int x0 = 0, x1 = 0;
    if (b->square) {
        if (*hf_layers_map_at(&c->filled, b->square->tx, y / 2) && hf_layers_square_span(c, s, b->square, &x0, &x1))
            draw_span(c, b, at, y, x0, x1, to);
        return;
    }
    for (int tx = c->box.x0, end; (end = hf_layers_next_run(&c->filled, &tx, y / 2, c->box.x1, ~0)) > tx; tx = end) {
        int a = tx * size - s->reach, z = end * size + s->reach;
        a = a > -margin ? a : -margin;
        z = z < last ? z : last;
        if (a >= z)
            continue;
        hf_layers_align_span(&a, &z);
        if (x1 > x0 && a > x1) {
            draw_span(c, b, at, y, x0, x1, to);
            x0 = a;
        } else if (x1 <= x0) {
            x0 = a;
        }
        x1 = z;
    }
    if (x1 > x0)
        draw_span(c, b, at, y, x0, x1, to);
}

// The rows of sources that scratch holds: rows y0 to y1 of tile row `from`.
struct held {
    int from, y0, y1;
};

void hf_layers_draw_slice(const struct hf_cell *c, const struct hf_build *b, const struct hf_window *to)
{
    const int size = TILE >> b->s->level, margin = b->s->level ? MARGIN : 0;
    const struct hf_rect with = hf_layers_tiles_with_samples(c);
    struct held held = {0};
    if (b->s->shape)
        hf_layers_begin_shape(c, b->s);
    for (int ty = c->box.y0; ty < c->box.y1 && !hf_stopped(c->l->stop); ty++) {
        int tx = c->box.x0;
        if (hf_layers_next_run(&c->used, &tx, ty, c->box.x1, ~0) == tx || (ty + 1) * size + b->s->rows <= -margin ||
            ty * size - b->s->rows >= c->rows * size + margin)
            continue;
        // The pairs of rows whose blur reaches the cell.
        const int least = -margin - b->s->rows - ty * size, most = c->rows * size + margin + b->s->rows - ty * size;
        const int y0 = least > 0 ? least & ~1 : 0, y1 = most < size ? (most + 1) & ~1 : size;
        const int from = hf_layers_within(ty, with.y0, with.y1), beyond = from == with.y0 || from == with.y1;
        // All rows of tiles beyond the frame are equal, so their sources are built once.
        if (!beyond || held.y0 == held.y1 || held.from != from) {
            clear_row(c, b, held.y0, held.y1);
            held = beyond ? (struct held){from, 0, size} : (struct held){from, y0, y1};
            build_row(c, b, ty, from, held.y0, held.y1);
        }
        for (int y = y0; y < y1 && !hf_stopped(c->l->stop); y += 2)
            draw_pair(c, b, ty, y, to);
    }
    clear_row(c, b, held.y0, held.y1);
}

void hf_layers_take_sources(const struct hf_cell *c, const struct hf_build *b, hf_layers_taker *take, void *to)
{
    const int size = TILE >> b->s->level;
    const struct hf_rect with = hf_layers_tiles_with_samples(c);
    for (int ty = c->box.y0; ty < c->box.y1 && !hf_stopped(c->l->stop); ty++) {
        int tx = c->box.x0;
        if (hf_layers_next_run(&c->used, &tx, ty, c->box.x1, ~0) == tx)
            continue;
        build_row(c, b, ty, hf_layers_within(ty, with.y0, with.y1), 0, size);
        for (int y = 0; y < size; y++) {
            tx = c->box.x0;
            for (int end; (end = hf_layers_next_run(&c->filled, &tx, y / 2, c->box.x1, ~0)) > tx; tx = end)
                take(to, source_at(c, 0, tx * size, y), c->source.channel, tx * size, ty * size + y, (end - tx) * size);
        }
        clear_row(c, b, 0, size);
    }
}
