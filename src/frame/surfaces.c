// SPDX-License-Identifier: BSD-3-Clause
#include "frame/surfaces.h"

#include <math.h>
#include <string.h>

#include "pixel/depth.h"
#include "pixel/format.h"
#include "frame/reading.h"
#include "pixel/pass_c.h"

enum {
    ROWS = HF_READING_ROWS,
    FOUND_REACH = 2,  // how far from an edge's pixel its surface is looked for
    FOUND_LINES = 6,  // for that: a row of a layer, and what was found
    LINES = 6         // of a layer's row: colour, radius, and what a surface's distance was found to be, else NaN
};

struct hf_frame hf_reading_frame(const struct hf_reading *r, int surface, int worker)
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
static void read_row(const struct hf_reading *r, const struct hf_frame *f, const struct hf_surface *to, int y)
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
    const struct hf_reading *r = arg;
    const int surface = i / r->pieces, y0 = i % r->pieces * ROWS;
    const struct hf_frame f = hf_reading_frame(r, surface, worker);
    for (int y = y0; y < hf_min(y0 + ROWS, r->s->height) && !hf_stopped(r->s->stop); y++)
        read_row(r, &f, &r->known->behind[surface], y);
}

// Place memory for `planes` planes of the frame's size and for the workers. Returns the first plane, or NULL.
float *hf_reading_begin(struct hf_reading *r, struct hf_setup *setup, int count, size_t planes, size_t more_lines)
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

int hf_reading_finish(struct hf_reading *r, int pieces, void (*piece)(void *arg, int i, int worker))
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
    struct hf_reading r = {.c = c, .s = s, .in = in, .known = known, .fused = fused};
    float *memory = hf_reading_begin(&r, setup, count, (size_t)count * 6, 0);
    if (!memory)
        return HF_ERR_MEMORY;
    known->count = count;
    for (int i = 0; i < count; i++, memory += 6 * r.plane)
        known->behind[i] = surface_at(memory, r.plane);
    return hf_reading_finish(&r, count * r.pieces, read_piece);
}

// Whether one sample is behind another of the same blur: where blur is cut off, or nothing is blurred, distances count. A pixel
// that has the radius of the surface beside it has no distance of its own.
static int behind(const struct hf_reading *r, const struct hf_frame *frames, const float *const *lines, int x, int y,
                  const int layer[2])
{
    float v[2];
    for (int i = 0; i < 2; i++) {
        const float found = lines[LINES * layer[i] + 5][x];
        v[i] = isnan(found) ? hf_coc_variable(&frames[layer[i]], x, y, NULL) : found;
    }
    return r->s->form != HF_FORM_COC && v[0] > v[1];
}

// The samples of a pixel, nearest first; of equally near ones the first layer's comes first.
static int sort_pixel(const struct hf_reading *r, const struct hf_frame *frames, const float *const *lines, int x,
                      int y, struct hf_sample *to)
{
    int layer[HF_MOST_LAYERS], n = 0;
    for (int i = 0; i < r->count; i++) {
        const float *const *line = lines + LINES * i;
        const int channels = r->setup[i].channels;
        struct hf_sample s = {.radius = line[4][x], .alpha = channels == 4 ? hf_saturate(line[3][x]) : 1};
        int at = n;
        if (!(s.alpha > 0))
            continue;
        for (int c = 0; c < 4; c++)
            s.colour[c] = c < 3 || channels == 4 ? line[c][x] : 1;
        for (; at > 0 &&
               (to[at - 1].radius > s.radius ||
                (to[at - 1].radius == s.radius && behind(r, frames, lines, x, y, (const int[]){layer[at - 1], i})));
             at--) {
            to[at] = to[at - 1];
            layer[at] = layer[at - 1];
        }
        to[at] = s;
        layer[at] = i;
        n++;
    }
    return n;
}

void hf_merge_pixel(const struct hf_reading *r, const struct hf_sample *s, int n, ptrdiff_t at,
                    struct hf_counts *counts)
{
    const struct hf_known *known = r->known;
    const float empty = r->empty;
    float open = 1, sum[4] = {0}, rest = 0, rest_weight = 0;
    int hidden = 0;
    for (int i = 0; i < n; i++) {
        const float v = s[i].alpha * open, h = s[i].alpha - v, part = v / s[i].alpha;
        for (int c = 0; c < 4; c++) {
            const float colour = s[i].colour[c];
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
static int is_lost(const struct hf_reading *r, const struct hf_setup *s, const float *const *line, int x)
{
    const float beside = 1e-3f;
    return s->channels == 4 && line[3][x] > 0 && line[3][x] < 1 && line[4][x] >= r->empty - beside;
}

// Give such pixels of a row the radius of the nearest surface around, and note its distance.
static void find_lost(const struct hf_reading *r, const struct hf_frame *f, int y, float *const line[LINES],
                      float *lines)
{
    const struct hf_setup *s = f->s;
    float *found = lines + 5 * r->line_floats, *around[5];
    int lost = 0;
    for (int x = 0; x < s->width; x++) {
        lost |= s->form != HF_FORM_COC && is_lost(r, s, (const float *const *)line, x);
        line[5][x] = NAN;
        found[x] = line[4][x];
    }
    if (!lost)
        return;
    for (int c = 0; c < 5; c++)
        around[c] = lines + (size_t)c * r->line_floats;
    for (int v = hf_max(y - FOUND_REACH, 0); v <= hf_min(y + FOUND_REACH, s->height - 1); v++) {
        hf_read_pixels(f, 0, v, s->half_width, around, f->seen);
        f->k->radius_row(f, 0, v, s->width, around[4], NULL);
        for (int x = 0; x < s->width; x++)
            for (int u = hf_max(x - FOUND_REACH, 0);
                 is_lost(r, s, (const float *const *)line, x) && u <= hf_min(x + FOUND_REACH, s->width - 1); u++)
                if (around[3][u] > 0 && around[4][u] < found[x]) {
                    found[x] = around[4][u];
                    line[5][x] = hf_coc_variable(f, u, v, NULL);
                }
    }
    for (int x = 0; x < s->width; x++)
        line[4][x] = found[x];
}

static void merge_piece(void *arg, int i, int worker)
{
    const struct hf_reading *r = arg;
    const float *lines[LINES * HF_MOST_LAYERS];
    struct hf_frame frames[HF_MOST_LAYERS];
    struct hf_sample samples[HF_MOST_LAYERS];
    for (int k = 0; k < r->count; k++)
        frames[k] = hf_reading_frame(r, k, worker);
    float *more = frames[0].depth_lines + (size_t)HF_DEPTH_LINES * r->line_floats;
    for (int y = i * ROWS; y < hf_min(i * ROWS + ROWS, r->s->height) && !hf_stopped(r->s->stop); y++) {
        for (int k = 0; k < r->count; k++) {
            float *to[LINES];
            for (int c = 0; c < LINES; c++)
                lines[LINES * k + c] = to[c] = more + (size_t)(LINES * k + c) * r->line_floats;
            hf_read_pixels(&frames[k], 0, y, r->s->half_width, to, frames[k].seen);
            frames[k].k->radius_row(&frames[k], 0, y, r->s->width, to[4], NULL);
            find_lost(r, &frames[k], y, to, more + (size_t)(LINES * r->count) * r->line_floats);
        }
        for (int x = 0; x < r->s->width; x++) {
            const int n = sort_pixel(r, frames, lines, x, y, samples);
            hf_merge_pixel(r, samples, n, y * r->known->stride + x, &r->counts[worker]);
        }
    }
}

void hf_reading_merged(struct hf_reading *r, float *memory, struct hf_merged *merged)
{
    r->known->count = HF_MOST_BEHIND;
    r->known->edges = 1;
    for (int i = 0; i <= HF_MOST_BEHIND; i++, memory += 6 * r->plane)
        *(i < HF_MOST_BEHIND ? &r->known->behind[i] : &r->known->front) = surface_at(memory, r->plane);
    for (int i = 0; i < 6; i++)
        *(i < 5 ? &r->picture[i] : &r->known->rest) = memory + (size_t)i * r->plane;
    // Where no layer has anything there is nothing, infinitely far away.
    const float nothing = INFINITY;
    const struct hf_depth far = {.data = &nothing, .stride = sizeof nothing};
    struct hf_setup empty = *r->s;
    struct hf_frame f = {.s = &empty,
                         .k = &r->c->kernels[r->fused],
                         .depth = &far,
                         .lines = r->lines,
                         .depth_lines = r->lines,
                         .line_floats = r->line_floats};
    empty.width = empty.height = 1;
    if (r->s->form == HF_FORM_COC)
        r->empty = r->s->max_radius;
    else {
        hf_setup_depth(&empty, &far, r->s->pixel_aspect);
        hf_radius_row_c(&f, 0, 0, 1, &r->empty, NULL);
    }
    merged->image = (struct hf_image){
        .size = sizeof merged->image, .width = r->s->width, .height = r->s->height, .format = HF_FORMAT_PLANAR32F};
    for (int i = 0; i < 4; i++) {
        merged->image.data[i] = r->picture[i];
        merged->image.stride[i] = r->known->stride * (ptrdiff_t)sizeof(float);
    }
    merged->depth = (struct hf_depth){.size = sizeof merged->depth,
                                      .data = r->picture[4],
                                      .stride = r->known->stride * (ptrdiff_t)sizeof(float),
                                      .type = HF_DEPTH_COC};
}

int hf_surfaces_merge(struct hf_context *c, const struct hf_setup *s, const struct hf_surface_input *in, int count,
                      int fused, struct hf_merged *merged, struct hf_known *known)
{
    struct hf_setup setup[HF_MOST_LAYERS];
    struct hf_reading r = {.c = c, .s = s, .in = in, .known = known, .fused = fused, .count = count};
    float *memory = hf_reading_begin(&r, setup, count, HF_MERGED_PLANES, LINES * (size_t)count + FOUND_LINES);
    if (!memory)
        return HF_ERR_MEMORY;
    hf_reading_merged(&r, memory, merged);
    return hf_reading_finish(&r, r.pieces, merge_piece);
}
