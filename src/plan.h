// SPDX-License-Identifier: BSD-3-Clause
// Which tile needs what, and how large the buffers around it have to be.
#ifndef HF_PLAN_H
#define HF_PLAN_H

#include "pass.h"

// What the scene asks of a tile, or was found in a chunk.
enum { HF_NEAR = 1, HF_FAR = 2 };

struct hf_plan {
    int chunk_width, chunk_height, chunks_x, chunks_y;  // first sweep; half-resolution pixels
    int tile_width, tile_height, tiles_x, tiles_y;      // second sweep; each a whole number of chunks
    uint8_t *chunk_found;     // HF_NEAR, HF_FAR: CoC of that kind in the chunk
    uint8_t *chunk_deferred;  // 1: its downsample was put off, nobody may need it
    uint8_t *tile_needs;
    int *deferred;            // list for the second run of the first sweep
    int deferred_count;

    struct hf_reach pass[HF_PASS_COUNT];  // by how much a pass's rectangle exceeds the tile
    struct hf_reach buf[HF_BUF_COUNT];    // and each buffer
};

// Sizes and reaches of a frame for a number of threads; tile sizes 0: chosen. whole: one tile for all.
void hf_plan_layout(struct hf_plan *p, const struct hf_setup *s, int tile_width, int tile_height, int threads,
                    int whole);
// Bytes that hf_plan_memory wants.
size_t hf_plan_bytes(const struct hf_plan *p);
void hf_plan_memory(struct hf_plan *p, void *memory);

// After the first sweep: what each tile needs, and which deferred chunks are wanted after all.
void hf_plan_classify(struct hf_plan *p, const struct hf_setup *s);

struct hf_rect hf_plan_chunk(const struct hf_plan *p, const struct hf_setup *s, int i);
struct hf_rect hf_plan_tile(const struct hf_plan *p, const struct hf_setup *s, int i);

#endif
