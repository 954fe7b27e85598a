// SPDX-License-Identifier: BSD-3-Clause
// The shared kernels for one instruction set.
#include "pixel/rows_simd.h"
#include "pixel/behind_simd.h"
#include "pixel/coc_simd.h"
#include "pixel/depth_rows_simd.h"
#include "pixel/edges_simd.h"
#include "pixel/highlight_simd.h"
#include "pixel/near_blur_simd.h"
#include "pixel/near_max_simd.h"
#include "pixel/radius_simd.h"

void HF_SIMD_NAME(hf_pixel_kernels)(struct hf_pixel_kernels *k)
{
    format_init(k);
    depth_rows_init(k);
    k->coc_row = coc_row_simd;
    k->sharp_row = sharp_row_simd;
    k->radius_row = radius_row_simd;
    k->zip = zip_row_simd;
    k->unzip = unzip_row_simd;
    k->raise = raise_row_simd;
    k->lower = lower_row_simd;
    k->edges = (struct hf_edges_kernels){edges_sure_simd, edges_take_simd};
    k->fields = (struct hf_fields_kernels){max_x_simd, max_y_simd, blur_x_simd, blur_y_simd};
    k->behind = (struct hf_behind_kernels){.near_row = near_row_simd,
                                           .most_row = most_row_simd,
                                           .seen_row = seen_row_simd,
                                           .third_row = third_row_simd,
                                           .part_row = part_row_simd,
                                           .add_part = add_part_simd,
                                           .up_row = up_row_simd};
}
