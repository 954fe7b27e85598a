// SPDX-License-Identifier: BSD-3-Clause
// The gather's kernels of an instruction set.
#include "engine/gather/down_simd.h"
#include "engine/gather/near_max_simd.h"
#include "engine/gather/near_blur_simd.h"
#include "engine/gather/computation_simd.h"
#include "engine/gather/fill_simd.h"
#include "engine/gather/composite_simd.h"

void HF_SIMD_NAME(hf_gather_kernels)(struct hf_gather_kernels *k)
{
    k->passes.pass[HF_GATHER_DOWN] = down_simd;
    k->passes.pass[HF_GATHER_MAX_X] = max_x_simd;
    k->passes.pass[HF_GATHER_MAX_Y] = max_y_simd;
    k->passes.pass[HF_GATHER_BLUR_X] = blur_x_simd;
    k->passes.pass[HF_GATHER_BLUR_Y] = blur_y_simd;
    k->passes.pass[HF_GATHER_COMPUTATION] = gather_simd;
    k->passes.pass[HF_GATHER_FILL] = fill_simd;
    k->passes.pass[HF_GATHER_COMPOSITE] = composite_simd;
}
