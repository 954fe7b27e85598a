// SPDX-License-Identifier: BSD-3-Clause
// Every vector body, for one instruction set: included by its file (x86/avx2.c ...) after its vec_*.h. HF_INIT names
// the function that enters them in the table.
#include "simd/simd.h"

#include "pixel/format_simd.h"
#include "pixel/coc_simd.h"
#include "pixel/radius_simd.h"
#include "gaussian/blur_simd.h"
#include "gaussian/wide_simd.h"
#include "gather/down_simd.h"
#include "gather/near_max_simd.h"
#include "gather/near_blur_simd.h"
#include "gather/gather_simd.h"
#include "gather/fill_simd.h"
#include "gather/composite_simd.h"
#include "hexagon/blur_simd.h"
#include "hexagon/ends_simd.h"
#include "scatter/composite_simd.h"
#include "scatter/source_simd.h"
#include "scatter/splat_simd.h"
#include "scatter/tent_simd.h"

void HF_INIT(struct hf_kernels *k);

void HF_INIT(struct hf_kernels *k)
{
    format_init(k);
    k->coc_row = coc_row_simd;
    k->sharp_row = sharp_row_simd;
    k->radius_row = radius_row_simd;
    k->blend_row = blend_row_simd;
    k->lerp_row = lerp_row_simd;
    k->gaussian_line = gaussian_line_simd;
    k->gaussian_columns = gaussian_columns_simd;
    k->gaussian_up = gaussian_up_simd;
    k->wide_block = wide_block_simd;
    k->zip = zip_row_simd;
    k->unzip = unzip_row_simd;
    k->splat = splat_simd;
    k->splat_runs = splat_runs_simd;
    k->splat_taps = splat_taps_simd;
    k->source_weights = source_weights_simd;
    k->source_pictures = source_pictures_simd;
    k->list_row = list_row_simd;
    k->settle = settle_simd;
    k->quad_row = quad_row_simd;
    k->site_row = site_row_simd;
    k->tent_weights = tent_weights_simd;
    k->tent = tent_simd;
    k->mean_row = mean_row_simd;
    k->scatter_note = scatter_note_simd;
    k->scatter_blend = scatter_blend_simd;
    k->pass[HF_PASS_DOWN] = down_simd;
    k->pass[HF_PASS_MAX_X] = max_x_simd;
    k->pass[HF_PASS_MAX_Y] = max_y_simd;
    k->pass[HF_PASS_BLUR_X] = blur_x_simd;
    k->pass[HF_PASS_BLUR_Y] = blur_y_simd;
    k->pass[HF_PASS_GATHER] = gather_simd;
    k->pass[HF_PASS_FILL] = fill_simd;
    k->pass[HF_PASS_COMPOSITE] = composite_simd;
    k->pass[HF_KERNEL_HEXAGON_LOAD] = hexagon_load_simd;
    k->pass[HF_KERNEL_HEXAGON_1] = hexagon_1_simd;
    k->pass[HF_KERNEL_HEXAGON_2] = hexagon_2_simd;
    k->pass[HF_KERNEL_HEXAGON_COMPOSITE] = hexagon_composite_simd;
}
