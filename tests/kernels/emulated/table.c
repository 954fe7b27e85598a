// SPDX-License-Identifier: BSD-3-Clause
#include "../harness.h"

int emulated_check_vectors(void);

#define DECLARE(name)                                                                                                  \
    void name##_emulated_exact(struct name *k);                                                                        \
    void name##_emulated_fused(struct name *k)
DECLARE(hf_pixel_kernels);
DECLARE(hf_gather_kernels);
DECLARE(hf_chapter_kernels);
DECLARE(hf_hexagon_kernels);
DECLARE(hf_scatter_kernels);
DECLARE(hf_gaussian_kernels);
DECLARE(hf_layers_kernels);

#define INIT(name, k)                                                                                                  \
    name##_c(k);                                                                                                       \
    (fused ? name##_emulated_fused : name##_emulated_exact)(k)

int emulated_kernels(struct kernels *k, int fused)
{
    memset(k, 0, sizeof *k);
    INIT(hf_pixel_kernels, &k->pixel);
    INIT(hf_gather_kernels, &k->gather);
    INIT(hf_chapter_kernels, &k->chapter);
    INIT(hf_hexagon_kernels, &k->hexagon);
    INIT(hf_scatter_kernels, &k->scatter);
    INIT(hf_gaussian_kernels, &k->gaussian);
    INIT(hf_layers_kernels, &k->layers);
    return 1;
}

int emulated_check(void)
{
    return emulated_check_vectors();
}
