// SPDX-License-Identifier: BSD-3-Clause
// Other services of the operating system: system_posix.c, system_windows.c.
#ifndef HF_SYSTEM_H
#define HF_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

// Nanoseconds of a clock that never goes back, from an arbitrary start.
int64_t hf_now_ns(void);
// The id of the calling process, which changes in a child after fork().
int hf_process(void);
// How many processors this process may run on, at least 1.
int hf_system_processors(void);
// Bytes of the third-level cache; 0 if the system does not tell. May be slow.
size_t hf_system_cache(void);
// size bytes aligned to align (a power of two, at least a pointer's size), or NULL; free with hf_system_free alone.
void *hf_system_alloc(size_t size, size_t align);
void hf_system_free(void *ptr);

#endif
