// SPDX-License-Identifier: BSD-3-Clause
// Random frames: parameters, pictures, depth.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "harness.h"
#include "frame/resolve.h"
#include "pass/check.h"
#include "pixel/depth_rows.h"
#include "pixel/unorm.h"

static float pick(struct rng *r, const float *from, int n)
{
    return from[rng_int(r, 0, n - 1)];
}

static void random_model(struct rng *r, struct hf_params *p)
{
    static const float ranges[] = {0, 1, 4, HF_DERIVE, 30, INFINITY};
    p->focus = rng_float(r, 0.5f, 20);
    p->model = rng_one_in(r, 3) ? HF_MODEL_LENS : HF_MODEL_RANGE;
    p->lens.f_number = rng_float(r, 0.7f, 8);
    p->range.distance = pick(r, ranges, 6);
    p->range.strength = rng_one_in(r, 2) ? 1 : rng_float(r, 0.02f, 1);
    if (rng_one_in(r, 4)) {
        p->range.near_begin = rng_float(r, 0, p->focus);
        p->range.far_end = p->focus * rng_float(r, 1, 3);
    }
}

static void random_options(struct rng *r, struct hf_params *p)
{
    // Half-resolution reaches of 1 to 20, small ones more often.
    const int most = rng_one_in(r, 6) ? 40 : 14;
    // The gather has separate code for 8, 12 and 16.
    p->max_radius = rng_one_in(r, 3) ? (float)(4 * rng_int(r, 2, 4)) : rng_float(r, 0.1f, (float)most);
    if (rng_one_in(r, 2))
        p->max_radius = ceilf(p->max_radius);
    p->view.pixel_aspect = rng_one_in(r, 2) ? 1 : rng_float(r, 0.5f, 2);
    p->chapter.storage = (enum hf_storage)(rng_one_in(r, 2) ? 0 : rng_int(r, 0, 2));
    p->chapter.faithful = rng_one_in(r, 4);
    p->chapter.karis = rng_one_in(r, 4);
    p->chapter.per_pixel_kernel = rng_one_in(r, 4);
    p->chapter.bicubic = rng_one_in(r, 3);
    p->chapter.fill = (enum hf_fill)rng_int(r, 0, 3);
    p->chapter.downsample = (enum hf_downsample)(rng_one_in(r, 2) ? 0 : rng_int(r, 0, 2));
    p->gather = (struct hf_gather_params){.storage = p->chapter.storage,
                                          .karis = p->chapter.karis,
                                          .per_pixel_kernel = p->chapter.per_pixel_kernel,
                                          .bicubic = p->chapter.bicubic};
    p->range.blend = rng_one_in(r, 3) ? HF_BLEND_SMOOTHSTEP : HF_BLEND_LINEAR;
    p->aperture.blades = rng_one_in(r, 3) ? rng_int(r, 5, 9) : 0;
    p->aperture.rotation = rng_one_in(r, 2) ? 0 : rng_float(r, -180, 180);
}

static void random_depth_type(struct rng *r, struct hf_depth *d, int width, int height)
{
    d->type = (enum hf_depth_type)rng_int(r, 0, HF_DEPTH_COC);
    d->format = (enum hf_depth_format)(rng_one_in(r, 2) ? 0 : rng_int(r, 0, HF_DEPTH_FORMAT_COUNT - 1));
    d->near_plane = rng_float(r, 0.01f, 1);
    d->far_plane = rng_one_in(r, 3) ? INFINITY : rng_float(r, 5, 1000);
    d->focal_px = rng_float(r, 5, 200);
    d->center_x = rng_one_in(r, 2) ? (float)width / 2 : rng_float(r, -50, 150);
    d->center_y = rng_one_in(r, 2) ? (float)height / 2 : rng_float(r, -50, 150);
}

static void random_format(struct world *w, struct hf_image *m, int width, int height)
{
    static char there;
    *m = (struct hf_image){.size = sizeof(struct hf_image),
                           .width = width,
                           .height = height,
                           .format = (enum hf_format)rng_int(&w->rng, 0, HF_FORMAT_COUNT - 1)};
    if (w->bench)
        m->format = HF_FORMAT_R11G11B10F;
    m->transfer = hf_unorm(m->format) && rng_one_in(&w->rng, 2) ? HF_TRANSFER_SRGB : HF_TRANSFER_LINEAR;
    for (int i = 0; i < (m->format != HF_FORMAT_PLANAR32F ? 1 : rng_one_in(&w->rng, 2) ? 4 : 3); i++)
        m->data[i] = &there;  // for now
}

void world_setup(struct world *w, void *own)
{
    struct hf_message message;
    if (hf_params_resolve(&w->resolved, w->src.width, w->src.height, &w->depth, &w->params, &message)) {
        fprintf(stderr, "%s\n", message.sentence);
        abort();
    }
    hf_setup_make(&w->setup, &w->src, &w->dst, &w->depth, &w->resolved, own);
}

void make_setup(struct world *w, int half_width, int half_height)
{
    struct rng *r = &w->rng;
    do {
        const int width = 2 * half_width - (w->bench ? 0 : rng_int(r, 0, 1));
        const int height = 2 * half_height - (w->bench ? 0 : rng_int(r, 0, 1));
        w->params = hf_default_params();
        w->params.max_radius = 12;
        w->depth = (struct hf_depth){.size = sizeof(struct hf_depth)};
        random_format(w, &w->src, width, height);
        random_format(w, &w->dst, width, height);
        if (!w->bench && rng_one_in(r, 4)) {  // formats that go from picture to picture in registers have separate code
            w->dst.format = rng_one_in(r, 2) ? HF_FORMAT_R11G11B10F : HF_FORMAT_RGB32F;
            w->dst.transfer = HF_TRANSFER_LINEAR;
            w->src = w->dst;
        }
        if (!w->bench) {
            random_depth_type(r, &w->depth, width, height);
            random_model(r, &w->params);
            random_options(r, &w->params);
        }
        void *own = is_chapter(w) ? (void *)&w->chapter : (void *)&w->gather;
        w->params.engine = is_chapter(w) ? HF_ENGINE_CHAPTER : HF_ENGINE_GATHER;
        world_setup(w, own);
        const struct hf_engine_def *e = is_chapter(w) ? &hf_chapter_engine : &hf_gather_engine;
        if (!w->resolved.sharp && e->own.prepare(own, &w->setup, &w->resolved.params, &hf_mem_default) != HF_OK)
            abort();
    } while (w->resolved.sharp);
    w->colours = (enum colours)(w->bench ? COLOURS_PLAIN : rng_int(r, 0, COLOURS_COUNT - 1));
}

// Set the sample to NaN or infinity.
static void spoil(struct world *w, const struct hf_image *m, int c, int x, int y)
{
    const uint32_t random = rng_next(&w->rng);
    uint8_t *row = (uint8_t *)m->data[m->format == HF_FORMAT_PLANAR32F ? c : 0] +
                   (ptrdiff_t)y * m->stride[m->format == HF_FORMAT_PLANAR32F ? c : 0];
    const uint16_t half = (uint16_t)(0x7c00 | (random & 0x8000) | (random & 1 ? random >> 8 & 0x3ff : 0));
    uint32_t word;
    if (m->format == HF_FORMAT_RGBA16F) {
        memcpy(row + (size_t)x * 8 + c * 2, &half, 2);
    } else if (m->format == HF_FORMAT_R11G11B10F) {
        memcpy(&word, row + (size_t)x * 4, 4);
        word |= c == 2 ? 0xf8000000u : 0x7c0u << 11 * c;
        memcpy(row + (size_t)x * 4, &word, 4);
    } else {
        hf_put_sample(m, c, x, y, random & 1 ? NAN : random & 2 ? INFINITY : -INFINITY);
    }
}

static void fill_image(struct world *w, const struct hf_image *m, int bad)
{
    for (int c = 0; c < hf_image_channels(m); c++)
        for (int y = 0; y < m->height; y++)
            for (int x = 0; x < m->width; x++)
                hf_put_sample(m, c, x, y, random_colour(&w->rng, w->colours));
    if (!bad || w->bench)
        return;
    for (int i = 0; i < 1 + m->width * m->height / 60; i++) {
        const int c = rng_int(&w->rng, 0, hf_image_channels(m) - 1), x = rng_int(&w->rng, 0, m->width - 1);
        spoil(w, m, c, x, rng_int(&w->rng, 0, m->height - 1));
    }
}

// One plane of rows with junk between them, at any alignment, sometimes from the bottom up. Returns its first row.
static void *random_rows(struct world *w, int slot, size_t row_bytes, int height, ptrdiff_t *stride)
{
    struct rng *r = &w->rng;
    const size_t step = row_bytes + (rng_one_in(r, 2) ? 0 : (size_t)rng_int(r, 0, 40));
    const size_t front = 64, tail = rng_one_in(r, 2) ? 0 : (size_t)rng_int(r, 0, 15);
    uint8_t *p = slot_use(w, slot, front + (size_t)(height - 1) * step + row_bytes + tail, 0xff) + front;
    if (!w->bench && rng_one_in(r, 6)) {
        *stride = -(ptrdiff_t)step;
        return p + (size_t)(height - 1) * step;
    }
    *stride = (ptrdiff_t)step;
    return p;
}

void make_image(struct world *w, struct hf_image *m, int slot, int bad)
{
    for (int i = 0; i < hf_plane_count(m); i++)
        m->data[i] = random_rows(w, slot + i, hf_row_bytes(m->format, m->width), m->height, &m->stride[i]);
    fill_image(w, m, bad);
}

static float random_depth(struct world *w)
{
    static const float odd[] = {0,        -0.0f, -1, 1e-45f, 1e10f, 0x1.2a05f0p+33f, 1e30f,
                                INFINITY, -5e9f, 1,  -1e4f,  0.5f,  1e-9f,           -INFINITY};
    struct rng *r = &w->rng;
    if (rng_one_in(r, 8))
        return odd[rng_int(r, 0, (int)(sizeof odd / sizeof *odd) - 1)];
    const float focus = w->params.focus;
    if (rng_one_in(r, 8))
        return focus;
    switch (w->depth.type) {
    case HF_DEPTH_NDC_D3D:
        return rng_one_in(r, 4) ? rng_float(r, -0.2f, 1.2f) : 1 - rng_float(r, 0, 0.1f);
    case HF_DEPTH_NDC_GL:
        return rng_one_in(r, 4) ? rng_float(r, -1.2f, 1.2f) : 1 - rng_float(r, 0, 0.1f);
    case HF_DEPTH_NDC_REVERSED:
        return rng_one_in(r, 4) ? rng_float(r, -0.2f, 1.2f) : rng_float(r, 0, 0.1f);
    case HF_DEPTH_INVERSE:
        return rng_float(r, 0, 4 / focus);
    case HF_DEPTH_COC:
        return rng_float(r, -1.5f, 1.5f) * w->params.max_radius;
    default:
        return rng_float(r, 0, 3 * focus);
    }
}

// Write v, or the nearest value that the format holds.
static void put_depth(const struct hf_depth *d, uint8_t *row, int x, float v)
{
    const double unit = v > 0 ? v < 1 ? (double)v : 1 : 0;
    const uint32_t whole = (uint32_t)(unit * 4294967295.0);
    const uint16_t word =
        d->format == HF_DEPTH_FORMAT_FLOAT16 ? (v == v ? hf_half_pack(v) : 0x7e00) : (uint16_t)(whole >> 16);
    const size_t bytes = hf_depth_bytes(d->format);
    if (bytes == 2)
        memcpy(row + 2 * (size_t)x, &word, 2);
    else
        memcpy(row + 4 * (size_t)x, d->format == HF_DEPTH_FORMAT_FLOAT32 ? (const void *)&v : (const void *)&whole, 4);
}

void make_depth(struct world *w, int bad)
{
    struct hf_depth *d = &w->depth;
    const int width = w->setup.width, height = w->setup.height;
    uint8_t *p = random_rows(w, SLOT_DEPTH, (size_t)width * hf_depth_bytes(d->format), height, &d->stride);
    d->data = p;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            float v = w->bench ? 5 + (float)((x + y) % 64) / 4 : random_depth(w);
            if (bad && !w->bench && rng_one_in(&w->rng, 50))
                v = NAN;
            put_depth(d, p + (ptrdiff_t)y * d->stride, x, v);
        }
}
