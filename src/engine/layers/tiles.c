// SPDX-License-Identifier: BSD-3-Clause
// Which tiles a slice has samples in, and which its blur reaches.
#include <string.h>

#include "base/bits.h"
#include "engine/layers/parts.h"

// The index of a tile in the frame's tables. A tile beyond the frame has that of the nearest tile, whose border it
// holds.
static int tile_number(const struct hf_cell *c, int tx, int ty)
{
    const struct hf_layers *l = c->l;
    int x = c->x0 / TILE + tx, y = c->y0 / TILE + ty;
    x = x < 0 ? 0 : x < l->columns ? x : l->columns - 1;
    y = y < 0 ? 0 : y < l->rows ? y : l->rows - 1;
    return y * l->columns + x;
}

struct hf_layers_range hf_layers_range_at(const struct hf_cell *c, const struct hf_layers_range *map, int tx, int ty)
{
    return map[tile_number(c, tx, ty)];
}

// Set `bit` for the tiles of a row, and n more on either side, that have samples of the slice.
static void mark_row(const struct hf_cell *c, const uint64_t *marks, int words, int slice, int n, int ty, int bit)
{
    const struct hf_layers *l = c->l;
    const int first = c->x0 / TILE - n, columns = c->columns + 2 * n, begin = hf_max(-first, 0),
              end = hf_min(l->columns - first, columns);
    const uint64_t *row = marks + (ptrdiff_t)tile_number(c, begin - n, ty) * words + slice / 64, *last = row;
    const uint64_t *const left = row, mask = (uint64_t)1 << slice % 64;
    uint8_t *used = hf_layers_map_at(&c->used, -n, ty);
    for (int i = begin; i < end; i++, row += words) {
        used[i] |= *row & mask ? (uint8_t)bit : 0;
        last = row;
    }
    for (int i = 0; *left & mask && i < begin; i++)
        used[i] |= (uint8_t)bit;
    for (int i = end; *last & mask && i < columns; i++)
        used[i] |= (uint8_t)bit;
}

void hf_layers_mark_plain(const struct hf_cell *c)
{
    const struct hf_layers *l = c->l;
    const int n = l->most_tiles;
    for (int ty = -n; ty < c->rows + n; ty++)
        for (int tx = -n; tx < c->columns + n; tx++) {
            const int at = tile_number(c, tx, ty);
            const struct hf_layers_range mixed = l->mixed_range[at];
            uint64_t shares = 0;
            for (int i = 0; i < l->share_words; i++)
                shares |= l->share_marks[at * l->share_words + i];
            const int x = c->x0 + tx * TILE, y = c->y0 + ty * TILE;
            const int inside = x >= 0 && y >= 0 && x + TILE <= l->width && y + TILE <= l->height;  // see border.c
            *hf_layers_map_at(&c->plain, tx, ty) =
                (uint8_t)((inside && mixed.low > mixed.high ? WHOLE : 0) | (shares ? 0 : DULL));
        }
}

// The rows of the frame's tiles that may reach the cell.
static struct hf_rect rows_of(const struct hf_cell *c)
{
    const int n = c->l->most_tiles, y = c->y0 / TILE;
    return (struct hf_rect){.y0 = hf_max(y - n, 0), .y1 = hf_min(y + c->rows + n, c->l->rows)};
}

// The slices of set `of` in row y of the frame's tiles.
static uint64_t *present_in(const struct hf_cell *c, enum hf_marks of, int y)
{
    const struct hf_layers *l = c->l;
    return c->present + (ptrdiff_t)(y - rows_of(c).y0) * (4 * l->words + l->share_words) + (int)of * l->words;
}

static const uint64_t *marks_of(const struct hf_layers *l, enum hf_marks of)
{
    const uint64_t *const marks[] = {l->seen_marks, l->mixed_marks, l->hidden_marks, l->beyond_marks, l->share_marks};
    return !l->levels && (of == HF_MARKS_HIDDEN || of == HF_MARKS_BEYOND) ? NULL : marks[of];
}

static int words_of(const struct hf_layers *l, enum hf_marks of)
{
    return of == HF_MARKS_SHARES ? l->share_words : l->words;
}

void hf_layers_find_present(struct hf_cell *c)
{
    const struct hf_layers *l = c->l;
    const int n = l->most_tiles, left = hf_max(c->x0 / TILE - n, 0),
              right = hf_min(c->x0 / TILE + c->columns + n, l->columns);
    const struct hf_rect r = rows_of(c);
    memset(c->present, 0, sizeof *c->present * (size_t)(4 * l->words + l->share_words) * (size_t)(r.y1 - r.y0));
    for (int i = HF_MARKS_SEEN; i <= HF_MARKS_SHARES; i++) {
        const uint64_t *marks = marks_of(l, (enum hf_marks)i);
        const int words = words_of(l, (enum hf_marks)i);
        for (int y = r.y0; marks && y < r.y1; y++) {
            uint64_t *present = present_in(c, (enum hf_marks)i, y);
            for (int x = left; x < right; x++)
                for (int k = 0; k < words; k++)
                    present[k] |= marks[((ptrdiff_t)y * l->columns + x) * words + k];
        }
    }
}

static int is_present(const struct hf_cell *c, enum hf_marks of, int slice, int y)
{
    return present_in(c, of, y)[slice / 64] >> slice % 64 & 1;
}

// Mark the tiles of a row that have samples of a set. Returns 0 if there are none.
static int mark_set(const struct hf_cell *c, enum hf_marks of, int slice, int n, int ty, int bit)
{
    const int y = c->y0 / TILE + ty, inside = y < 0 ? 0 : y < c->l->rows ? y : c->l->rows - 1;
    if (!is_present(c, of, slice, inside))
        return 0;
    mark_row(c, marks_of(c->l, of), words_of(c->l, of), slice, n, ty, bit);
    return 1;
}

int hf_layers_mark_used(struct hf_cell *c, int slice, enum hf_kind kind)
{
    const struct hf_layers *l = c->l;
    const int n = hf_layers_tiles_around(hf_layers_table(l, kind) + slice), columns = c->columns + 2 * n;
    static const enum hf_marks sets[][2] = {[HF_KIND_SEEN] = {HF_MARKS_SEEN, HF_MARKS_MIXED},
                                            [HF_KIND_HIDDEN] = {HF_MARKS_HIDDEN, HF_MARKS_BEYOND},
                                            [HF_KIND_SHARES] = {HF_MARKS_SHARES, HF_MARKS_SHARES}};
    const enum hf_marks own = sets[kind][0], more = sets[kind][1];
    struct hf_rect r = rows_of(c);
    while (r.y0 < r.y1 && !is_present(c, own, slice, r.y0) && !is_present(c, more, slice, r.y0))
        r.y0++;
    if (r.y0 == r.y1)
        return 0;
    c->box = (struct hf_rect){c->columns + n, c->rows + n, -n, -n};
    for (int ty = -n; ty < c->rows + n; ty++) {
        uint8_t *used = hf_layers_map_at(&c->used, -n, ty);
        memset(used, 0, (size_t)columns);
        int any = mark_set(c, own, slice, n, ty, SEEN);
        if (more != own)
            any |= mark_set(c, more, slice, n, ty, MORE);
        int first = 0, last = any ? columns : 0;
        while (first < last && !used[first])
            first++;
        while (last > first && !used[last - 1])
            last--;
        if (first == last)
            continue;
        c->box =
            (struct hf_rect){hf_min(first - n, c->box.x0), hf_min(ty, c->box.y0), hf_max(last - n, c->box.x1), ty + 1};
    }
    return c->box.y0 < c->box.y1;
}

int hf_layers_use_tile(struct hf_cell *c, int tx, int ty, int shine)
{
    const struct hf_layers *l = c->l;
    if (!(l->share_marks[(ptrdiff_t)tile_number(c, tx, ty) * l->share_words + shine / 64] >> shine % 64 & 1))
        return 0;
    c->box = (struct hf_rect){tx, ty, tx + 1, ty + 1};
    *hf_layers_map_at(&c->used, tx, ty) = SEEN;
    return 1;
}

struct hf_rect hf_layers_tiles_with_samples(const struct hf_cell *c)
{
    const int x = -c->x0 / TILE - 1, y = -c->y0 / TILE - 1;
    return (struct hf_rect){x, y, x + c->l->columns + 1, y + c->l->rows + 1};
}

int hf_layers_mark_touched(struct hf_cell *c, const struct hf_slice *s, struct hf_tile_map *to)
{
    const int by = hf_layers_blur_tiles(s);
    int any = 0;
    for (int ty = -1; ty <= c->rows; ty++)
        memset(hf_layers_map_at(to, -1, ty), 0, (size_t)c->columns + 2);
    for (int ty = c->box.y0; ty < c->box.y1; ty++) {
        const int top = ty - by > -1 ? ty - by : -1, low = ty + by < c->rows ? ty + by : c->rows;
        for (int tx = c->box.x0, end; (end = hf_layers_next_run(&c->used, &tx, ty, c->box.x1, ~0)) > tx; tx = end) {
            const int a = tx - by > -1 ? tx - by : -1, b = end - 1 + by < c->columns ? end - 1 + by : c->columns;
            for (int y = top; y <= low && a <= b; y++)
                memset(hf_layers_map_at(to, a, y), 1, (size_t)(b - a + 1));
            any |= a <= b && top <= low;
        }
    }
    return any;
}

// Tiles without the bits are passed over eight at a time.
int hf_layers_next_run(const struct hf_tile_map *m, int *tx, int ty, int end, int bits)
{
    const uint64_t every = (uint64_t)0x0101010101010101 * (uint64_t)(bits & 255);
    const uint8_t *row = hf_layers_map_at(m, 0, ty);
    int from = *tx, to;
    uint64_t eight = 0;
    while (from < end && !(eight = hf_bytes_at(row + from) & every))
        from += 8;
    from = hf_min(eight ? from + hf_first_byte(eight) : from, end);
    for (to = from; to < end; to += 8)
        if ((eight = hf_zero_bytes(hf_bytes_at(row + to) & every)) != 0) {
            to += hf_first_byte(eight);
            break;
        }
    *tx = from;
    return hf_min(to, end);
}

void hf_layers_clip_rows(const struct hf_cell *c, int level, int ty, int *y0, int *y1)
{
    const int margin = level ? MARGIN : 0, size = TILE >> level;
    *y0 = ty * size > -margin ? ty * size : -margin;
    *y1 = (ty + 1) * size < c->rows * size + margin ? (ty + 1) * size : c->rows * size + margin;
}

void hf_layers_align_span(int *x0, int *x1)
{
    *x0 = (*x0 + LEFT) / 16 * 16 - LEFT;
    *x1 = (*x1 + LEFT + 15) / 16 * 16 - LEFT;
}

int hf_layers_square_span(const struct hf_cell *c, const struct hf_slice *s, const struct hf_layers_square *of, int *x0,
                          int *x1)
{
    const int x = of->tx * TILE + of->dx;
    *x0 = hf_max(x - s->reach, 0);
    *x1 = hf_min(x + HF_LAYERS_SQUARE + s->reach, c->columns * TILE);
    if (*x0 >= *x1)
        return 0;
    hf_layers_align_span(x0, x1);
    return 1;
}

int hf_layers_next_span(const struct hf_cell *c, const struct hf_tile_map *m, int level, int ty, struct hf_span *s)
{
    const int margin = level ? MARGIN : 0, size = TILE >> level, last = c->columns * size + margin;
    int found = 0;
    for (int end; (end = hf_layers_next_run(m, &s->tx, ty, c->columns + 1, 1)) > s->tx; s->tx = end) {
        int x0 = s->tx * size > -margin ? s->tx * size : -margin, x1 = end * size < last ? end * size : last;
        if (x0 >= x1)
            continue;
        hf_layers_align_span(&x0, &x1);
        if (found && x0 > s->x1)
            break;
        s->x0 = found ? s->x0 : x0;
        s->x1 = x1;
        found = 1;
    }
    return found;
}
