// SPDX-License-Identifier: BSD-3-Clause
#include "base/mem.h"

#include "base/system.h"
#include "hyperfocal/hyperfocal.h"

static void *default_alloc(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    return hf_system_alloc(size, align);
}

static void default_free(void *cookie, void *ptr)
{
    (void)cookie;
    hf_system_free(ptr);
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
