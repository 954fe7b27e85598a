// SPDX-License-Identifier: BSD-3-Clause
// Sizes of a frame's cells, which engines need for their scratch memory and their reach.
#ifndef HF_CELLS_H
#define HF_CELLS_H

#include "pass/engine.h"

// Cells are so wide unless many threads need smaller ones, or an engine asks for another width.
enum { HF_MAX_SWEEPS = 6, HF_CELL_WIDTH = 320 };

// Cells of sweep i have width[i] x height[i] half-resolution pixels. [0] is not used.
struct hf_cells {
    int width[HF_MAX_SWEEPS], height[HF_MAX_SWEEPS];
    struct hf_reach pass[HF_MAX_PASSES];  // how much larger than the cell a pass's rectangle is, on each side
    struct hf_reach buf[HF_MAX_BUFS];     // the same for each buffer
    size_t line_floats;                   // the longest row of a cell that a pass may keep
};

#endif
