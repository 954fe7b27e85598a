// SPDX-License-Identifier: BSD-3-Clause
// What the files that make a cell share: its scratch, maps of its tiles, and their spans.
#ifndef HF_LAYERS_PARTS_H
#define HF_LAYERS_PARTS_H

#include "engine/layers/cell.h"
#include "engine/layers/slices.h"

enum { TILE = HF_LAYERS_TILE, MARGIN = HF_LAYERS_MARGIN, LEFT = 16, RIGHT = 32, AROUND = 64 };

// Planes around a cell: at is channel 0 of its first pixel.
struct hf_window {
    float *at;
    ptrdiff_t channel, row;
};

// A map of tiles: those of the cell from (0, 0) on, and some on every side.
struct hf_tile_map {
    uint8_t *at;
    int stride;
};

// Tiles that have samples of a set, and of the set behind it.
enum { SEEN = 1, MORE = 2 };

// Of what is seen in a tile: nothing is mixed, so that all weigh 1; there are no shares.
enum { WHOLE = 1, DULL = 2 };

// What of a slice is drawn: samples that are seen with those behind mixed edges, hidden ones, shares at full resolution.
enum hf_kind { HF_KIND_SEEN, HF_KIND_HIDDEN, HF_KIND_SHARES };

// Sets of samples in whose tiles slices are marked.
enum hf_marks { HF_MARKS_SEEN, HF_MARKS_MIXED, HF_MARKS_HIDDEN, HF_MARKS_BEYOND, HF_MARKS_SHARES };

enum { NEAR, FAR, MIDDLE };

// Shares of one radius, drawn. Those between two slices are a part of both: the second finds them here.
struct hf_shine {
    int number, any;           // of what: from 1 on; whether there are any
    struct hf_tile_map shone;  // tiles that their blur reaches
    struct hf_window sum;
};

struct hf_cell {
    const struct hf_layers *l;
    const struct hf_samples *samples;
    const struct hf_layers_kernels *k;
    int x0, y0, columns, rows;             // of tiles
    struct hf_tile_map used;               // tiles that have samples of the slice
    uint64_t *present;                     // slices in each row of tiles that may reach the cell, a bit for each
    struct hf_rect box;                    // those around which there are none
    struct hf_tile_map plain;              // what the samples that are seen have in common, see below
    struct hf_tile_map filled;             // pairs of rows of a row of tiles: where there are any
    struct hf_tile_map touched;            // tiles that its blur reaches, one more around the cell
    struct hf_tile_map near, far, middle;  // where the slices of a stack reach, but for what is in focus
    struct hf_tile_map begun, lit[2];      // tiles of the middle, and of the lights, that hold something
    int opened[2];                         // near and far stack hold something
    int covering;                          // the far stack is not open wholly somewhere
    struct hf_window source, sum[HF_LAYERS_COARSEST + 1];
    struct hf_shine shine[HF_LAYERS_PARTS];
    struct hf_window stack[3], light[2];  // near, far, middle; what shines of near and far
    float *line[6];                       // sums at full resolution, on their way to the source's
    float *row[5];                        // upsampled
    float *none;                          // a row of zeros
    uint8_t *any;                         // where a row of a run has samples of the slice, 16 at once
    float *part;                          // how much of a slice shows, half resolution
    struct hf_tile_map covered;           // where the far stack is not open wholly at first ...
    float *lift;                          // ... and by what its sums are multiplied for that, with the rows of part
    ptrdiff_t part_row;
    float *shape;  // scratch of shapes
};

// Pixels of a level.
struct hf_span {
    int x0, x1, tx;  // tx: where to look for the next; -1 at first
};

struct hf_build {
    const struct hf_slice *s;
    const struct hf_layers_set *set;
    const float *weight, *share;
    int finest;  // log2 of the pixels of its samples
    int channels;
    const struct hf_layers_set *more;  // samples behind those that belong to it, or NULL
    int spread;                        // samples of quads, each of its pixels
    int first;                         // of the channels that are drawn
};

static inline uint8_t *hf_layers_map_at(const struct hf_tile_map *m, int tx, int ty)
{
    return m->at + (ptrdiff_t)ty * m->stride + tx;
}

static inline struct hf_stack_row hf_layers_stack_at(const struct hf_cell *c, int stack, int x, int y)
{
    const struct hf_window *w = &c->stack[stack];
    float *p = w->at + y * w->row + x;
    struct hf_stack_row r = {.weight = p + c->l->channels * w->channel,
                             .open = p + (c->l->channels + 1) * w->channel,
                             .behind = p + (c->l->channels + 2) * w->channel,
                             .held = p + (c->l->channels + 3) * w->channel};
    for (int i = 0; i < c->l->channels; i++)
        r.colour[i] = p + i * w->channel;
    return r;
}

static inline const struct hf_slice *hf_layers_table(const struct hf_layers *l, enum hf_kind kind)
{
    return kind == HF_KIND_SEEN ? l->slice : kind == HF_KIND_HIDDEN ? l->behind : l->shine;
}

// tiles.c
struct hf_layers_range hf_layers_range_at(const struct hf_cell *c, const struct hf_layers_range *map, int tx, int ty);
// What the samples of the tiles around the cell have in common.
void hf_layers_mark_plain(const struct hf_cell *c);
// Which slices have samples that may reach the cell at all.
void hf_layers_find_present(struct hf_cell *c);
// Mark the tiles around the cell that have samples of the slice. Returns 0 if there are none.
int hf_layers_mark_used(struct hf_cell *c, int slice, enum hf_kind kind);
// Tiles of the cell, and one around it, that the blur of what is used reaches.
int hf_layers_mark_touched(struct hf_cell *c, const struct hf_slice *s, struct hf_tile_map *to);
// The next run of set tiles from *tx on, up to `end`; returns its end, or *tx if there is none.
int hf_layers_next_run(const struct hf_tile_map *m, int *tx, int ty, int end, int bits);
// Rows of a level that belong to a row of tiles, one of those around the cell included.
void hf_layers_clip_rows(const struct hf_cell *c, int level, int ty, int *y0, int *y1);
// Grow columns to whole vectors, so that no lane lies in two spans.
void hf_layers_align_span(int *x0, int *x1);
// The next columns that runs of tiles cover. 0: there are none.
int hf_layers_next_span(const struct hf_cell *c, const struct hf_tile_map *m, int level, int ty, struct hf_span *s);

// draw.c
// Samples and their planes from a pixel on.
void hf_layers_planes_at(const struct hf_layers *l, const struct hf_layers_set *set, const float *weight, int x, int y,
                         const float *in[6]);
void hf_layers_draw_slice(const struct hf_cell *c, const struct hf_build *b, const struct hf_tile_map *touched,
                          const struct hf_window *to);

// shape_draw.c
// Scratch for a cell of so many tiles.
size_t hf_layers_shape_floats(const struct hf_layers *l, int columns, int rows);
// Before a slice, and for a row of its sources: row y, columns x0 to x1, the first of which is in[0] of its first channel.
void hf_layers_begin_shape(const struct hf_cell *c, const struct hf_slice *s);
void hf_layers_draw_shape(const struct hf_cell *c, const struct hf_build *b, const float *in, int y, int x0, int x1,
                          const struct hf_window *to);

// together.c
void hf_layers_put_slice(struct hf_cell *c, int i);
// Before the first slice of the far stack: what the middle holds of the samples that lie between them covers there, too.
void hf_layers_cover(struct hf_cell *c);
// The near stack lies before what is near the focus.
void hf_layers_begin_middle(const struct hf_cell *c);
void hf_layers_finish_cell(const struct hf_cell *c, float *const out[4], ptrdiff_t stride);

#endif
