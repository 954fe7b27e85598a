// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/depth_rows.h"
#include "pixel/fields.h"
#include "pixel/pass_c.h"

HF_CHOOSE_KERNELS(hf_pixel_kernels)

void hf_pixel_kernels_c(struct hf_pixel_kernels *k)
{
    *k = (struct hf_pixel_kernels){.coc_row = hf_coc_row_c,
                                   .sharp_row = hf_sharp_row_c,
                                   .radius_row = hf_radius_row_c,
                                   .zip = hf_zip_row_c,
                                   .unzip = hf_unzip_row_c,
                                   .raise = hf_raise_row_c,
                                   .lower = hf_lower_row_c,
                                   .edges = {hf_edges_sure_c, hf_edges_take_c},
                                   .fields = {hf_max_x_c, hf_max_y_c, hf_blur_x_c, hf_blur_y_c}};
    hf_format_kernels_c(k);
    hf_depth_rows_c(k);
    hf_behind_rows_c(k);
}
