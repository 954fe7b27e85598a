// SPDX-License-Identifier: BSD-3-Clause
#include "arm/vec_neon.h"

#if HF_FUSED
#define HF_INIT hf_kernels_neon_fused
#else
#define HF_INIT hf_kernels_neon_exact
#endif
#include "pass/all_simd.h"
