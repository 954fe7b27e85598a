// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_IO_DEPTH_EDGES_H
#define HF_IO_DEPTH_EDGES_H

// Give numbers between the two sides of an outline to the nearer side, in place; *changed: how many. The numbers may be
// distances, their inverses or a map's. Slopes stay as they are. Returns 0, or -1 when memory is out.
enum { HF_IO_EDGE_REACH = 5 };  // how far away in pixels what a sample becomes depends on
int hf_io_sharpen_depth(float *depth, int width, int height, long long *changed);

#endif
