// SPDX-License-Identifier: BSD-3-Clause
// The sizes of a frame's cells, as far as an engine needs them for its scratch memory and its reach.
#ifndef HF_CELLS_H
#define HF_CELLS_H

#include "pass/engine.h"

enum { HF_MAX_SWEEPS = 6 };

// Cells of sweep i have width[i] x height[i] half-resolution pixels. [0] is not used.
struct hf_cells {
    int width[HF_MAX_SWEEPS], height[HF_MAX_SWEEPS];
    struct hf_reach pass[HF_MAX_PASSES];  // by how much a pass's rectangle exceeds the cell
    struct hf_reach buf[HF_MAX_BUFS];     // and each buffer
    size_t line_floats;                   // longest row that a pass may keep of a cell
};

#endif
