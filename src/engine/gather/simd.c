// SPDX-License-Identifier: BSD-3-Clause
// The gather's kernels of an instruction set.
#include "engine/gather/composite_simd.h"
#include "engine/gather/levels_simd.h"
#include "engine/gather/down_simd.h"

void HF_SIMD_NAME(hf_gather_kernels)(struct hf_gather_kernels *k)
{
    k->passes.pass[HF_PASS_DOWN] = down_simd;
    k->passes.pass[HF_PASS_COMPUTATION] = computation_simd;
    k->passes.pass[HF_GATHER_COMPOSITE] = composite_simd;
}
