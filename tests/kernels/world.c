// SPDX-License-Identifier: BSD-3-Clause
// Memory of the cases, and frames in it.
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"

// A page of any system; the longest slot is a benchmark's picture or the gather's scratch.
enum { GUARD = 65536, SLOT_BYTES = 1 << 20, SLOT_STEP = SLOT_BYTES + GUARD };
static const size_t NOWHERE_BYTES = 1 << 26;

static uint8_t *base, *nowhere;

void arenas_open(void)
{
    nowhere = memory_reserve(NOWHERE_BYTES);
    base = memory_reserve((size_t)ARENA_COUNT * SLOT_COUNT * SLOT_STEP);
    for (int i = 0; i < ARENA_COUNT * SLOT_COUNT; i++)
        memory_allow(base + (size_t)i * SLOT_STEP, SLOT_BYTES);
}

void *in_arena(enum arena a, const void *made)
{
    return made ? (uint8_t *)made + (size_t)a * SLOT_COUNT * SLOT_STEP : NULL;
}

uint8_t *slot_start(const struct world *w, enum arena a, int slot)
{
    return base + ((size_t)a * SLOT_COUNT + slot) * SLOT_STEP + SLOT_BYTES - w->bytes[slot];
}

uint8_t *slot_use(struct world *w, int slot, size_t bytes, int fill)
{
    if (bytes > SLOT_BYTES) {
        fprintf(stderr, "slot %d: %zu bytes do not fit\n", slot, bytes);
        exit(1);
    }
    w->bytes[slot] = bytes;
    return memset(slot_start(w, ARENA_MADE, slot), fill, bytes);
}

void world_clear(struct world *w)
{
    memset(w->bytes, 0, sizeof w->bytes);
    memset(w->result, 0, sizeof w->result);
    memset(&w->src, 0, sizeof w->src);
    memset(&w->dst, 0, sizeof w->dst);
    memset(&w->depth, 0, sizeof w->depth);
    w->region_count = 0;
    w->line_floats = 0;
    w->near = w->far = w->is_pass = 0;
    w->engine = &hf_gather_engine;
    w->x = w->y = w->n = w->with_counts = w->no_alpha = 0;
    w->words = w->copy = NULL;
    w->finite = 0;
    w->word_count = 0;
    // A buffer that a kernel must not use lies where every access crashes.
    for (int b = 0; b < HF_MAX_BUFS; b++) {
        w->buf[b].stride = 64;
        for (int c = 0; c < 4; c++)
            w->buf[b].ch[c] = (float *)(nowhere + NOWHERE_BYTES / 2);
    }
}

void world_reset(const struct world *w, enum arena a)
{
    for (int i = 0; i < SLOT_COUNT; i++)
        if (w->bytes[i])
            memcpy(slot_start(w, a, i), slot_start(w, ARENA_MADE, i), w->bytes[i]);
}

struct region *world_region(struct world *w, enum region_kind kind, int slot, const void *first, size_t row_bytes,
                            size_t spare, int rows, ptrdiff_t stride)
{
    if (w->region_count == MAX_REGIONS)
        abort();
    struct region *g = &w->regions[w->region_count++];
    *g = (struct region){.kind = kind,
                         .slot = slot,
                         .row_bytes = row_bytes,
                         .spare = spare,
                         .rows = rows,
                         .stride = stride,
                         .buf = -1,
                         .offset = (size_t)((const uint8_t *)first - slot_start(w, ARENA_MADE, slot))};
    return g;
}

int buf_channels(const struct world *w, int b)
{
    return hf_engine_channels(w->engine, &w->setup, b);
}

static int round_down(int x, int to)
{
    return x - ((x % to) + to) % to;
}

int buf_bytes(const struct world *w, int b)
{
    return w->engine->bufs[b].narrow ? hf_narrow_bytes(w->setup.storage) : (int)sizeof(float);
}

// Laid out as render.c does it: pixels whose x is a multiple of 16 (more in narrow buffers) are aligned to 64 bytes,
// and HF_PAD floats follow the last row.
void make_buf(struct world *w, int b, struct hf_rect r)
{
    enum { FRONT = 64 };  // floats before the first row
    const int bytes = buf_bytes(w, b), per = 64 / bytes, height = r.y1 - r.y0;
    const int left = round_down(r.x0, per) * bytes / 4, right = round_down(r.x1 * bytes / 4 + HF_PAD + 16, 16);
    const int stride = right - left + 16 * rng_int(&w->rng, 0, 2);
    const size_t floats = FRONT + (size_t)(height - 1) * stride + (size_t)(right - left);
    w->buf[b].stride = stride;
    for (int c = 0; c < buf_channels(w, b); c++) {
        float *start = (float *)(void *)slot_use(w, SLOT_BUF + 4 * b + c, floats * sizeof(float), 0xff);
        w->buf[b].ch[c] = start + FRONT - (ptrdiff_t)r.y0 * stride - left;
    }
}

float *world_at(const struct world *w, enum arena a, int b, int c, int x, int y)
{
    return in_arena(a, hf_at(&w->buf[b], c, x, y));
}

void world_put(struct world *w, int b, int c, int x, int y, float v)
{
    const enum hf_storage storage = w->engine->bufs[b].narrow ? w->setup.storage : HF_STORAGE_FLOAT;
    hf_narrow_store(storage, hf_narrow_at(&w->buf[b], c, x, y, buf_bytes(w, b)), v);
}

void make_lines(struct world *w, int lines, size_t floats)
{
    w->line_floats = (floats + 15) / 16 * 16;
    slot_use(w, SLOT_LINES, (size_t)lines * w->line_floats * sizeof(float), 0xff);
    slot_use(w, SLOT_DEPTH_LINES, HF_DEPTH_LINES * w->line_floats * sizeof(float), 0xff);
}

static struct hf_image *image_in(enum arena a, const struct hf_image *made, struct hf_image *out)
{
    *out = *made;
    for (int i = 0; i < 4; i++)
        out->data[i] = in_arena(a, made->data[i]);
    return out;
}

static const void *engine_kernels(const struct world *w, const struct kernels *k)
{
    switch (w->setup.engine) {
    case HF_ENGINE_CHAPTER:
        return &k->chapter;
    case HF_ENGINE_HEXAGON:
        return &k->hexagon;
    case HF_ENGINE_SCATTER:
        return &k->scatter;
    case HF_ENGINE_GAUSSIAN:
        return &k->gaussian;
    case HF_ENGINE_LAYERS:
        return &k->layers;
    default:
        return &k->gather;
    }
}

// Images and depth are passed by pointer, so each arena has its own.
struct hf_frame world_frame(struct world *w, const struct kernels *k, enum arena a)
{
    static struct hf_image images[ARENA_COUNT][2];
    static struct hf_depth depths[ARENA_COUNT];
    depths[a] = w->depth;
    depths[a].data = in_arena(a, w->depth.data);
    struct hf_frame f = {.s = &w->setup,
                         .k = &k->pixel,
                         .kernels = engine_kernels(w, k),
                         .src = image_in(a, &w->src, &images[a][0]),
                         .dst = image_in(a, &w->dst, &images[a][1]),
                         .depth = &depths[a],
                         .near = w->near,
                         .far = w->far,
                         .line_floats = w->line_floats,
                         .lines = (float *)(void *)slot_start(w, a, SLOT_LINES),
                         .depth_lines = (float *)(void *)slot_start(w, a, SLOT_DEPTH_LINES),
                         .work = (float *)(void *)slot_start(w, a, SLOT_WORK),
                         .counts = &w->result[a].counts,
                         .seen = &w->result[a].seen};
    for (int b = 0; b < HF_MAX_BUFS; b++) {
        f.buf[b].stride = w->buf[b].stride;
        for (int c = 0; c < 4; c++) {
            const uint8_t *p = (const uint8_t *)w->buf[b].ch[c];
            const int is_nowhere = p >= nowhere && p < nowhere + NOWHERE_BYTES;
            f.buf[b].ch[c] = is_nowhere ? w->buf[b].ch[c] : in_arena(a, w->buf[b].ch[c]);
        }
    }
    return f;
}
