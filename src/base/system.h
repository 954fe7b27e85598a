// SPDX-License-Identifier: BSD-3-Clause
// What else the library asks of the operating system: system_posix.c, system_windows.c.
#ifndef HF_SYSTEM_H
#define HF_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

// A clock that never goes back, from an arbitrary start.
int64_t hf_now_ns(void);
// The process that calls: after fork() the child's is another.
int hf_process(void);
// Processors that this process may run on, at least 1.
int hf_system_processors(void);
// Bytes of the third-level cache, 0 where the system does not tell. It may be slow to ask.
size_t hf_system_cache(void);
// size bytes aligned to align (a power of two, at least a pointer's size), or NULL; free with hf_system_free alone.
void *hf_system_alloc(size_t size, size_t align);
void hf_system_free(void *ptr);

#endif
