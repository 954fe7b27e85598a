// SPDX-License-Identifier: BSD-3-Clause
// Passes a frame's buffers to the caller's dump function.
#include "frame/dump.h"

#include "frame/buffers.h"
#include "pixel/format.h"

// A full-resolution buffer holds even and odd pixels of a row separately; interleave them.
static int join_lanes(struct hf_context *c, const struct hf_setup *s, const struct hf_buf *b,
                      struct hf_inspect_buffer *out)
{
    const int width = s->width, height = s->height;
    const int err = hf_block_grow(&c->joined, 2 * (size_t)width * height * sizeof(float), &c->mem);
    if (err)
        return err;
    float *p = c->joined.data;
    for (int ch = 0; ch < 2; ch++) {
        out->data[ch] = p;
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                *p++ = *hf_at(b, 2 * ch + (x & 1), x / 2, y);
    }
    out->width = width;
    out->height = height;
    out->channels = 2;
    out->stride = width * (ptrdiff_t)sizeof(float);
    return HF_OK;
}

static int widen(struct hf_context *c, const struct hf_setup *s, const struct hf_buf *b, struct hf_inspect_buffer *out)
{
    const int bytes = hf_narrow_bytes(s->storage);
    const int err = hf_block_grow(&c->joined, (size_t)out->width * out->height * sizeof(float), &c->mem);
    if (err)
        return err;
    float *p = c->joined.data;
    out->data[0] = p;
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            *p++ = hf_narrow_load(s->storage, hf_narrow_at(b, 0, x, y, bytes));
    out->stride = out->width * (ptrdiff_t)sizeof(float);
    return HF_OK;
}

// What the engine knows beside its buffers.
static int show_own(struct hf_context *c, const struct hf_setup *s)
{
    const struct hf_engine_own *own = &c->plan.engine->own;
    struct hf_inspect_buffer out = {.size = sizeof out,
                                    .name = own->shown,
                                    .width = s->width,
                                    .height = s->height,
                                    .channels = 1,
                                    .stride = s->width * (ptrdiff_t)sizeof(float)};
    const int err = hf_block_grow(&c->joined, (size_t)s->width * s->height * sizeof(float), &c->mem);
    if (err)
        return err;
    float *p = c->joined.data;
    out.data[0] = p;
    for (int y = 0; y < s->height; y++)
        own->show(s->own, &c->workers[0].frame, y, p + (size_t)y * s->width);
    c->dump(c->dump_cookie, &out);
    return HF_OK;
}

int hf_dump_buffers(struct hf_context *c, const struct hf_setup *s)
{
    const struct hf_engine_def *e = c->plan.engine;
    const struct hf_frame *f = &c->workers[0].frame;
    const struct hf_rect all = {0, 0, s->half_width, s->half_height};
    for (int b = 0; b < e->buf_count; b++) {
        const struct hf_buf_def *def = &e->bufs[b];
        if (!def->name || !hf_engine_channels(e, s, b))
            continue;
        const struct hf_rect r = hf_buffers_rect(s, def, all);
        struct hf_inspect_buffer out = {.size = sizeof out,
                                        .name = def->name,
                                        .width = r.x1,
                                        .height = r.y1,
                                        .channels = hf_engine_channels(e, s, b),
                                        .stride = f->buf[b].stride * (ptrdiff_t)sizeof(float)};
        for (int ch = 0; ch < out.channels; ch++)
            out.data[ch] = f->buf[b].ch[ch];
        const int err = def->y > def->x ? join_lanes(c, s, &f->buf[b], &out)
                        : def->narrow   ? widen(c, s, &f->buf[b], &out)
                                        : HF_OK;
        if (err)
            return err;
        c->dump(c->dump_cookie, &out);
    }
    return e->own.show ? show_own(c, s) : HF_OK;
}
