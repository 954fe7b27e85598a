// SPDX-License-Identifier: BSD-3-Clause
// Which instruction sets this CPU and this build have.
#ifndef HF_CPU_H
#define HF_CPU_H

#include "hyperfocal/hyperfocal.h"

// The set to use: `wanted`, for AUTO what HYPERFOCAL_ISA names, else the best. AUTO: that is not available or no name.
enum hf_isa hf_cpu_choose(enum hf_isa wanted);
// The variable's value, or NULL.
const char *hf_cpu_variable(void);
// The name of an instruction set; NULL for a number that is none.
const char *hf_cpu_name(enum hf_isa isa);
// 1 if this CPU and this build can run it.
int hf_cpu_has(enum hf_isa isa);
// Bytes of the third-level cache; 0 if the system does not tell. Only the first call asks the system.
size_t hf_cpu_cache(void);

#endif
