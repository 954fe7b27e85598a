// SPDX-License-Identifier: BSD-3-Clause
// The passes of layers, over the frame's buffers.
#include <string.h>

#include "engine/layers/cell.h"
#include "engine/layers/hidden.h"
#include "engine/layers/highlights.h"
#include "engine/layers/slices.h"
#include "engine/layers/unmix.h"
#include "pixel/pass_c.h"

enum { TILE = HF_LAYERS_TILE };

// Whether any of n numbers is beyond `largest` in size. It compares bits as integers, which costs next to nothing.
static int has_larger(const float *v, int n, float largest)
{
    const uint32_t most = hf_bits(largest);
    uint32_t any = 0;
    for (int i = 0; i < n; i++)
        any |= (uint32_t)((hf_bits(v[i]) & 0x7fffffff) > most);
    return any != 0;
}

static int has_other_than_one(const float *v, int n)
{
    int any = 0;
    for (int i = 0; i < n; i++)
        any |= v[i] != 1;
    return any;
}

// Clamps n numbers; returns how many it changed.
static int limit(float *v, int n, float largest)
{
    int count = 0;
    for (int i = 0; i < n; i++) {
        const float was = v[i];
        v[i] = was > largest ? largest : was < -largest ? -largest : was;
        count += v[i] != was;
    }
    return count;
}

void hf_layers_load_pass(const struct hf_frame *f, struct hf_rect r)
{
    const int x0 = 2 * r.x0, n = hf_min(2 * r.x1, f->s->width) - x0;
    const float largest = hf_layers(f->s)->largest;
    int large = 0, transparent = 0;
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        float *colour[4] = {NULL};
        hf_row(&f->buf[HF_LAYERS_BUF_COLOUR], f->s->channels, x0, y, colour);
        hf_read_pixels(f, r.x0, y, r.x1 - r.x0, colour, f->seen);
        transparent |= f->s->channels == 4 && has_other_than_one(colour[3], n);
        for (int c = 0; c < f->s->channels; c++)
            large += has_larger(colour[c], n, largest) ? limit(colour[c], n, largest) : 0;
        f->k->radius_row(f, x0, y, n, hf_at(&f->buf[HF_LAYERS_BUF_RADIUS], 0, x0, y), NULL);
    }
    if (large || f->seen->colour_repaired)
        atomic_store_explicit(hf_layers(f->s)->repaired, 1, memory_order_relaxed);
    if (transparent)
        atomic_store_explicit(hf_layers(f->s)->transparent, 1, memory_order_relaxed);
}

// Clamped samples are counted here, where they show, because cells also load their neighbours' samples.
static void count_row(const struct hf_frame *f, struct hf_rect r, int y)
{
    float *was[4];
    for (int c = 0; c < 4; c++)
        was[c] = hf_line(f, 8 + c);
    hf_read_pixels(f, r.x0, y, r.x1 - r.x0, was, f->counts);
    for (int c = 0; c < f->s->channels; c++)
        f->counts->clamped +=
            (uint64_t)limit(was[c], hf_min(2 * r.x1, f->s->width) - 2 * r.x0, hf_layers(f->s)->largest);
}

void hf_layers_set_colours(const struct hf_frame *f, int b, struct hf_rect r, float to)
{
    const int full = b == HF_LAYERS_BUF_SEEN || b == HF_LAYERS_BUF_MIXED;
    const int x0 = r.x0 << full, x1 = full ? hf_min(2 * r.x1, f->s->width) : r.x1;
    const int y1 = full ? hf_min(2 * r.y1, f->s->height) : r.y1;
    for (int c = 0; c < f->s->channels; c++)
        for (int y = r.y0 << full; y < y1; y++)
            for (int x = x0; x < x1; x++)
                *hf_at(&f->buf[b], c, x, y) = to;
}

// All steps run on a row of tiles before the next row, so what one step makes is still in the cache for the next.
void hf_layers_unmix_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_layers *l = hf_layers(f->s);
    const size_t tiles = (size_t)(2 * (r.x1 - r.x0) + TILE - 1) / TILE;
    float *means = f->work + hf_layers_unmix_floats(2 * (r.x1 - r.x0));
    uint8_t *flags = (uint8_t *)(means + hf_layers_highlight_floats(r.x1 - r.x0, r.y1 - r.y0));
    const struct hf_layers_any any = {flags, flags + tiles};
    if (l->set.highlights)
        hf_layers_highlight_means(f, r, means);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y += TILE / 2) {
        const struct hf_rect rows = {r.x0, y, r.x1, hf_min(y + TILE / 2, r.y1)};
        memset(flags, 0, 2 * tiles);
        hf_layers_unmix_rows(f, rows, y == r.y0, any.mixed);
        if (hf_layers(f->s)->given && hf_layers(f->s)->given->edges) {
            hf_layers_take_edges(f, rows);
            memset(any.mixed, 1, tiles);
        }
        if (l->levels) {
            hf_layers_quads_pass(f, rows);
            if (l->set.highlights)
                hf_layers_leave_lamps(f, r, rows, means);
        }
        if (l->set.highlights)
            hf_layers_highlights(f, r, rows, means, &any);
        hf_layers_mark_seen(f, rows, &any);
    }
    if (l->guessed) {
        hf_layers_set_colours(f, HF_LAYERS_BUF_SEEN, r, 1);
        hf_layers_set_colours(f, HF_LAYERS_BUF_MIXED, r, 1);
    }
}

static struct hf_layers_set set_of(const struct hf_buf *colour, const struct hf_buf *at)
{
    struct hf_layers_set s = {.weight = at->ch[0], .radius = at->ch[1], .stride = at->stride};
    memcpy(s.colour, colour->ch, sizeof s.colour);
    return s;
}

size_t hf_layers_composite_floats(const struct hf_layers *l, int width, int height)
{
    const size_t planes = (size_t)l->channels + (l->groups == 3 ? 4 : 0);
    return hf_layers_cell_floats(l, width, height) + planes * (size_t)width * (size_t)height + HF_PAD;
}

// Make the channels of one group. All channels are computed, because they share their weight; only the group's are
// kept.
static void make_group(const struct hf_frame *f, const struct hf_layers *l, const struct hf_samples *samples,
                       struct hf_rect tiles, int group, float *memory, float *const out[4])
{
    const size_t pixels = (size_t)(tiles.x1 - tiles.x0) * (size_t)(tiles.y1 - tiles.y0);
    struct hf_layers of = *l;
    float *to[4];
    memcpy(to, out, sizeof to);
    hf_layers_use_group(&of, group);
    for (int c = 0; l->groups == 3 && c < l->channels; c++)
        to[c] = group == (c < 3 ? c : 1) ? out[c] : memory + (size_t)c * pixels;
    hf_layers_cell(&of, samples, hf_layers_kernels(f), tiles, memory + (l->groups == 3 ? 4 : 0) * pixels, to,
                   tiles.x1 - tiles.x0);
}

// From how much of the light is known to how much is guessed.
static void tell_guessed(const struct hf_frame *f, float *const row[4], int n, int channels)
{
    for (int c = 0; c < channels; c++)
        for (int x = 0; x < n; x++)
            row[c][x] = c < 3 ? hf_saturate(1 - row[c][x]) : 1;
    for (int x = 0; x < n; x++)
        f->counts->guessed += (uint64_t)(row[0][x] * 0x1p24f);
    f->counts->looked_at += (uint64_t)n;
}

void hf_layers_composite_pass(const struct hf_frame *f, struct hf_rect r)
{
    struct hf_layers l = *hf_layers(f->s);
    const struct hf_samples samples = {
        .seen = set_of(&f->buf[HF_LAYERS_BUF_SEEN], &f->buf[HF_LAYERS_BUF_SEEN_AT]),
        .mixed = set_of(&f->buf[HF_LAYERS_BUF_MIXED], &f->buf[HF_LAYERS_BUF_MIXED_AT]),
        .hidden = set_of(&f->buf[l.known ? HF_LAYERS_BUF_SECOND : HF_LAYERS_BUF_HIDDEN],
                         &f->buf[l.known ? HF_LAYERS_BUF_SECOND_AT : HF_LAYERS_BUF_HIDDEN_AT]),
        .beyond = set_of(&f->buf[l.known ? HF_LAYERS_BUF_THIRD : HF_LAYERS_BUF_BEYOND],
                         &f->buf[l.known ? HF_LAYERS_BUF_THIRD_AT : HF_LAYERS_BUF_BEYOND_AT]),
        .share = f->buf[HF_LAYERS_BUF_SEEN_AT].ch[2]};
    const int x0 = 2 * r.x0, y0 = 2 * r.y0, x1 = hf_min(2 * r.x1, f->s->width), y1 = hf_min(2 * r.y1, f->s->height);
    const struct hf_rect tiles = {x0 / TILE * TILE, y0 / TILE * TILE, (x1 + TILE - 1) / TILE * TILE,
                                  (y1 + TILE - 1) / TILE * TILE};
    const int width = tiles.x1 - tiles.x0, height = tiles.y1 - tiles.y0, channels = l.channels;
    float *memory = f->work, *out[4] = {NULL};
    for (int c = 0; c < channels; c++, memory += (size_t)width * (size_t)height)
        out[c] = memory;
    l.channels = hf_layers_drawn(&l);
    for (int i = 0; l.channels < channels && i < width * height; i++)
        out[3][i] = 1;
    const int repaired = atomic_load_explicit(l.repaired, memory_order_relaxed);
    for (int g = 0; g < l.groups; g++)
        make_group(f, &l, &samples, tiles, g, memory, out);
    for (int y = y0; y < y1 && !hf_stopped(f->s->stop); y++) {
        float *row[4] = {NULL};
        if (repaired)
            count_row(f, r, y);
        for (int c = 0; c < channels; c++)
            row[c] = out[c] + (ptrdiff_t)(y - tiles.y0) * width + x0 - tiles.x0;
        if (l.guessed)
            tell_guessed(f, row, x1 - x0, channels);
        hf_store_rgb(f, row, x1 - x0);
        hf_write_pixels(f, r.x0, y, r.x1 - r.x0, (const float *const *)row, channels == 4);
    }
}
