// SPDX-License-Identifier: BSD-3-Clause
#include "simd/vec_avx512.h"

#if HF_FUSED
#define HF_INIT hf_kernels_avx512_fused
#else
#define HF_INIT hf_kernels_avx512_exact
#endif
#include "simd/all_simd.h"
