// SPDX-License-Identifier: BSD-3-Clause
// The hexagon's kernels of an instruction set.
#include "engine/hexagon/blur_simd.h"
#include "engine/hexagon/ends_simd.h"

void HF_SIMD_NAME(hf_hexagon_kernels)(struct hf_hexagon_kernels *k)
{
    k->passes.pass[HF_HEXAGON_LOAD] = hexagon_load_simd;
    k->passes.pass[HF_HEXAGON_COMPOSITE] = hexagon_composite_simd;
    k->first = hexagon_1_simd;
    k->second = hexagon_2_simd;
    k->beyond = hexagon_beyond_simd;
}
