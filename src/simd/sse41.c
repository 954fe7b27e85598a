// SPDX-License-Identifier: BSD-3-Clause
#include "simd/vec_sse41.h"

#if HF_FUSED
#define HF_INIT hf_kernels_sse41_fused
#else
#define HF_INIT hf_kernels_sse41_exact
#endif
#include "simd/all_simd.h"
