// SPDX-License-Identifier: BSD-3-Clause
// Memory whose end is guarded: by AddressSanitizer, or else by a forbidden page.
#ifndef HF_TESTS_FUZZ_BLOCKS_H
#define HF_TESTS_FUZZ_BLOCKS_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "fuzz/fuzz.h"

#ifdef ADDRESS_SANITIZER
static inline void *block_of(size_t size, size_t align)
{
    void *p = NULL;
    return posix_memalign(&p, align < sizeof(void *) ? sizeof(void *) : align, size ? size : 1) ? NULL : p;
}

static inline void free_block(void *p)
{
    free(p);
}
#else
enum { PAGE = 4096 };

// A page that notes the length, the block at the end of its pages, a forbidden page.
static inline void *block_of(size_t size, size_t align)
{
    const size_t whole = ((size ? size : 1) + align - 1) / align * align;
    const size_t room = (whole + PAGE - 1) / PAGE * PAGE, all = room + 2 * PAGE;
    char *start = mmap(NULL, all, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED)
        return NULL;
    memcpy(start, &all, sizeof(all));
    MUST(!mprotect(start + PAGE + room, PAGE, PROT_NONE));
    return start + PAGE + room - whole;
}

static inline void free_block(void *p)
{
    if (!p)
        return;
    char *start = (char *)((uintptr_t)p / PAGE * PAGE) - PAGE;  // it begins in the second page
    size_t all;
    memcpy(&all, start, sizeof(all));
    MUST(!munmap(start, all));
}
#endif

#endif
