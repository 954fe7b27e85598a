// SPDX-License-Identifier: BSD-3-Clause
// The context's allocator, and how many bytes it holds.
#ifndef HF_MEM_H
#define HF_MEM_H

#include <stddef.h>

enum { HF_ALIGN = 64 };  // a cache line, and the widest vector

struct hf_mem {
    void *(*alloc)(void *cookie, size_t size, size_t align);
    void (*free)(void *cookie, void *ptr);
    void *cookie;
};

// Allocates with malloc's family.
extern const struct hf_mem hf_mem_default;

// A block that grows and never shrinks, so that only the first frames allocate.
struct hf_block {
    void *data;
    size_t size;
};

// Make the block at least size bytes; contents are lost when it grows. Returns 0 or HF_ERR_MEMORY (then it is empty).
int hf_block_grow(struct hf_block *block, size_t size, const struct hf_mem *mem);
void hf_block_free(struct hf_block *block, const struct hf_mem *mem);

#endif
