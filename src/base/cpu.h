// SPDX-License-Identifier: BSD-3-Clause
// The instruction sets that this CPU and this build have.
#ifndef HF_CPU_H
#define HF_CPU_H

#include "hyperfocal/hyperfocal.h"

// The set to use: `wanted`; for AUTO the one that HYPERFOCAL_ISA names, or the best if that is unset. Returns AUTO if
// the set is not available, or the variable names none.
enum hf_isa hf_cpu_choose(enum hf_isa wanted);
// The value of HYPERFOCAL_ISA, or NULL.
const char *hf_cpu_variable(void);
// Bytes of the third-level cache; 0 if the system does not tell. Only the first call asks the system.
size_t hf_cpu_cache(void);

#endif
