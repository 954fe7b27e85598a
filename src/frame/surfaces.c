// SPDX-License-Identifier: BSD-3-Clause
#include "frame/surfaces.h"

#include <math.h>
#include <string.h>

#include "pixel/depth.h"
#include "pixel/format.h"
#include "pixel/pass_c.h"

enum {
    ROWS = 16,        // of a piece of work
    FOUND_REACH = 2,  // how far from an edge's pixel its surface is looked for
    FOUND_LINES = 6   // for that: a row of a layer, and what was found
};

struct reading {
    struct hf_context *c;
    const struct hf_setup *s;
    const struct hf_surface_input *in;
    const struct hf_setup *setup;  // of each surface
    struct hf_known *known;
    int fused, pieces, count;  // count of merged layers
    size_t line_floats, worker_lines, plane;
    float *picture[5], empty;  // merged: colour and radius; the radius of nothing
    float *lines;
    struct hf_counts *counts;  // of each worker
};

// A frame that reads one surface.
static struct hf_frame frame_of(const struct reading *r, int surface, int worker)
{
    struct hf_frame f = {.s = &r->setup[surface],
                         .k = &r->c->kernels[r->fused],
                         .src = &r->in[surface].image,
                         .depth = &r->in[surface].depth,
                         .line_floats = r->line_floats,
                         .counts = &r->counts[worker],
                         .seen = &r->counts[worker]};
    f.lines = r->lines + (size_t)worker * r->worker_lines * r->line_floats;
    f.depth_lines = f.lines + HF_LINES * r->line_floats;
    return f;
}

// A surface fills a pixel as its alpha says; without alpha wherever it has any colour or depth.
static void read_row(const struct reading *r, const struct hf_frame *f, const struct hf_surface *to, int y)
{
    const struct hf_setup *s = f->s;
    const ptrdiff_t at = y * r->known->stride;
    float *colour[4], *weight = to->weight + at, *radius = to->radius + at;
    for (int c = 0; c < 4; c++)
        colour[c] = to->colour[c] + at;
    hf_read_pixels(f, 0, y, s->half_width, colour, f->seen);
    f->k->radius_row(f, 0, y, s->width, radius, NULL);
    for (int x = 0; x < s->width; x++) {
        const float a = s->channels == 4 ? hf_saturate(colour[3][x]) : 1;
        weight[x] = a;
        if (s->channels == 3)
            colour[3][x] = a;
        if (!(a > 0))
            continue;
        f->counts->radius_min = fminf(f->counts->radius_min, radius[x]);
        f->counts->radius_max = fmaxf(f->counts->radius_max, radius[x]);
    }
}

static void read_piece(void *arg, int i, int worker)
{
    const struct reading *r = arg;
    const int surface = i / r->pieces, y0 = i % r->pieces * ROWS;
    const struct hf_frame f = frame_of(r, surface, worker);
    for (int y = y0; y < hf_min(y0 + ROWS, r->s->height) && !hf_stopped(r->s->stop); y++)
        read_row(r, &f, &r->known->behind[surface], y);
}

// Place memory for `planes` planes of the frame's size and for the workers. Returns the first plane, or NULL.
static float *begin(struct reading *r, struct hf_setup *setup, int count, size_t planes, size_t more_lines)
{
    struct hf_context *c = r->c;
    const struct hf_setup *s = r->s;
    const size_t width = ((size_t)s->width + 1 + 15) / 16 * 16 + HF_PAD, plane = width * (size_t)s->height;
    const size_t counts = ((size_t)c->threads * sizeof(struct hf_counts) + 63) / 64 * 64;
    r->line_floats = width + 2 * HF_PAD;
    r->worker_lines = HF_LINES + HF_DEPTH_LINES + more_lines;
    const size_t lines = (size_t)c->threads * r->worker_lines * r->line_floats;
    if (hf_block_grow(&c->surfaces, counts + (planes * plane + lines) * sizeof(float), &c->mem))
        return NULL;
    r->counts = c->surfaces.data;
    r->lines = (float *)((char *)c->surfaces.data + counts);
    r->setup = setup;
    r->pieces = (s->height + ROWS - 1) / ROWS;
    r->plane = plane;
    *r->known = (struct hf_known){.stride = (ptrdiff_t)width};
    for (int i = 0; i < count; i++) {
        setup[i] = *s;
        setup[i].channels = hf_image_channels(&r->in[i].image);
        hf_setup_depth(&setup[i], &r->in[i].depth, s->pixel_aspect);
    }
    for (int i = 0; i < c->threads; i++)
        r->counts[i] = (struct hf_counts){.radius_min = HUGE_VALF, .radius_max = -HUGE_VALF};
    return r->lines + lines;
}

static struct hf_surface surface_at(float *memory, size_t plane)
{
    return (struct hf_surface){.colour = {memory, memory + plane, memory + 2 * plane, memory + 3 * plane},
                               .weight = memory + 4 * plane,
                               .radius = memory + 5 * plane};
}

static int finish(struct reading *r, int pieces, void (*piece)(void *arg, int i, int worker))
{
    struct hf_context *c = r->c;
    if (c->pool)
        hf_pool_run(c->pool, pieces, piece, r);
    else
        c->config.parallel_for(c->config.parallel_cookie, pieces, piece, r);
    r->known->radius_min = HUGE_VALF;
    r->known->radius_max = -HUGE_VALF;
    for (int i = 0; i < c->threads; i++) {
        r->known->radius_min = fminf(r->known->radius_min, r->counts[i].radius_min);
        r->known->radius_max = fmaxf(r->known->radius_max, r->counts[i].radius_max);
    }
    return hf_stopped(r->s->stop) ? HF_ERR_CANCELLED : HF_OK;
}

int hf_surfaces_read(struct hf_context *c, struct hf_setup *s, const struct hf_surface_input *in, int count, int fused,
                     struct hf_known *known)
{
    struct hf_setup setup[HF_MOST_BEHIND];
    struct reading r = {.c = c, .s = s, .in = in, .known = known, .fused = fused};
    float *memory = begin(&r, setup, count, (size_t)count * 6, 0);
    if (!memory)
        return HF_ERR_MEMORY;
    known->count = count;
    for (int i = 0; i < count; i++, memory += 6 * r.plane)
        known->behind[i] = surface_at(memory, r.plane);
    return finish(&r, count * r.pieces, read_piece);
}

// A layer's sample in a pixel.
struct sample {
    int layer;
    float radius, alpha;
};

// The samples of a pixel, nearest first; of equally near ones the first layer's comes first.
static int sort_pixel(const struct reading *r, const float *const *lines, int x, struct sample *to)
{
    int n = 0;
    for (int i = 0; i < r->count; i++) {
        const struct sample s = {i, lines[5 * i + 4][x],
                                 r->setup[i].channels == 4 ? hf_saturate(lines[5 * i + 3][x]) : 1};
        int at = n;
        if (!(s.alpha > 0))
            continue;
        for (; at > 0 && to[at - 1].radius > s.radius; at--)
            to[at] = to[at - 1];
        to[at] = s;
        n++;
    }
    return n;
}

// Merge the samples of a pixel: what is visible, the front surface and the rest, and what the front hides.
static void merge_pixel(const struct reading *r, const float *const *lines, int x, ptrdiff_t at, float empty,
                        struct hf_counts *counts)
{
    struct sample s[HF_MOST_LAYERS];
    const struct hf_known *known = r->known;
    const int n = sort_pixel(r, lines, x, s);
    float open = 1, sum[4] = {0}, rest = 0, rest_weight = 0;
    int hidden = 0;
    for (int i = 0; i < n; i++) {
        const float v = s[i].alpha * open, h = s[i].alpha - v, part = v / s[i].alpha;
        const float *const *line = lines + 5 * s[i].layer;
        for (int c = 0; c < 4; c++) {
            const float colour = c < 3 || r->setup[s[i].layer].channels == 4 ? line[c][x] : 1;
            sum[c] = sum[c] + part * colour;
            if (i == 0)
                known->front.colour[c][at] = colour;
            if (h > 0 && hidden < HF_MOST_BEHIND)
                known->behind[hidden].colour[c][at] = (1 - part) * colour;
        }
        if (h > 0 && hidden < HF_MOST_BEHIND) {
            known->behind[hidden].weight[at] = h;
            known->behind[hidden++].radius[at] = s[i].radius;
        }
        rest = i > 0 && v > rest_weight ? s[i].radius : rest;
        rest_weight = i > 0 && v > rest_weight ? v : rest_weight;
        open = open - v;
        counts->radius_min = fminf(counts->radius_min, s[i].radius);
        counts->radius_max = fmaxf(counts->radius_max, s[i].radius);
    }
    while (hidden < HF_MOST_BEHIND)
        known->behind[hidden++].weight[at] = 0;
    for (int c = 0; c < 4; c++)
        r->picture[c][at] = sum[c];
    known->front.weight[at] = n ? s[0].alpha : 0;
    known->front.radius[at] = n ? s[0].radius : empty;
    known->rest[at] = rest_weight >= open ? rest : empty;
    // As a renderer's depth has it: what fills most of the pixel.
    r->picture[4][at] = n && s[0].alpha >= 0.5f ? s[0].radius : known->rest[at];
    counts->radius_max = open > 0 ? fmaxf(counts->radius_max, empty) : counts->radius_max;
}

// Whether a pixel of a layer has a part of a surface, and the depth of none: renderers sample the depth of an edge's pixel
// once, beside the surface too. A radius this near that of nothing is blurred like it.
static int is_lost(const struct reading *r, const struct hf_setup *s, const float *const *line, int x)
{
    const float beside = 1e-3f;
    return s->channels == 4 && line[3][x] > 0 && line[3][x] < 1 && line[4][x] >= r->empty - beside;
}

// Give such pixels of a row the radius of the nearest surface around.
static void find_lost(const struct reading *r, const struct hf_frame *f, int y, float *const line[5], float *lines)
{
    const struct hf_setup *s = f->s;
    float *found = lines + 5 * r->line_floats, *around[5];
    int lost = 0;
    for (int x = 0; x < s->width && s->form != HF_FORM_COC; x++)
        lost |= is_lost(r, s, (const float *const *)line, x);
    if (!lost)
        return;
    for (int x = 0; x < s->width; x++)
        found[x] = line[4][x];
    for (int c = 0; c < 5; c++)
        around[c] = lines + (size_t)c * r->line_floats;
    for (int v = hf_max(y - FOUND_REACH, 0); v <= hf_min(y + FOUND_REACH, s->height - 1); v++) {
        hf_read_pixels(f, 0, v, s->half_width, around, f->seen);
        f->k->radius_row(f, 0, v, s->width, around[4], NULL);
        for (int x = 0; x < s->width; x++)
            if (is_lost(r, s, (const float *const *)line, x))
                for (int u = hf_max(x - FOUND_REACH, 0); u <= hf_min(x + FOUND_REACH, s->width - 1); u++)
                    found[x] = around[3][u] > 0 && around[4][u] < found[x] ? around[4][u] : found[x];
    }
    for (int x = 0; x < s->width; x++)
        line[4][x] = found[x];
}

static void merge_piece(void *arg, int i, int worker)
{
    const struct reading *r = arg;
    const float *lines[5 * HF_MOST_LAYERS];
    for (int y = i * ROWS; y < hf_min(i * ROWS + ROWS, r->s->height) && !hf_stopped(r->s->stop); y++) {
        for (int k = 0; k < r->count; k++) {
            const struct hf_frame f = frame_of(r, k, worker);
            float *to[5];
            for (int c = 0; c < 5; c++) {
                to[c] = f.depth_lines + (size_t)(HF_DEPTH_LINES + 5 * k + c) * r->line_floats;
                lines[5 * k + c] = to[c];
            }
            hf_read_pixels(&f, 0, y, r->s->half_width, to, f.seen);
            f.k->radius_row(&f, 0, y, r->s->width, to[4], NULL);
            find_lost(r, &f, y, to, f.depth_lines + (size_t)(HF_DEPTH_LINES + 5 * r->count) * r->line_floats);
        }
        for (int x = 0; x < r->s->width; x++)
            merge_pixel(r, lines, x, y * r->known->stride + x, r->empty, &r->counts[worker]);
    }
}

int hf_surfaces_merge(struct hf_context *c, const struct hf_setup *s, const struct hf_surface_input *in, int count,
                      int fused, struct hf_merged *merged, struct hf_known *known)
{
    struct hf_setup setup[HF_MOST_LAYERS];
    struct reading r = {.c = c, .s = s, .in = in, .known = known, .fused = fused, .count = count};
    float *memory = begin(&r, setup, count, 6 * (HF_MOST_BEHIND + 1) + 6, 5 * (size_t)count + FOUND_LINES);
    if (!memory)
        return HF_ERR_MEMORY;
    known->count = HF_MOST_BEHIND;
    known->edges = 1;
    for (int i = 0; i <= HF_MOST_BEHIND; i++, memory += 6 * r.plane)
        *(i < HF_MOST_BEHIND ? &known->behind[i] : &known->front) = surface_at(memory, r.plane);
    for (int i = 0; i < 6; i++)
        *(i < 5 ? &r.picture[i] : &known->rest) = memory + (size_t)i * r.plane;
    // Where no layer has anything there is nothing, infinitely far away.
    const float nothing = INFINITY;
    const struct hf_depth far = {.data = &nothing, .stride = sizeof nothing};
    struct hf_setup empty = *s;
    struct hf_frame f = {.s = &empty,
                         .k = &c->kernels[fused],
                         .depth = &far,
                         .lines = r.lines,
                         .depth_lines = r.lines,
                         .line_floats = r.line_floats};
    empty.width = empty.height = 1;
    if (s->form == HF_FORM_COC)
        r.empty = s->max_radius;
    else {
        hf_setup_depth(&empty, &far, s->pixel_aspect);
        hf_radius_row_c(&f, 0, 0, 1, &r.empty, NULL);
    }
    merged->image = (struct hf_image){
        .size = sizeof merged->image, .width = s->width, .height = s->height, .format = HF_FORMAT_PLANAR32F};
    for (int i = 0; i < 4; i++) {
        merged->image.data[i] = r.picture[i];
        merged->image.stride[i] = known->stride * (ptrdiff_t)sizeof(float);
    }
    merged->depth = (struct hf_depth){.size = sizeof merged->depth,
                                      .data = r.picture[4],
                                      .stride = known->stride * (ptrdiff_t)sizeof(float),
                                      .type = HF_DEPTH_COC};
    return finish(&r, r.pieces, merge_piece);
}
