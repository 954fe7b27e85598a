// SPDX-License-Identifier: BSD-3-Clause
// Chooses the kernels of an instruction set: C first, each level overwrites what it does better.
#include "hexagon/hexagon.h"

void hf_kernels_c(struct hf_kernels *k)
{
    k->pass[HF_PASS_COC] = hf_coc_c;
    k->pass[HF_PASS_DOWN] = hf_down_c;
    k->pass[HF_PASS_MAX_X] = hf_max_x_c;
    k->pass[HF_PASS_MAX_Y] = hf_max_y_c;
    k->pass[HF_PASS_BLUR_X] = hf_blur_x_c;
    k->pass[HF_PASS_BLUR_Y] = hf_blur_y_c;
    k->pass[HF_PASS_GATHER] = hf_gather_c;
    k->pass[HF_PASS_FILL] = hf_fill_c;
    k->pass[HF_PASS_COMPOSITE] = hf_composite_c;
    k->coc_row = hf_coc_row_c;
    k->sharp_row = hf_sharp_row_c;
    k->pass[HF_KERNEL_RADIUS] = hf_radius_c;
    k->radius_row = hf_radius_row_c;
    k->pass[HF_KERNEL_HEXAGON_LOAD] = hf_hexagon_load_c;
    k->pass[HF_KERNEL_HEXAGON_1] = hf_hexagon_1_c;
    k->pass[HF_KERNEL_HEXAGON_2] = hf_hexagon_2_c;
    k->pass[HF_KERNEL_HEXAGON_BLUR] = hf_hexagon_blur_pass;
    k->pass[HF_KERNEL_HEXAGON_COMPOSITE] = hf_hexagon_composite_c;
    k->pass[HF_KERNEL_GAUSSIAN_DEPTH] = hf_gaussian_depth_pass;
    k->pass[HF_KERNEL_GAUSSIAN_ROWS] = hf_gaussian_rows_pass;
    k->pass[HF_KERNEL_GAUSSIAN_COLUMNS] = hf_gaussian_columns_pass;
    k->pass[HF_KERNEL_GAUSSIAN_MERGE] = hf_gaussian_merge_pass;
    k->pass[HF_KERNEL_WIDE_COLUMNS] = hf_wide_columns_pass;
    k->pass[HF_KERNEL_WIDE_ROWS] = hf_wide_rows_pass;
    k->blend_row = hf_blend_row_c;
    k->lerp_row = hf_lerp_row_c;
    k->gaussian_line = hf_gaussian_line_c;
    k->gaussian_columns = hf_gaussian_columns_c;
    k->gaussian_up = hf_gaussian_up_c;
    k->wide_block = hf_wide_block_c;
    k->zip = hf_zip_row_c;
    k->unzip = hf_unzip_row_c;
    k->pass[HF_KERNEL_SCATTER_PREPARE] = hf_scatter_prepare_c;
    k->pass[HF_KERNEL_SPLAT_FAR] = hf_splat_far;
    k->pass[HF_KERNEL_SPLAT_NEAR] = hf_splat_near;
    k->pass[HF_KERNEL_SCATTER_COMPOSITE] = hf_scatter_composite_c;
    k->splat = hf_splat_c;
    k->splat_runs = hf_splat_runs_c;
    k->splat_taps = hf_splat_taps_c;
    k->source_weights = hf_source_weights_c;
    k->source_pictures = hf_source_pictures_c;
    k->list_row = hf_list_row_c;
    k->settle = hf_settle_c;
    k->quad_row = hf_quad_row_c;
    k->site_row = hf_site_row_c;
    k->tent_weights = hf_tent_weights_c;
    k->tent = hf_tent_c;
    k->mean_row = hf_mean_row_c;
    k->scatter_note = hf_scatter_note_c;
    k->scatter_blend = hf_scatter_blend_c;
    hf_format_kernels_c(k);
}

void hf_kernels_init(struct hf_kernels *k, enum hf_isa isa, int fused)
{
    hf_kernels_c(k);
#if HF_SIMD && HF_X86
    if (isa == HF_ISA_SSE41)
        hf_kernels_sse41_exact(k);
    if (isa == HF_ISA_AVX2)
        (fused ? hf_kernels_avx2_fused : hf_kernels_avx2_exact)(k);
    if (isa == HF_ISA_AVX512)
        (fused ? hf_kernels_avx512_fused : hf_kernels_avx512_exact)(k);
#elif HF_SIMD && HF_ARM
    if (isa == HF_ISA_NEON)
        (fused ? hf_kernels_neon_fused : hf_kernels_neon_exact)(k);
#else
    (void)isa;
    (void)fused;
#endif
}
