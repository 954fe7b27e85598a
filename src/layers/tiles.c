// SPDX-License-Identifier: BSD-3-Clause
// Which tiles of a cell a slice has samples in, and which its blur reaches.
#include <string.h>

#include "layers/parts.h"

// The number of a tile in the frame's tables; tiles beyond it hold the samples of its border.
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

static int has(const struct hf_layers *l, const uint64_t *marks, int tile, int slice)
{
    return (int)(marks[(ptrdiff_t)tile * l->words + slice / 64] >> slice % 64 & 1);
}

int hf_layers_mark_used(struct hf_cell *c, int slice, enum hf_kind kind)
{
    const struct hf_layers *l = c->l;
    const int n = hf_layers_tiles_around(hf_layers_table(l, kind) + slice);
    int any = 0;
    for (int ty = -n; ty < c->rows + n; ty++)
        for (int tx = -n; tx < c->columns + n; tx++) {
            const int tile = tile_number(c, tx, ty);
            int bits = 0;
            if (kind == HF_KIND_HIDDEN)
                bits = has(l, l->hidden_marks, tile, slice);
            else if (kind == HF_KIND_SHARES)
                bits = has(l, l->share_marks, tile, slice);
            else
                bits =
                    (has(l, l->seen_marks, tile, slice) ? SEEN : 0) | (has(l, l->mixed_marks, tile, slice) ? MIXED : 0);
            *hf_layers_map_at(&c->used, tx, ty) = (uint8_t)bits;
            any |= bits;
        }
    return any;
}

int hf_layers_mark_touched(struct hf_cell *c, const struct hf_slice *s, struct hf_tile_map *to)
{
    const int n = hf_layers_tiles_around(s), reach = ((s->reach + 3) << s->level) + TILE - 1, by = reach / TILE;
    int any = 0;
    for (int ty = -1; ty <= c->rows; ty++)
        memset(hf_layers_map_at(to, -1, ty), 0, (size_t)c->columns + 2);
    for (int ty = -n; ty < c->rows + n; ty++)
        for (int tx = -n; tx < c->columns + n; tx++) {
            if (!*hf_layers_map_at(&c->used, tx, ty))
                continue;
            const int a = tx - by > -1 ? tx - by : -1, b = tx + by < c->columns ? tx + by : c->columns;
            const int top = ty - by > -1 ? ty - by : -1, low = ty + by < c->rows ? ty + by : c->rows;
            for (int y = top; y <= low && a <= b; y++)
                memset(hf_layers_map_at(to, a, y), 1, (size_t)(b - a + 1));
            any |= a <= b && top <= low;
        }
    return any;
}

int hf_layers_next_run(const struct hf_tile_map *m, int *tx, int ty, int end, int bits)
{
    while (*tx < end && !(*hf_layers_map_at(m, *tx, ty) & bits))
        ++*tx;
    int to = *tx;
    while (to < end && (*hf_layers_map_at(m, to, ty) & bits))
        to++;
    return to;
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
