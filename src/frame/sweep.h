// SPDX-License-Identifier: BSD-3-Clause
// The work on one cell of a frame: a chunk of the input, or a tile of the output. Each cell is a separate task, and no
// two tasks write the same memory.
#ifndef HF_SWEEP_H
#define HF_SWEEP_H

#include "frame/context.h"
#include "frame/copy.h"

// The frame that is being rendered.
struct hf_render {
    struct hf_context *c;
    const struct hf_setup *s;
    struct hf_copy copy;
    unsigned have;                   // fields whose buffers are allocated: what the first sweep makes at once
    int sweep;                       // the one that hf_sweep_cell runs
    const struct hf_block *touched;  // the block that hf_sweep_touch writes to
    void (*task)(void *arg, int i, int worker);  // the stage at hand
    struct hf_progress progress;
};

// Tasks for the pool; arg is a struct hf_render.
// Read the depth of a chunk, and make its first buffers where they will certainly be read.
void hf_sweep_look(void *arg, int chunk, int worker);
// Work on the i-th remaining chunk of the plan: make what is read of it, or, in place, check the colour that nobody
// reads.
void hf_sweep_rest(void *arg, int i, int worker);
// Read a chunk's colour where it will be used, only for the report.
void hf_sweep_colour(void *arg, int chunk, int worker);
// Find what each tile of a row needs.
void hf_sweep_classify(void *arg, int row, int worker);
// Run a cell of a later sweep: its passes, and in the last sweep the copy of its sharp part. Or the next one of the queue.
void hf_sweep_cell(void *arg, int cell, int worker);
void hf_sweep_next(void *arg, int i, int worker);
// Check or copy a tile of a frame without blur.
void hf_sweep_check(void *arg, int tile, int worker);
void hf_sweep_copy(void *arg, int tile, int worker);

// A piece of the block that a frame to come will use: zeros.
enum { HF_TOUCH_BYTES = 1 << 18 };
void hf_sweep_touch(void *arg, int piece, int worker);

#endif
