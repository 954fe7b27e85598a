// SPDX-License-Identifier: BSD-3-Clause
#include "../harness.h"

void emulated_avx512_fused(struct hf_kernels *k);
void emulated_avx512_exact(struct hf_kernels *k);
int emulated_check_vectors(void);

int emulated_kernels(struct hf_kernels *k, int fused)
{
    hf_kernels_c(k);
    (fused ? emulated_avx512_fused : emulated_avx512_exact)(k);
    return 1;
}

int emulated_check(void)
{
    return emulated_check_vectors();
}
