// SPDX-License-Identifier: BSD-3-Clause
// Every table of kernels that can run here.
#include <stdio.h>

#include "harness.h"

static const enum hf_isa isas[] = {HF_ISA_SSE41, HF_ISA_AVX2, HF_ISA_AVX512, HF_ISA_NEON};

static int add(struct level *levels, int n, enum hf_isa isa, const char *suffix, int exact, const char *filter)
{
    const char *name = isa == HF_ISA_SCALAR ? "c" : isa ? hf_isa_name(isa) : "avx512 (emulated)";
    char full[sizeof levels->name];
    snprintf(full, sizeof full, "%s%s", name, suffix);
    if (filter && !strstr(full, filter))
        return n;
    memcpy(levels[n].name, full, sizeof full);
    levels[n].isa = isa;
    levels[n].exact = exact;
    return n + 1;
}

static void init(struct kernels *k, enum hf_isa isa, int fused)
{
    memset(k, 0, sizeof *k);
    hf_pixel_kernels_init(&k->pixel, isa, fused);
    hf_gather_kernels_init(&k->gather, isa, fused);
    hf_chapter_kernels_init(&k->chapter, isa, fused);
    hf_hexagon_kernels_init(&k->hexagon, isa, fused);
    hf_scatter_kernels_init(&k->scatter, isa, fused);
    hf_gaussian_kernels_init(&k->gaussian, isa, fused);
    hf_layers_kernels_init(&k->layers, isa, fused);
}

int levels_make(struct level levels[MAX_LEVELS], const char *filter, int emulated)
{
    memset(levels, 0, sizeof *levels * MAX_LEVELS);
    init(&levels[0].k, HF_ISA_SCALAR, 0);
    int n = add(levels, 0, HF_ISA_SCALAR, "", 1, NULL);
    for (int i = 0; i < (int)(sizeof isas / sizeof *isas); i++) {
        struct kernels exact, fused;
        crash_step = hf_isa_name(isas[i]);
        if (!hf_isa_available(isas[i]))
            continue;
        init(&exact, isas[i], 0);
        init(&fused, isas[i], 1);
        const int both = memcmp(&exact, &fused, sizeof exact) != 0;
        levels[n].k = exact;
        n = add(levels, n, isas[i], both ? " exact" : "", 1, filter);
        levels[n].k = fused;
        if (both)
            n = add(levels, n, isas[i], "", 0, filter);
    }
    crash_step = "avx512 (emulated)";
    if (emulated && emulated_kernels(&levels[n].k, 0))
        n = add(levels, n, HF_ISA_AUTO, " exact", 1, filter);
    if (emulated && emulated_kernels(&levels[n].k, 1))
        n = add(levels, n, HF_ISA_AUTO, "", 0, filter);
    return n;
}
