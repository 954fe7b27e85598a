// SPDX-License-Identifier: BSD-3-Clause
// The scatter's kernels for one instruction set.
#include "engine/scatter/behind_simd.h"
#include "engine/scatter/slice_simd.h"
#include "engine/scatter/source_simd.h"
#include "engine/scatter/splat_simd.h"
#include "engine/scatter/tent_simd.h"

void HF_SIMD_NAME(hf_scatter_kernels)(struct hf_scatter_kernels *k)
{
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
    k->slice_row = slice_row_simd;
    k->slice_behind = slice_behind_simd;
    k->note = scatter_note_simd;
    k->blend = scatter_blend_simd;
    k->seen_weights = seen_weights_simd;
    k->behind_blend = behind_blend_simd;
}
