// SPDX-License-Identifier: BSD-3-Clause
// Which instruction sets this CPU and this build have.
#ifndef HF_CPU_H
#define HF_CPU_H

#include "hyperfocal/hyperfocal.h"

// The set to use: `wanted`, for AUTO what HYPERFOCAL_ISA names, else the best. AUTO: that is not available or no name.
enum hf_isa hf_cpu_choose(enum hf_isa wanted);
// The variable's value, or NULL.
const char *hf_cpu_variable(void);
// Bytes of the third-level cache, 0 where the system does not tell. It is asked once.
size_t hf_cpu_cache(void);

#endif
