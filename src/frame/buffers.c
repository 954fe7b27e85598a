// SPDX-License-Identifier: BSD-3-Clause
#include "frame/buffers.h"

#include <string.h>

// A buffer's window: its size, and the position of its first pixel relative to the area that it surrounds.
struct window {
    int stride, rows, left, top;
    int bytes;  // of a pixel
};

// Convert n half-resolution pixels to a buffer's pixels, rounded up.
static int scaled(int n, int log2)
{
    return log2 >= 0 ? n << log2 : (n + 1) >> 1;
}

static int offset(int n, int log2)
{
    return log2 >= 0 ? n * (1 << log2) : n >> 1;
}

static int bytes_of(const struct hf_setup *s, const struct hf_buf_def *def)
{
    return def->narrow ? hf_narrow_bytes(s->storage) : (int)sizeof(float);
}

// The window for an area of width x height half-resolution pixels.
static struct window window_of(const struct hf_plan *p, const struct hf_setup *s, int b, int width, int height)
{
    const struct hf_buf_def *def = &p->engine->bufs[b];
    const int lx = def->x, ly = def->y;
    struct window w = {.bytes = bytes_of(s, def)};
    const int mask = 64 / w.bytes - 1;  // rows begin on a cache line
    if (!def->bare) {
        w.left = (scaled(p->cells.buf[b].x, lx) + mask) & ~mask;
        w.top = scaled(p->cells.buf[b].y, ly);
    }
    w.stride = (((scaled(width, lx) + mask) & ~mask) + 2 * w.left) * w.bytes / (int)sizeof(float) + HF_PAD;
    if (w.stride % 1024 == 0)
        w.stride += 16;  // rows 4 KB apart would share cache sets
    w.rows = scaled(height, ly) + 2 * w.top;
    return w;
}

static size_t window_floats(struct window w)
{
    return (size_t)w.stride * w.rows;
}

// Point a buffer's channels into memory, for an area that begins at the buffer's own pixel (x0, y0). Returns the memory
// after it.
static float *place(struct hf_buf *buf, struct window w, int channels, float *memory, int x0, int y0)
{
    buf->stride = w.stride;
    for (int c = 0; c < channels; c++) {
        buf->ch[c] = memory + (ptrdiff_t)w.stride * (w.top - y0) + (w.left - x0) * w.bytes / (int)sizeof(float);
        memory += window_floats(w);
    }
    return memory;
}

// The buffers that a sweep makes again for each cell.
static unsigned scratch_of(const struct hf_engine_def *e, int sweep)
{
    unsigned bufs = 0;
    for (int i = 0; i < e->pass_count; i++)
        if (e->passes[i].sweep == sweep)
            bufs |= e->passes[i].writes | e->passes[i].inside | e->passes[i].weighed;
    for (int b = 0; b < e->buf_count; b++)
        if (e->bufs[b].frame)
            bufs &= ~(1u << b);
    return bufs;
}

static int is_wanted(const struct hf_buf_def *def, unsigned fields)
{
    return fields && (!def->field || (def->field & fields));
}

static size_t sweep_floats(const struct hf_context *c, const struct hf_setup *s, int sweep)
{
    const struct hf_engine_def *e = c->plan.engine;
    const unsigned bufs = scratch_of(e, sweep);
    size_t floats = 0;
    for (int b = 0; b < e->buf_count; b++)
        if (bufs >> b & 1)
            floats += (size_t)hf_engine_channels(e, s, b) *
                      window_floats(window_of(&c->plan, s, b, c->plan.cells.width[sweep], c->plan.cells.height[sweep]));
    return floats;
}

// Sweeps use the same scratch one after the other, unless the caller wants a dump of all buffers.
static size_t scratch_floats(const struct hf_context *c, const struct hf_setup *s, int sweeps)
{
    size_t most = 0, sum = 0;
    for (int sweep = 1; sweep <= sweeps; sweep++) {
        const size_t floats = sweep_floats(c, s, sweep);
        most = floats > most ? floats : most;
        sum += floats;
    }
    return c->dump ? sum : most;
}

static size_t work_floats(const struct hf_context *c, const struct hf_setup *s)
{
    const size_t n = c->plan.engine->plan.work ? c->plan.engine->plan.work(s, &c->plan.cells) : 0;
    return (n + 15) & ~(size_t)15;
}

static size_t worker_floats(const struct hf_context *c, const struct hf_setup *s)
{
    return (HF_LINES + HF_DEPTH_LINES) * c->plan.cells.line_floats + work_floats(c, s) +
           scratch_floats(c, s, c->plan.engine->sweeps);
}

static size_t frame_floats(const struct hf_context *c, const struct hf_setup *s, unsigned fields)
{
    const struct hf_engine_def *e = c->plan.engine;
    size_t floats = 0;
    for (int b = 0; b < e->buf_count; b++)
        if (e->bufs[b].frame && is_wanted(&e->bufs[b], fields))
            floats += (size_t)hf_engine_channels(e, s, b) *
                      window_floats(window_of(&c->plan, s, b, s->half_width, s->half_height));
    return floats;
}

size_t hf_buffers_bytes(const struct hf_context *c, const struct hf_setup *s, unsigned fields)
{
    return sizeof(float) * (frame_floats(c, s, fields) + (size_t)c->threads * worker_floats(c, s));
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

size_t hf_buffers_after(const struct hf_context *c, const struct hf_setup *s, unsigned fields)
{
    const size_t worker = worker_floats(c, s) * sizeof(float);
    size_t bytes = larger(c->planes.size, frame_floats(c, s, fields) * sizeof(float));
    for (int i = 0; i < c->threads; i++)
        bytes += larger(c->workers[i].scratch.size, worker);
    return bytes;
}

int hf_buffers_allocate(struct hf_context *c, const struct hf_setup *s, unsigned fields)
{
    const struct hf_engine_def *e = c->plan.engine;
    int err = hf_block_grow(&c->planes, frame_floats(c, s, fields) * sizeof(float), &c->mem);
    for (int i = 0; i < c->threads && !err; i++)
        err = hf_block_grow(&c->workers[i].scratch, worker_floats(c, s) * sizeof(float), &c->mem);
    if (err)
        return err;
    float *memory = c->planes.data;
    struct hf_buf planes[HF_MAX_BUFS] = {0};
    for (int b = 0; b < e->buf_count; b++)
        if (e->bufs[b].frame && is_wanted(&e->bufs[b], fields))
            memory = place(&planes[b], window_of(&c->plan, s, b, s->half_width, s->half_height),
                           hf_engine_channels(e, s, b), memory, 0, 0);
    for (int i = 0; i < c->threads; i++) {
        struct hf_frame *f = &c->workers[i].frame;
        memcpy(f->buf, planes, sizeof planes);
        f->line_floats = c->plan.cells.line_floats;
        f->lines = c->workers[i].scratch.data;
        f->depth_lines = f->lines + HF_LINES * f->line_floats;
        f->work = f->depth_lines + HF_DEPTH_LINES * f->line_floats;
    }
    return HF_OK;
}

void hf_buffers_place(const struct hf_context *c, const struct hf_setup *s, struct hf_frame *f, int sweep,
                      struct hf_rect cell)
{
    const struct hf_engine_def *e = c->plan.engine;
    const unsigned bufs = scratch_of(e, sweep);
    float *memory = f->work + work_floats(c, s) + (c->dump ? scratch_floats(c, s, sweep - 1) : 0);
    for (int b = 0; b < e->buf_count; b++)
        if (bufs >> b & 1)
            memory = place(
                &f->buf[b], window_of(&c->plan, s, b, c->plan.cells.width[sweep], c->plan.cells.height[sweep]),
                hf_engine_channels(e, s, b), memory, offset(cell.x0, e->bufs[b].x), offset(cell.y0, e->bufs[b].y));
}

struct hf_rect hf_buffers_rect(const struct hf_setup *s, const struct hf_buf_def *def, struct hf_rect r)
{
    const int lx = def->x, ly = def->y;
    const int width = lx > 0 ? s->width : scaled(s->half_width, lx);
    const int height = ly > 0 ? s->height : scaled(s->half_height, ly);
    return (struct hf_rect){hf_max(offset(r.x0, lx), 0), hf_max(offset(r.y0, ly), 0), hf_min(scaled(r.x1, lx), width),
                            hf_min(scaled(r.y1, ly), height)};
}

// Clear the part of `want` outside `have`.
static void clear_beyond(const struct hf_buf *b, int channels, int bytes, struct hf_rect have, struct hf_rect want,
                         atomic_int *stop)
{
    for (int c = 0; c < channels; c++)
        for (int y = want.y0; y < want.y1 && !hf_stopped(stop); y++) {
            const int beyond = y < have.y0 || y >= have.y1;
            const int left = beyond ? want.x1 : have.x0, right = beyond ? want.x1 : have.x1;
            memset(hf_narrow_at(b, c, want.x0, y, bytes), 0, (size_t)(left - want.x0) * (size_t)bytes);
            memset(hf_narrow_at(b, c, right, y, bytes), 0, (size_t)(want.x1 - right) * (size_t)bytes);
        }
}

// Fill samples x0 to x1 of a row with the one at x.
static void repeat(char *row, int bytes, int x, int x0, int x1)
{
    if (bytes == 1 && x0 < x1)
        memset(row + x0, row[x], (size_t)(x1 - x0));
    for (int i = x0; i < x1 && bytes == 2; i++)
        ((uint16_t *)(void *)row)[i] = ((uint16_t *)(void *)row)[x];
    for (int i = x0; i < x1 && bytes == 4; i++)
        ((float *)(void *)row)[i] = ((float *)(void *)row)[x];
}

static void extend(const struct hf_buf *b, int channels, int bytes, struct hf_rect have, struct hf_rect want,
                   atomic_int *stop)
{
    for (int c = 0; c < channels; c++) {
        for (int y = have.y0; y < have.y1 && !hf_stopped(stop); y++) {
            char *row = hf_narrow_at(b, c, 0, y, bytes);
            repeat(row, bytes, have.x0, want.x0, have.x0);
            repeat(row, bytes, have.x1 - 1, have.x1, want.x1);
        }
        const size_t n = (size_t)(want.x1 - want.x0) * (size_t)bytes;
        for (int y = want.y0; y < have.y0 && !hf_stopped(stop); y++)
            memcpy(hf_narrow_at(b, c, want.x0, y, bytes), hf_narrow_at(b, c, want.x0, have.y0, bytes), n);
        for (int y = have.y1; y < want.y1 && !hf_stopped(stop); y++)
            memcpy(hf_narrow_at(b, c, want.x0, y, bytes), hf_narrow_at(b, c, want.x0, have.y1 - 1, bytes), n);
    }
}

void hf_buffers_extend(const struct hf_context *c, const struct hf_setup *s, struct hf_frame *f, int b,
                       struct hf_rect r, struct hf_rect cell)
{
    const struct hf_engine_def *e = c->plan.engine;
    const struct hf_buf_def *def = &e->bufs[b];
    const int lx = def->x, ly = def->y;
    const struct hf_reach reach = {scaled(c->plan.cells.buf[b].x, lx), scaled(c->plan.cells.buf[b].y, ly)};
    if (!f->buf[b].ch[0] || def->bare || (reach.x == 0 && reach.y == 0))
        return;
    const struct hf_rect have = hf_buffers_rect(s, def, r);
    struct hf_rect want = have;
    const int x0 = offset(cell.x0, lx), y0 = offset(cell.y0, ly), x1 = scaled(cell.x1, lx), y1 = scaled(cell.y1, ly);
    // Inside the frame the neighbouring cells make the pixels around; at the frame's edge nobody does.
    if (!def->frame || r.x0 == 0)
        want.x0 = x0 - reach.x;
    if (!def->frame || r.y0 == 0)
        want.y0 = y0 - reach.y;
    if (!def->frame || r.x1 == s->half_width)
        want.x1 = x1 + reach.x;
    if (!def->frame || r.y1 == s->half_height)
        want.y1 = y1 + reach.y;
    if (def->frame && (e->plan.zero ? e->plan.zero(s, b) : e->plan.zero_beyond))
        clear_beyond(&f->buf[b], hf_engine_channels(e, s, b), bytes_of(s, def), have, want, s->stop);
    else
        extend(&f->buf[b], hf_engine_channels(e, s, b), bytes_of(s, def), have, want, s->stop);
}
