// SPDX-License-Identifier: BSD-3-Clause
#include "base/cpu.h"

#include <stdatomic.h>
#if HF_SIMD && HF_X86 && !HF_NARROW
#include <cpuid.h>
#endif
#include <stdlib.h>
#include <string.h>

#include "base/system.h"

static const char *const isa_names[] = {"auto", "scalar", "sse4.1", "avx2", "avx512", "neon"};
enum { ISA_COUNT = sizeof isa_names / sizeof *isa_names };

const char *hf_cpu_name(enum hf_isa isa)
{
    return (unsigned)isa < ISA_COUNT ? isa_names[isa] : NULL;
}

#if HF_SIMD && HF_X86 && !HF_NARROW
// __builtin_cpu_supports knows f16c only in newer compilers: read bit 29 of leaf 1. The check for avx2 has already told
// that the operating system saves the registers.
static int has_f16c(void)
{
    unsigned a, b, c, d;
    return __get_cpuid(1, &a, &b, &c, &d) && (c >> 29 & 1);
}
#endif

int hf_cpu_has(enum hf_isa isa)
{
    switch (isa) {
    case HF_ISA_AUTO:
    case HF_ISA_SCALAR:
        return 1;
#if HF_SIMD && HF_X86
    // __builtin_cpu_supports also asks the operating system whether it saves the registers.
    case HF_ISA_SSE41:
        return __builtin_cpu_supports("sse4.1") != 0;
#if !HF_NARROW
    case HF_ISA_AVX2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && has_f16c();
    case HF_ISA_AVX512:
        return hf_cpu_has(HF_ISA_AVX2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#endif
#endif
#if HF_SIMD && HF_ARM
    case HF_ISA_NEON:
        return 1;  // every AArch64 has it
#endif
    default:
        return 0;
    }
}

const char *hf_cpu_variable(void)
{
    return getenv("HYPERFOCAL_ISA");
}

enum hf_isa hf_cpu_choose(enum hf_isa wanted)
{
    const char *name = hf_cpu_variable();
    if (wanted == HF_ISA_AUTO && name && *name) {
        for (int i = HF_ISA_AUTO; i < ISA_COUNT; i++)
            if (!strcmp(name, isa_names[i]))
                wanted = (enum hf_isa)i;
        if (wanted == HF_ISA_AUTO && strcmp(name, isa_names[HF_ISA_AUTO]))
            return HF_ISA_AUTO;
    }
    if (wanted != HF_ISA_AUTO)
        return hf_cpu_has(wanted) ? wanted : HF_ISA_AUTO;
    enum hf_isa best = HF_ISA_SCALAR;
    for (int i = HF_ISA_SCALAR; i < ISA_COUNT; i++)
        if (hf_cpu_has((enum hf_isa)i))
            best = (enum hf_isa)i;
    return best;
}

size_t hf_cpu_cache(void)
{
    static atomic_size_t known;  // the bytes plus 1; 0: not asked yet
    size_t bytes = atomic_load_explicit(&known, memory_order_relaxed);
    if (bytes)
        return bytes - 1;
    bytes = hf_system_cache();
    atomic_store_explicit(&known, bytes + 1, memory_order_relaxed);
    return bytes;
}
