// SPDX-License-Identifier: BSD-3-Clause
// What is done to one cell of a frame: to a chunk of the input, to a tile of the output. Each is a task of its own, and what
// it writes is no other task's.
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
    const struct hf_block *touched;  // what hf_sweep_touch writes to
};

// Tasks for the pool; arg is a struct hf_render.
// Look at the depth of a chunk, and make its first buffers where that already says that they will be read.
void hf_sweep_look(void *arg, int chunk, int worker);
// The i-th of the plan's chunks that are left: make what is read of it, or, in place, check the colour that nobody reads.
void hf_sweep_rest(void *arg, int i, int worker);
// Look at a chunk's colour where it will be read: for the report alone.
void hf_sweep_colour(void *arg, int chunk, int worker);
// What each tile of a row needs.
void hf_sweep_classify(void *arg, int row, int worker);
// A cell of a later sweep: its passes, and in the last one the copy of what is sharp.
void hf_sweep_cell(void *arg, int cell, int worker);
// A tile of a frame without blur: checked, or copied.
void hf_sweep_check(void *arg, int tile, int worker);
void hf_sweep_copy(void *arg, int tile, int worker);

// A piece of the block that a frame to come will use: zeros.
enum { HF_TOUCH_BYTES = 1 << 18 };
void hf_sweep_touch(void *arg, int piece, int worker);

#endif
