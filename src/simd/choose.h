// SPDX-License-Identifier: BSD-3-Clause
// A table of kernels for an instruction set. It is filled with the C kernels, then overwritten by vector kernels. Each
// simd.c is compiled once per instruction set, with and without fused multiply-add: src/meson.build.
#ifndef HF_CHOOSE_H
#define HF_CHOOSE_H

#include "hyperfocal/hyperfocal.h"

// For struct NAME, functions of the same name. NAME_c fills it. NAME_avx2_exact and similar ones overwrite it; exact
// ones have the bits of the C. NAME_init makes the table of an instruction set. SSE4.1 cannot fuse, so it has only an
// exact one.
#define HF_DECLARE_KERNELS(name)                                                                                       \
    void name##_c(struct name *k);                                                                                     \
    void name##_sse41_exact(struct name *k);                                                                           \
    void name##_avx2_exact(struct name *k);                                                                            \
    void name##_avx2_fused(struct name *k);                                                                            \
    void name##_avx512_exact(struct name *k);                                                                          \
    void name##_avx512_fused(struct name *k);                                                                          \
    void name##_neon_exact(struct name *k);                                                                            \
    void name##_neon_fused(struct name *k);                                                                            \
    void name##_init(void *table, enum hf_isa isa, int fused)

#if HF_SIMD && HF_X86 && !HF_NARROW
#define HF_CHOOSE_KERNELS(name)                                                                                        \
    void name##_init(void *table, enum hf_isa isa, int fused)                                                          \
    {                                                                                                                  \
        struct name *k = table;                                                                                        \
        name##_c(k);                                                                                                   \
        if (isa == HF_ISA_SSE41)                                                                                       \
            name##_sse41_exact(k);                                                                                     \
        if (isa == HF_ISA_AVX2)                                                                                        \
            (fused ? name##_avx2_fused : name##_avx2_exact)(k);                                                        \
        if (isa == HF_ISA_AVX512)                                                                                      \
            (fused ? name##_avx512_fused : name##_avx512_exact)(k);                                                    \
    }
#elif HF_SIMD && HF_X86
#define HF_CHOOSE_KERNELS(name)                                                                                        \
    void name##_init(void *table, enum hf_isa isa, int fused)                                                          \
    {                                                                                                                  \
        struct name *k = table;                                                                                        \
        (void)fused;                                                                                                   \
        name##_c(k);                                                                                                   \
        if (isa == HF_ISA_SSE41)                                                                                       \
            name##_sse41_exact(k);                                                                                     \
    }
#elif HF_SIMD && HF_ARM
#define HF_CHOOSE_KERNELS(name)                                                                                        \
    void name##_init(void *table, enum hf_isa isa, int fused)                                                          \
    {                                                                                                                  \
        struct name *k = table;                                                                                        \
        name##_c(k);                                                                                                   \
        if (isa == HF_ISA_NEON)                                                                                        \
            (fused ? name##_neon_fused : name##_neon_exact)(k);                                                        \
    }
#else
#define HF_CHOOSE_KERNELS(name)                                                                                        \
    void name##_init(void *table, enum hf_isa isa, int fused)                                                          \
    {                                                                                                                  \
        struct name *k = table;                                                                                        \
        (void)isa;                                                                                                     \
        (void)fused;                                                                                                   \
        name##_c(k);                                                                                                   \
    }
#endif

// The name of a simd.c's own function. HF_SUFFIX is avx2_fused, for example.
#define HF_SIMD_NAME(name) HF_JOIN_(name, HF_SUFFIX)
#define HF_JOIN_(name, suffix) HF_JOIN__(name, suffix)
#define HF_JOIN__(name, suffix) name##_##suffix

#endif
