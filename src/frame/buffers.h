// SPDX-License-Identifier: BSD-3-Clause
// Memory of a frame's buffers: windows of the frame or of a cell, placed so that passes address them by the frame's
// own coordinates.
#ifndef HF_BUFFERS_H
#define HF_BUFFERS_H

#include "frame/context.h"

// Allocate each worker's scratch, and the frame's buffers for the wanted fields. May return HF_ERR_MEMORY.
int hf_buffers_allocate(struct hf_context *c, const struct hf_setup *s, unsigned fields);
// Point a worker's buffers of a sweep at a cell.
void hf_buffers_place(const struct hf_context *c, const struct hf_setup *s, struct hf_frame *f, int sweep,
                      struct hf_rect cell);
// Bytes that the frame's buffers and all scratch will occupy after hf_buffers_allocate for these fields. Blocks only
// grow, so a block that is larger already counts with its present size.
size_t hf_buffers_after(const struct hf_context *c, const struct hf_setup *s, unsigned fields);
// The bytes that hf_buffers_allocate would need for these fields.
size_t hf_buffers_bytes(const struct hf_context *c, const struct hf_setup *s, unsigned fields);

// All sampling clamps to the edge: repeat the border of what a pass wrote in r outwards, as far as the buffer is read.
// r and its cell are in half-resolution pixels; a buffer of the whole frame is extended at the frame's edge.
void hf_buffers_extend(const struct hf_context *c, const struct hf_setup *s, struct hf_frame *f, int buf,
                       struct hf_rect r, struct hf_rect cell);

// Convert a rectangle from half-resolution pixels to a buffer's pixels, clipped to the frame.
struct hf_rect hf_buffers_rect(const struct hf_setup *s, const struct hf_buf_def *def, struct hf_rect r);

#endif
