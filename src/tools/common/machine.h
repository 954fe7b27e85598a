// SPDX-License-Identifier: BSD-3-Clause
// The machine that a program runs on.
#ifndef HF_TOOL_MACHINE_H
#define HF_TOOL_MACHINE_H

#include <stddef.h>

// The CPU's name as the kernel reports it; ARM kernels report none.
void tool_cpu(char *name, size_t size);

// Milliseconds of a clock that only goes forward.
double tool_now_ms(void);

#endif
