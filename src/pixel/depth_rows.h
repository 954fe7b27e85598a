// SPDX-License-Identifier: BSD-3-Clause
// Depth samples as floats, from every format.
#ifndef HF_DEPTH_ROWS_H
#define HF_DEPTH_ROWS_H

#include "pixel/kernels.h"

#define HF_DEPTH_UNIT_16 (1 / 65535.0f)
#define HF_DEPTH_UNIT_24 (1 / 16777215.0f)
#define HF_DEPTH_UNIT_32 (1 / 4294967295.0f)

// Bytes of a sample.
size_t hf_depth_bytes(enum hf_depth_format format);
// The sample of pixel (x, y).
float hf_depth_sample(const struct hf_depth *depth, int x, int y);
// Convert n samples from p on.
void hf_widen_depth_c(enum hf_depth_format format, const void *p, int n, float *out);
void hf_depth_rows_c(struct hf_pixel_kernels *k);

// n samples of row y from pixel x on, as floats: the caller's own buffer if it holds floats, else one of the frame's
// scratch rows for depth, `row` 0 or 1. Not aligned.
const uint8_t *hf_depth_row(const struct hf_frame *f, int x, int y, int n, int row);

#endif
