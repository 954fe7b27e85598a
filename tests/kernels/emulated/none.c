// SPDX-License-Identifier: BSD-3-Clause
// In place of avx512.c where SIMDe is not installed, and on other architectures.
#include "harness.h"

int emulated_kernels(struct kernels *k, int fused)
{
    (void)k;
    (void)fused;
    return 0;
}

int emulated_check(void)
{
    return 0;
}
