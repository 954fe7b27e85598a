// SPDX-License-Identifier: BSD-3-Clause
// Which cell needs what, and how large the buffers around it are.
#ifndef HF_PLAN_H
#define HF_PLAN_H

#include <stdatomic.h>

#include "pass/cells.h"

// Cells of sweep i lie in columns[i] x rows[i]; those of sweep 1 are called chunks, those of sweep 2 tiles. [0] is not used.
struct hf_plan {
    const struct hf_engine_def *engine;
    int width, height;  // of the frame, half-resolution pixels
    int no_skip;        // every tile needs everything
    struct hf_cells cells;
    int columns[HF_MAX_SWEEPS], rows[HF_MAX_SWEEPS];
    // With a region: what of the frame each sweep has to make, [1] what of the first sweep's buffers is read; and where the
    // depth is looked at. Without, all of it.
    int part;
    struct hf_rect area[HF_MAX_SWEEPS], looked;

    struct hf_found *near, *far;  // in each chunk
    atomic_uchar *chunk_known;    // its depth has been read
    uint8_t *chunk_made;          // fields whose buffers the first sweep has made
    uint8_t *chunk_reads;         // fields that some tile reads there
    int *rest;                    // chunks with more to make; in place also those with colour that nobody has read
    int rest_count;
    uint8_t *tile_needs;          // fields
    struct hf_rect *tile_active;  // the part of each tile that is not sharp
    unsigned needs, reads;        // of all tiles
};

// Choose the size of the chunks for this number of threads. A tile size of 0 leaves the choice to the planner. whole:
// one cell holds the whole frame, and nothing is skipped.
void hf_plan_chunks(struct hf_plan *p, const struct hf_engine_def *engine, const struct hf_setup *s, int tile_width,
                    int tile_height, int threads, int whole);
// Set the reaches, and the other sweeps' cells; call once the setup's reach is known.
void hf_plan_cells(struct hf_plan *p, const struct hf_setup *s, int tile_width, int tile_height, int threads,
                   int whole);
size_t hf_plan_tile_bytes(const struct hf_plan *p);
void hf_plan_tile_memory(struct hf_plan *p, void *memory);
size_t hf_plan_chunk_bytes(const struct hf_plan *p);
void hf_plan_chunk_memory(struct hf_plan *p, void *memory);

// Pixels of colour and of depth that a frame will read: once it is settled, and there is anything to blur.
void hf_plan_reads(const struct hf_plan *p, const struct hf_setup *s, struct hf_rect *colour, struct hf_rect *depth);

// Do two rectangles have a pixel in common? And what they have.
int hf_rect_meets(struct hf_rect a, struct hf_rect b);
struct hf_rect hf_rect_both(struct hf_rect a, struct hf_rect b);

// Note what was found in a chunk; returns its fields. Called once for each chunk, by any thread.
unsigned hf_plan_found(struct hf_plan *p, int chunk, const struct hf_counts *counts);
// The fields that tiles will read of a chunk, as far as the chunks above it show.
unsigned hf_plan_foreseen(const struct hf_plan *p, const struct hf_setup *s, int chunk);

// Find what a tile needs; call when the first sweep has passed all around it.
void hf_plan_classify(struct hf_plan *p, const struct hf_setup *s, int tile);
// Call when all tiles are known: find what the frame needs and reads, and which chunks are left for hf_sweep_rest.
// scan: also those whose colour nobody reads.
void hf_plan_settle(struct hf_plan *p, const struct hf_setup *s, int scan);

// Whether the first sweep makes buffers of chunks; otherwise it only reads depth.
int hf_plan_makes_chunks(const struct hf_plan *p);
// Whether a sweep's cells are the tiles, which run as far as they need.
int hf_plan_is_tiled(const struct hf_plan *p, int sweep);
// How far around what a later sweep makes it reads buffers of the whole frame.
struct hf_reach hf_plan_reach(const struct hf_plan *p, const struct hf_setup *s, int sweep);
// Whether a pass, or any pass of a sweep, runs with these options.
int hf_plan_pass_runs(const struct hf_plan *p, const struct hf_setup *s, int pass);
int hf_plan_sweep_runs(const struct hf_plan *p, const struct hf_setup *s, int sweep);

int hf_plan_count(const struct hf_plan *p, int sweep);
struct hf_rect hf_plan_cell(const struct hf_plan *p, int sweep, int i);
// The rows of a tile that its passes have to make; the others are sharp.
struct hf_rect hf_plan_active(const struct hf_plan *p, int tile);

#endif
