// SPDX-License-Identifier: BSD-3-Clause
#include "simd/vec_avx2.h"

#if HF_FUSED
#define HF_INIT hf_kernels_avx2_fused
#else
#define HF_INIT hf_kernels_avx2_exact
#endif
#include "simd/all_simd.h"
