// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_DEPTH_EDGES_H
#define HF_IO_DEPTH_EDGES_H

#include "tools/io/run.h"

enum { HF_IO_EDGE_REACH = 5 };  // pixels around a sample that affect its result

// Move values between the two sides of an outline to the nearer side, in place. *changed: how many. Values may be
// distances, their inverses or a map's. Slopes stay. run NULL: on this thread. Returns 0, or -1 without memory.
int hf_io_sharpen_depth(float *depth, int width, int height, const struct hf_io_run *run, long long *changed);

#endif
