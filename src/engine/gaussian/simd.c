// SPDX-License-Identifier: BSD-3-Clause
// The gaussian engine's kernels of an instruction set.
#include "engine/gaussian/blur_simd.h"
#include "engine/gaussian/count_simd.h"
#include "engine/gaussian/merge_simd.h"
#include "engine/gaussian/wide_simd.h"

void HF_SIMD_NAME(hf_gaussian_kernels)(struct hf_gaussian_kernels *k)
{
    k->blend_row = blend_row_simd;
    k->count_row = count_row_simd;
    k->lerp_row = lerp_row_simd;
    k->line = gaussian_line_simd;
    k->columns = gaussian_columns_simd;
    k->up = gaussian_up_simd;
    k->shrink = shrink_simd;
    k->merge = merge_simd;
    k->wide_block = wide_block_simd;
}
