// SPDX-License-Identifier: BSD-3-Clause
// Changes depth in place, block by block of its rows, on all threads.
#ifndef HF_IO_DEPTH_BLOCKS_H
#define HF_IO_DEPTH_BLOCKS_H

#include "tools/io/run.h"

enum { HF_IO_DEPTH_BLOCK = 1024 };  // pixels of a row at the most

// from: the original values; to: a copy that is changed.
struct hf_io_depth {
    const float *from;
    float *to;
    int width, height;
};

// Changes n pixels of row y from x on; returns how many values changed.
typedef long long hf_io_depth_block(const struct hf_io_depth *d, const void *how, int x, int n, int y);

// Call block for all of a picture. *changed: how many values changed. run NULL: on this thread. Returns 0, or -1
// without memory.
int hf_io_depth_blocks(float *depth, int width, int height, const struct hf_io_run *run, hf_io_depth_block *block,
                       const void *how, long long *changed);

#endif
