// SPDX-License-Identifier: BSD-3-Clause
// The chapter's kernels of an instruction set.
#include "engine/chapter/composite_simd.h"
#include "engine/chapter/computation_simd.h"
#include "engine/chapter/down_simd.h"
#include "engine/chapter/fill_simd.h"

void HF_SIMD_NAME(hf_chapter_kernels)(struct hf_chapter_kernels *k)
{
    k->passes.pass[HF_PASS_DOWN] = down_simd;
    k->passes.pass[HF_PASS_COMPUTATION] = computation_simd;
    k->passes.pass[HF_CHAPTER_FILL] = fill_simd;
    k->passes.pass[HF_CHAPTER_COMPOSITE] = composite_simd;
}
