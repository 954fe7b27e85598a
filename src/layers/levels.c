// SPDX-License-Identifier: BSD-3-Clause
// The levels of hidden samples, and what is found in them.
#include <math.h>
#include <string.h>

#include "layers/hidden.h"
#include "pixel/pass_c.h"

enum { STEP = 128, PAD = 32 };  // samples that are looked for at once; floats around a row

int hf_layers_hidden_reach(const struct hf_layers *l)
{
    return l->levels ? 1 << l->levels : 0;
}

// A band's levels: rows from above it to below.
struct band {
    const struct hf_frame *f;
    const struct hf_layers *l;
    struct hf_rect r;
    int reach;
    struct hf_layers_set level[HF_LAYERS_LEVELS], across;
};

static size_t plane_floats(const struct hf_layers *l, int width, int height)
{
    const size_t reach = (size_t)hf_layers_hidden_reach(l);
    return (((size_t)width + 2 * reach + 15) / 16 * 16 + 2 * PAD) * ((size_t)height + 2 * reach);
}

size_t hf_layers_hidden_floats(const struct hf_layers *l, int width, int height)
{
    return (size_t)l->levels * (size_t)(l->channels + 2) * plane_floats(l, width, height);
}

static struct hf_layers_set place(const struct band *b, float **memory)
{
    const int width = b->r.x1 - b->r.x0, height = b->r.y1 - b->r.y0;
    struct hf_layers_set s = {.stride = (width + 2 * b->reach + 15) / 16 * 16 + 2 * PAD};
    float **const plane[6] = {&s.colour[0], &s.colour[1], &s.colour[2], &s.weight, &s.radius, &s.colour[3]};
    for (int i = 0; i < b->l->channels + 2; i++) {
        *plane[i] = *memory + (b->reach - b->r.y0) * s.stride + b->reach + PAD - b->r.x0;
        *memory += plane_floats(b->l, width, height);
    }
    return s;
}

static void planes_of(const struct hf_layers_set *s, int channels, int x, int y, float *out[6])
{
    const ptrdiff_t at = y * s->stride + x;
    for (int c = 0; c < channels; c++)
        out[c] = s->colour[c] + at;
    out[4] = s->weight + at;
    out[5] = s->radius + at;
}

// Merge samples (dx, dy) apart, in an area `reach` larger than the band.
static void merge(const struct band *b, const struct hf_layers_set *from, const struct hf_layers_set *to, int dx,
                  int dy, int reach_x, int reach_y, float slope)
{
    const int x = b->r.x0 - reach_x, n = b->r.x1 + reach_x - x, channels = b->l->channels;
    for (int y = b->r.y0 - reach_y; y < b->r.y1 + reach_y; y++) {
        float *in[3][6] = {{NULL}}, *out[6];
        for (int i = 0; i < 3; i++)
            planes_of(from, channels, x + (i - 1) * dx, y + (i - 1) * dy, in[i]);
        planes_of(to, channels, x, y, out);
        hf_layers_kernels(b->f)->merge((const float *const(*)[6])in, channels, slope, n, out);
    }
}

// Level j is made where the later ones and the search read it.
static void make_levels(struct band *b)
{
    const int levels = b->l->levels;
    for (int j = 1; j < levels; j++) {
        const int step = 1 << (j - 1), reach = (1 << levels) - (1 << j);
        const float slope = 1.0f / (float)(2 << j);
        merge(b, &b->level[j - 1], &b->across, step, 0, reach, reach + step, slope);
        merge(b, &b->across, &b->level[j], 0, step, reach, reach, slope);
    }
}

// The least radius of what is seen in each quad of a row.
static void nearest_of(const struct band *b, int x, int n, int y, float *out)
{
    const float *above = hf_at(&b->f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 2 * x, 2 * y);
    const float *below = hf_at(&b->f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 2 * x, 2 * y + 1);
    for (int i = 0; i < n; i++) {
        const float top = above[2 * i] < above[2 * i + 1] ? above[2 * i] : above[2 * i + 1];
        const float low = below[2 * i] < below[2 * i + 1] ? below[2 * i] : below[2 * i + 1];
        out[i] = top < low ? top : low;
    }
}

// How much of a quad there is more than a pixel of radius before r.
static float covered(const struct band *b, int x, int y, float r)
{
    const struct hf_buf *at = &b->f->buf[HF_LAYERS_BUF_SEEN_AT];
    float sum = 0;
    for (int i = 0; i < 4; i++) {
        const int px = 2 * x + (i & 1), py = 2 * y + (i >> 1);
        sum += *hf_at(at, 1, px, py) < r - 1 ? *hf_at(at, 0, px, py) : 0;
    }
    return sum * 0.25f;
}

static void find(const struct band *b, int x, int n, int y)
{
    static const float distance[3] = {0, 1, 1.41421356f}, share[3] = {1, 0.5f, 0.25f};
    const int channels = b->l->channels;
    _Alignas(64) float memory[7][STEP + PAD];
    float *sum[6], part = 1;
    memset(memory, 0, sizeof memory);
    for (int i = 0; i < 6; i++)
        sum[i] = memory[i];
    nearest_of(b, x, n, y, memory[6]);
    for (int j = 0; j < b->l->levels; j++, part *= 1.0f / 16)
        for (int i = 0; i < 9; i++) {
            const int u = i % 3 - 1, v = i / 3 - 1, away = (u != 0) + (v != 0);
            float *in[6] = {NULL};
            planes_of(&b->level[j], channels, x + u * (1 << j), y + v * (1 << j), in);
            hf_layers_kernels(b->f)->tap((const float *const *)in, channels, memory[6], 1.0f / (float)(2 << j),
                                         0.5f - distance[away], part * share[away], n, sum);
        }
    for (int i = 0; i < n; i++) {
        const float inverse = sum[4][i] > 0 ? 1 / sum[4][i] : 0, r = sum[5][i] * inverse;
        *hf_at(&b->f->buf[HF_LAYERS_BUF_HIDDEN_AT], 0, x + i, y) = sum[4][i] > 0 ? covered(b, x + i, y, r) : 0;
        *hf_at(&b->f->buf[HF_LAYERS_BUF_HIDDEN_AT], 1, x + i, y) = r;
        for (int c = 0; c < channels; c++)
            *hf_at(&b->f->buf[HF_LAYERS_BUF_HIDDEN], c, x + i, y) = (sum[c][i] * inverse) * (sum[c][i] * inverse);
    }
}

// Samples of a tile.
struct tile {
    const float *radius, *weight;
    ptrdiff_t stride;
    int n, rows;
};

static struct tile tile_of(const struct hf_buf *at, int weight, int x, int y, int n, int rows)
{
    return (struct tile){hf_at(at, 1, x, y), hf_at(at, weight, x, y), at->stride, n, rows};
}

// Which slices have samples of a tile whose radii lie in a range.
static void mark_slices(const struct hf_frame *f, struct tile t, struct hf_layers_range range,
                        const struct hf_slice *slice, uint64_t *bits)
{
    const struct hf_layers *l = hf_layers(f->s);
    memset(bits, 0, sizeof *bits * (size_t)l->words);
    for (int i = 0; range.low <= range.high && i < l->slices && slice[i].before < range.high; i++)
        if (slice[i].after > range.low &&
            hf_layers_kernels(f)->inside(t.radius, t.weight, t.stride, t.n, t.rows, slice[i].before, slice[i].after))
            bits[i / 64] |= (uint64_t)1 << i % 64;
}

// Which radii and slices there are in the tiles of a band.
static void mark_tiles(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_layers *l = hf_layers(f->s);
    const struct hf_layers_kernels *k = hf_layers_kernels(f);
    const struct hf_buf *seen = &f->buf[HF_LAYERS_BUF_SEEN_AT], *mixed = &f->buf[HF_LAYERS_BUF_MIXED_AT];
    const struct hf_buf *hidden = &f->buf[HF_LAYERS_BUF_HIDDEN_AT];
    const int size = HF_LAYERS_TILE, half = size / 2;
    for (int ty = r.y0 / half; ty * half < r.y1; ty++)
        for (int tx = r.x0 / half; tx * half < r.x1; tx++) {
            const int x = tx * size, y = ty * size, at = ty * l->columns + tx, mark = at * l->words;
            const int n = hf_min(size, f->s->width - x), rows = hf_min(size, f->s->height - y);
            const struct hf_layers_range none = {HUGE_VALF, -HUGE_VALF};
            const struct tile s = tile_of(seen, 0, x, y, n, rows), m = tile_of(mixed, 0, x, y, n, rows);
            const float *share = l->set.highlights ? hf_at(seen, 2, x, y) : NULL;
            l->seen_range[at] = l->mixed_range[at] = l->hidden_range[at] = none;
            const int bright = k->extremes(s.radius, s.weight, share, s.stride, n, rows, &l->seen_range[at]);
            k->extremes(m.radius, m.weight, NULL, m.stride, n, rows, &l->mixed_range[at]);
            mark_slices(f, s, l->seen_range[at], l->slice, &l->seen_marks[mark]);
            mark_slices(f, m, l->mixed_range[at], l->slice, &l->mixed_marks[mark]);
            mark_slices(f, tile_of(seen, share ? 2 : 0, x, y, n, rows), bright ? l->seen_range[at] : none, l->slice,
                        &l->share_marks[mark]);
            if (!l->levels)
                continue;
            const struct tile h = tile_of(hidden, 0, x / 2, y / 2, (n + 1) / 2, (rows + 1) / 2);
            k->extremes(h.radius, h.weight, NULL, h.stride, h.n, h.rows, &l->hidden_range[at]);
            mark_slices(f, h, l->hidden_range[at], l->slice, &l->hidden_marks[mark]);
        }
}

void hf_layers_hidden_pass(const struct hf_frame *f, struct hf_rect r)
{
    struct band b = {.f = f, .l = hf_layers(f->s), .r = r, .reach = hf_layers_hidden_reach(hf_layers(f->s))};
    float *memory = f->work;
    if (b.l->levels) {
        const struct hf_buf *colour = &f->buf[HF_LAYERS_BUF_QUADS], *at = &f->buf[HF_LAYERS_BUF_QUADS_AT];
        b.level[0] = (struct hf_layers_set){.weight = at->ch[0], .radius = at->ch[1], .stride = colour->stride};
        memcpy(b.level[0].colour, colour->ch, sizeof colour->ch);
        b.across = place(&b, &memory);
        for (int j = 1; j < b.l->levels; j++)
            b.level[j] = place(&b, &memory);
        make_levels(&b);
        for (int y = r.y0; y < r.y1; y++)
            for (int x = r.x0; x < r.x1; x += STEP)
                find(&b, x, hf_min(STEP, r.x1 - x), y);
    }
    mark_tiles(f, r);
}
