// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine's kernels.
#ifndef HF_GAUSSIAN_KERNELS_H
#define HF_GAUSSIAN_KERNELS_H

#include "pass/engine.h"
#include "engine/gaussian/wide.h"

// Blend factors of the n lanes from lane x of row y: of even pixels to out[0], of odd ones to out[1]. out[2] and
// out[3] are scratch. counts, which may be NULL, gets what the report counts.
typedef void hf_blend_row(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// The counting part of blend_row, for lanes from x on, a multiple of 16. Uses scratch rows 0 to 3.
typedef void hf_gaussian_count(const struct hf_frame *f, int x, int y, int n, struct hf_counts *counts);
// a + t (b - a); exactly a's bits for t = 0.
typedef void hf_lerp_row(float *a, const float *b, const float *t, int n);
// One iteration of the 5-tap kernel along a line of n pixels with two more at either end. May read HF_PAD floats before
// and after them.
typedef void hf_gaussian_line(const float *in, int n, float *out, int faithful);
// One iteration down n columns, at most HF_GAUSSIAN_STRIP. `in` has `rows` rows, of which the first and last repeat
// outwards; the kernel makes rows `from` to `to`. out is row `from`, and may be that row of `in`.
typedef void hf_gaussian_columns(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                                 ptrdiff_t out_stride, int n, int faithful);
// n lanes from lane x of row y of the frame, bilinearly from a buffer of half or a quarter of its size.
typedef void hf_gaussian_up(const struct hf_buf *b, int c, int quarter, int x, int y, int n, float *even, float *odd);
// Row y at half or a quarter of the resolution: means of 4 or 16 pixels, from n lanes of the picture from lane x on, a
// multiple of 16. Channel c goes to lines[c]; the other lines are scratch.
typedef void hf_gaussian_shrink(const struct hf_frame *f, int x, int y, int n, float *const lines[16]);
// Row y of the result, lanes r.x0 to r.x1. Uses scratch rows 0 to 13.
typedef void hf_gaussian_merge(const struct hf_frame *f, int y, struct hf_rect r);
typedef void hf_wide_block(float *block, int n, const struct hf_wide *w, float *work);

struct hf_gaussian_kernels {
    struct hf_passes passes;
    hf_blend_row *blend_row;
    hf_gaussian_count *count_row;
    hf_lerp_row *lerp_row;
    hf_gaussian_line *line;
    hf_gaussian_columns *columns;
    hf_gaussian_up *up;
    hf_gaussian_shrink *shrink;
    hf_gaussian_merge *merge;
    hf_wide_block *wide_block;
};
HF_DECLARE_KERNELS(hf_gaussian_kernels);

static inline const struct hf_gaussian_kernels *hf_gaussian_kernels(const struct hf_frame *f)
{
    return f->kernels;
}

hf_kernel hf_gaussian_depth_pass, hf_gaussian_rows_pass, hf_gaussian_columns_pass, hf_gaussian_merge_pass;
hf_kernel hf_wide_columns_pass, hf_wide_rows_pass;
hf_blend_row hf_blend_row_c;
hf_gaussian_count hf_gaussian_count_c;
hf_lerp_row hf_lerp_row_c;
hf_gaussian_line hf_gaussian_line_c;
hf_gaussian_columns hf_gaussian_columns_c;
hf_gaussian_up hf_gaussian_up_c;
hf_gaussian_shrink hf_gaussian_shrink_c;
hf_gaussian_merge hf_gaussian_merge_c;
hf_wide_block hf_wide_block_c;

extern const struct hf_engine_def hf_gaussian_engine;

#endif
