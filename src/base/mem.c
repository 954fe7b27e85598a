// SPDX-License-Identifier: BSD-3-Clause
#include "base/mem.h"

#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "hyperfocal/hyperfocal.h"

// Linux's pages of memory that is asked for in one piece: one fault instead of 512, and fewer misses of the table of pages
// where a loop reads many rows at once.
enum { LARGE_PAGE = 1 << 21 };

static void *default_alloc(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    void *ptr = NULL;
    const int large = size >= 2 * (size_t)LARGE_PAGE;
    if (posix_memalign(&ptr, large ? LARGE_PAGE : align, size))
        return NULL;
#ifdef MADV_HUGEPAGE
    if (large)
        madvise(ptr, size / LARGE_PAGE * LARGE_PAGE, MADV_HUGEPAGE);  // a wish
#endif
    return ptr;
}

static void default_free(void *cookie, void *ptr)
{
    (void)cookie;
    free(ptr);
}

const struct hf_mem hf_mem_default = {default_alloc, default_free, NULL};

int hf_block_grow(struct hf_block *block, size_t size, const struct hf_mem *mem)
{
    if (size <= block->size)
        return HF_OK;
    hf_block_free(block, mem);
    block->data = mem->alloc(mem->cookie, size, HF_ALIGN);
    if (!block->data)
        return HF_ERR_MEMORY;
    block->size = size;
    return HF_OK;
}

void hf_block_free(struct hf_block *block, const struct hf_mem *mem)
{
    if (block->data)
        mem->free(mem->cookie, block->data);
    block->data = NULL;
    block->size = 0;
}
