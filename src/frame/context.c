// SPDX-License-Identifier: BSD-3-Clause
#include "frame/context.h"

#include <string.h>

static size_t aligned(size_t bytes)
{
    return (bytes + HF_ALIGN - 1) / HF_ALIGN * HF_ALIGN;
}

int hf_engines_open(struct hf_context *c)
{
    size_t bytes = 0;
    for (int i = 0; i < HF_ENGINE_COUNT; i++) {
        const struct hf_engine_def *e = hf_engine_def((enum hf_engine)i);
        bytes += e ? aligned(e->own.bytes) + 2 * aligned(e->kernels.bytes) : 0;
    }
    const int err = hf_block_grow(&c->engines, bytes, &c->mem);
    if (err)
        return err;
    char *p = memset(c->engines.data, 0, bytes);
    for (int i = 0; i < HF_ENGINE_COUNT; i++) {
        const struct hf_engine_def *e = hf_engine_def((enum hf_engine)i);
        if (!e)
            continue;
        c->engine[i].own = p;
        p += aligned(e->own.bytes);
        for (int fused = 0; fused < 2; fused++, p += aligned(e->kernels.bytes)) {
            c->engine[i].kernels[fused] = p;
            e->kernels.make(p, c->isa, fused);
        }
    }
    for (int fused = 0; fused < 2; fused++)
        hf_pixel_kernels_init(&c->kernels[fused], c->isa, fused);
    return HF_OK;
}

void hf_engines_close(struct hf_context *c)
{
    for (int i = 0; i < HF_ENGINE_COUNT; i++)
        if (c->engine[i].own && hf_engine_def((enum hf_engine)i)->own.release)
            hf_engine_def((enum hf_engine)i)->own.release(c->engine[i].own, &c->mem);
    hf_block_free(&c->engines, &c->mem);
}

size_t hf_engines_bytes(const struct hf_context *c)
{
    size_t bytes = c->engines.size;
    for (int i = 0; i < HF_ENGINE_COUNT; i++)
        if (c->engine[i].own && hf_engine_def((enum hf_engine)i)->own.held)
            bytes += hf_engine_def((enum hf_engine)i)->own.held(c->engine[i].own);
    return bytes;
}
