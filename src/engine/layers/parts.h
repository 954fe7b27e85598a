// SPDX-License-Identifier: BSD-3-Clause
// What the files that composite a cell share: its scratch, maps of its tiles, and their spans.
#ifndef HF_LAYERS_PARTS_H
#define HF_LAYERS_PARTS_H

#include "engine/layers/cell.h"
#include "engine/layers/slices.h"

enum { TILE = HF_LAYERS_TILE, MARGIN = HF_LAYERS_MARGIN, LEFT = 16, RIGHT = 32, AROUND = 64 };

// Planes around a cell; `at` points to channel 0 of the cell's first pixel.
struct hf_window {
    float *at;
    ptrdiff_t channel, row;
};

// A map of tiles. (0, 0) is the cell's first tile; the map continues beyond the cell on every side.
struct hf_tile_map {
    uint8_t *at;
    int stride;
};

// Bits of a tile in `used`: it has samples of the set itself, and of the set behind that one.
enum { SEEN = 1, MORE = 2 };

// Bits of a tile in `plain`: WHOLE, no pixel is mixed, so all visible samples weigh 1; DULL, no sample has a share.
enum { WHOLE = 1, DULL = 2 };

// What of a slice is drawn: visible samples with those behind mixed edges, hidden samples, or shares at full
// resolution.
enum hf_kind { HF_KIND_SEEN, HF_KIND_HIDDEN, HF_KIND_SHARES };

// The sets of samples for which each tile marks its slices.
enum hf_marks { HF_MARKS_SEEN, HF_MARKS_MIXED, HF_MARKS_HIDDEN, HF_MARKS_BEYOND, HF_MARKS_SHARES };

enum { NEAR, FAR, MIDDLE };

struct hf_cell {
    const struct hf_layers *l;
    const struct hf_samples *samples;
    const struct hf_layers_kernels *k;
    int x0, y0, columns, rows;             // of tiles
    struct hf_tile_map used;               // tiles with samples of the slice
    uint64_t *present;                     // per row of tiles, one bit for each slice whose samples may reach the cell
    struct hf_rect box;                    // all used tiles lie in this box
    struct hf_tile_map plain;              // what a tile's visible samples have in common: WHOLE, DULL
    struct hf_tile_map filled;             // for each pair of rows in a row of tiles: where there are sources
    struct hf_tile_map touched;            // tiles that the slice's blur reaches, one more around the cell
    struct hf_tile_map near, far, middle;  // tiles that a stack's slices reach, the slice in focus left out
    struct hf_tile_map begun, lit[2];      // tiles of the middle stack, and of the lights, that hold something
    int opened[2];                         // the near and the far stack hold something
    int views;                             // views count somewhere
    // How far they count at the corners of tiles, from the corner before the cell's first on; `corners` in a row.
    float *blend;
    int corners;
    struct hf_tile_map seen_by_views;  // tiles of the near stack that views alone make
    struct hf_tile_map left;           // those of them that a slice reaches, and does not draw
    int covering;                      // the far stack is somewhere not fully open at its start
    // Sums are 0 between two slices: who reads them clears them. clean: of each level, tiles that were cleared at first.
    struct hf_window source, sum[HF_LAYERS_COARSEST + 1];
    struct hf_tile_map clean[HF_LAYERS_COARSEST + 1], fresh;
    struct hf_tile_map shone;             // tiles that the blurred shares of one radius reach
    struct hf_window shine;               // their sums
    struct hf_window stack[3], light[2];  // near, far and middle; highlights of near and far
    float *line[6];                       // sums at full resolution before they are folded to the slice's
    float *row[5];                        // upsampled
    float *light_row[6];                  // light as far as it is seen
    float *none, *whole;                  // rows of zeros and of ones
    uint8_t *any;                         // for each 16 pixels of a run: whether the slice has samples there
    struct hf_tile_map covered;           // tiles where the far stack is not fully open at its start
    float *lift;                          // 1 / that openness, the factor for the far stack's sums
    ptrdiff_t lift_row;
    struct hf_tile_map passed;  // tiles in which rays of lamps pass a slice, see cut.c
    float *cover;               // the coverage of a slice
    float *cut_off;             // what is cut from the discs of tiles with lamps
    float *shape;               // scratch of shapes
};

// A span of columns of a level.
struct hf_span {
    int x0, x1, tx;  // tx: the tile from which to look for the next span; -1 at first
};

// A square of a tile. What is bright in it, on one side of the focus, is one lamp.
enum { HF_LAYERS_SQUARE = TILE / 2 };

struct hf_layers_square {
    int tx, ty, dx, dy;            // its tile, and where it lies in it
    struct hf_layers_range radii;  // of its lamp
};

struct hf_build {
    const struct hf_slice *s;
    const struct hf_layers_set *set;
    const float *weight, *share;
    int finest;  // log2 of the pixel size of its samples
    int channels;
    const struct hf_layers_set *more;       // samples behind those of `set`, or NULL
    int spread;                             // each pixel of a quad gets the quad's sample
    int first;                              // index of the first channel that is drawn
    const struct hf_layers_square *square;  // what of its tile is drawn, or NULL: all
};

// The number from `first` to `last` that is nearest to i.
static inline int hf_layers_within(int i, int first, int last)
{
    return i < first ? first : i > last ? last : i;
}

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
    return kind == HF_KIND_SEEN || (kind == HF_KIND_HIDDEN && l->known) ? l->slice
           : kind == HF_KIND_HIDDEN                                     ? l->behind
                                                                        : l->shine;
}

// tiles.c
struct hf_layers_range hf_layers_range_at(const struct hf_cell *c, const struct hf_layers_range *map, int tx, int ty);
// Note for each tile around the cell what its visible samples have in common.
void hf_layers_mark_plain(const struct hf_cell *c);
// Find the slices whose samples may reach the cell at all.
void hf_layers_find_present(struct hf_cell *c);
// Mark the tiles around the cell that have samples of the slice. Returns 0 if there are none.
int hf_layers_mark_used(struct hf_cell *c, int slice, enum hf_kind kind);
// Mark one tile alone, if it has shares of a radius. Returns 0 if it has none.
int hf_layers_use_tile(struct hf_cell *c, int tx, int ty, int shine);
// The tiles around the cell that have samples: those of the frame and one beyond it on each side, the last one included. Those
// farther out repeat them.
struct hf_rect hf_layers_tiles_with_samples(const struct hf_cell *c);
// How many tiles a slice's blur reaches on each side.
static inline int hf_layers_blur_tiles(const struct hf_slice *s)
{
    return (((s->reach + 3) << s->level) + TILE - 1) / TILE;
}
// Mark the tiles that the blur of the used tiles reaches, in the cell and one tile around it.
int hf_layers_mark_touched(struct hf_cell *c, const struct hf_slice *s, struct hf_tile_map *to);
// The next run of tiles with any of the bits, from *tx up to `end`. Moves *tx to its first tile and returns its end;
// *tx if there is none.
int hf_layers_next_run(const struct hf_tile_map *m, int *tx, int ty, int end, int bits);
// The rows of a level in a row of tiles, clipped to the rows around the cell that are computed.
void hf_layers_clip_rows(const struct hf_cell *c, int level, int ty, int *y0, int *y1);
// Widen a span to whole vectors, so that no lane lies in two spans.
void hf_layers_align_span(int *x0, int *x1);
// The columns of the cell that a square's samples reach, blurred at full resolution, in whole vectors. Returns 0 if there are
// none.
int hf_layers_square_span(const struct hf_cell *c, const struct hf_slice *s, const struct hf_layers_square *of, int *x0,
                          int *x1);
// The next span of columns that runs of tiles cover. Returns 0 if there is none.
int hf_layers_next_span(const struct hf_cell *c, const struct hf_tile_map *m, int level, int ty, struct hf_span *s);

// cell.c
// Scratch. With memory NULL it only counts how much would be taken.
struct hf_scratch {
    float *memory;
    size_t used;
};

// The next n floats, from number `at` of them on.
float *hf_layers_take(struct hf_scratch *m, size_t n, ptrdiff_t at);
// Place what a cell's sources and highlights take.
void hf_layers_place_sources(struct hf_cell *c, struct hf_scratch *m);

// draw.c
// Pointers to a set's planes at a pixel.
void hf_layers_planes_at(const struct hf_layers *l, const struct hf_layers_set *set, const float *weight, int x, int y,
                         const float *in[6]);
// Clear the tiles of a map, and the margin that is read around them.
void hf_layers_clear_tiles(const struct hf_cell *c, const struct hf_tile_map *m, const struct hf_window *w, int level,
                           int first, int channels);
void hf_layers_draw_slice(const struct hf_cell *c, const struct hf_build *b, const struct hf_window *to);
// Hand a slice's sources to `take`, run by run: n pixels of the slice's resolution from (x, y) on, a channel every so many
// floats.
typedef void hf_layers_taker(void *to, const float *in, ptrdiff_t channel, int x, int y, int n);
void hf_layers_take_sources(const struct hf_cell *c, const struct hf_build *b, hf_layers_taker *take, void *to);

// shape_draw.c
// Floats of scratch for a cell of that many tiles.
size_t hf_layers_shape_floats(const struct hf_layers *l, int columns, int rows);
// begin_shape: call before a slice. draw_shape: draw a row of its sources, row y, columns x0 to x1; in[0] is column x0
// of the first channel.
void hf_layers_begin_shape(const struct hf_cell *c, const struct hf_slice *s);
void hf_layers_draw_shape(const struct hf_cell *c, const struct hf_build *b, const float *in, int y, int x0, int x1,
                          const struct hf_window *to);

// cut.c
// Floats for the coverage of a slice around a cell.
size_t hf_layers_cover_floats(const struct hf_cell *c);
// Floats for what is cut from discs.
size_t hf_layers_cut_floats(const struct hf_cell *c);
// Cut the discs of the lamps on one side of the focus, which are drawn already.
void hf_layers_cut_lamps(struct hf_cell *c, int stack);

// lights.c
// For each pixel of some tiles of a cell at half resolution, and one more on every side: the part of a lamp's light that is cut
// there.
struct hf_layers_cut {
    struct hf_rect tiles;
    float *at;  // where the cell's first pixel would be
    ptrdiff_t row;
};
// Subtract what is cut from the light of a square's lamp.
void hf_layers_cut_light(struct hf_cell *c, int stack, const struct hf_layers_square *of,
                         const struct hf_layers_cut *t);
// Draw the highlights on one side of the focus, NEAR or FAR, with their coverage, as they shine through all that is in front of
// them but the middle stack. Call for FAR after the last slice.
void hf_layers_draw_lights(struct hf_cell *c, int stack);
// A row of a stack's light: colours, then what it covers, then what it would cover if nothing were before it.
const float *hf_layers_light_at(const struct hf_cell *c, int stack, int channel, int x, int y);
// Add what light in front of the focus covers, in a row of some tiles.
void hf_layers_add_near_cover(const struct hf_cell *c, int tx, int end, int y, float *out);
// A row of the light of tiles tx to `end`, which are lit alike, as far as it is seen: colours, then at 4 what it covers, and at 5
// what that behind the focus would cover if nothing were before it.
void hf_layers_light_row(const struct hf_cell *c, int tx, int end, int y, float *const out[6]);

// together.c
void hf_layers_put_slice(struct hf_cell *c, int i);
// Call before the first slice of the far stack: the part of shared samples that the middle stack holds closes the far
// one.
void hf_layers_cover(struct hf_cell *c);
// Upsample a row of one plane of a half-resolution stack: colours, then the weight.
void hf_layers_raise(const struct hf_cell *c, int stack, int plane, int x, int n, int y, float *out);
// The near stack goes into the middle stack, in front of all else.
void hf_layers_begin_middle(const struct hf_cell *c);
// Whether a tile has only sharp pixels and nothing else reaches it.
int hf_layers_is_sharp(const struct hf_cell *c, int tx, int ty);
void hf_layers_finish_cell(const struct hf_cell *c, float *const out[4], ptrdiff_t stride);

// views.c
// Find where views count in a cell. Returns 0 if they do not at all.
int hf_layers_find_views(struct hf_cell *c);
// Whether views stand in for slices of the near stack in some tiles.
static inline int hf_layers_views_are_near(const struct hf_cell *c)
{
    return c->views && c->l->set.near_only;
}
// Leave out what a slice of the near stack would draw in tiles that views alone make, and note them. Returns 0 if nothing is left
// to draw.
int hf_layers_leave_to_views(struct hf_cell *c, const struct hf_slice *s);
// Put views in the place of what the near stack holds, or with near_only 0 of a cell's result, out. memory:
// hf_layers_views_floats() floats.
void hf_layers_put_views(const struct hf_cell *c, float *memory, float *const out[4], ptrdiff_t stride);

#endif
