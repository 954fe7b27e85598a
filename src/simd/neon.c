// SPDX-License-Identifier: BSD-3-Clause
#include "simd/vec_neon.h"

#if HF_FUSED
#define HF_INIT hf_kernels_neon_fused
#else
#define HF_INIT hf_kernels_neon_exact
#endif
#include "simd/all_simd.h"
