// SPDX-License-Identifier: BSD-3-Clause
// The planes that views read: what each slice holds, as colours and weights.
#include <math.h>
#include <string.h>

#include "base/bits.h"
#include "engine/layers/slices.h"
#include "engine/layers/view_block.h"

enum {
    SPARE = 32,        // floats after a row, which runs of pixels may pass
    FAR_OFF = 1 << 24  // farther than any pixel of a plane
};

// How far views displace a slice, in pixels.
static double radius_of(const struct hf_layers *l, int slice)
{
    return fabs(hf_layers_view_radius(l, l->group_used, slice)) * hf_layers_view_width(l);
}

// log2 of the pixel size of a slice's planes. A point of the lens stands for what lies around it, so a slice of the near stack
// needs no finer pixels than its views are apart. Then few points do: with 24 of them on `foliage` 34.27 dB, and 34.11 with planes
// as fine as the picture. Over the whole picture, beside lamps, that would let it jump.
static int level_of(const struct hf_view_block *b, double radius)
{
    const double apart = radius * sqrt(M_PI / b->c.l->set.views);
    const double size = b->c.l->set.near_only ? apart : radius / 8;
    return hf_max(size < 2 ? 0 : size < 4 ? 1 : size < 8 ? 2 : 3, b->unit);
}

// Set the size of a slice's planes; returns how many floats they take.
static size_t shape_plane(const struct hf_view_block *b, int slice, struct hf_slice_plane *p)
{
    const double r = radius_of(b->c.l, slice);
    p->level = level_of(b, r);
    // A displacement is rounded to a whole pixel, and one pixel around the block may be made.
    p->around = ((int)ceil(r) + 1 + 2 * b->unit + (1 << p->level) + TILE - 1) / TILE;
    p->channel = (b->c.columns + 2 * p->around) * b->tile + SPARE;
    p->row = p->channel * (b->c.l->channels + 1);
    return (size_t)p->row * (size_t)((b->c.rows + 2 * p->around) * TILE >> p->level);
}

// Whether views have planes for a slice, its own or one before it.
static int is_in(const struct hf_layers *l, int slice)
{
    return radius_of(l, slice) <= (double)hf_layers_view_most(l) &&
           (!l->set.near_only || (l->slice[slice].level > 0 && l->slice[slice].radius < 0));
}

// Whether a slice has planes of its own.
static int has_planes(const struct hf_layers *l, int slice)
{
    return is_in(l, slice) && hf_layers_view_slice(l, slice) == slice;
}

void hf_layers_place_planes(struct hf_view_block *b, struct hf_scratch *m)
{
    const struct hf_layers *l = b->c.l;
    const size_t slices = (size_t)l->slices;
    b->plane = (struct hf_slice_plane *)(void *)hf_layers_take(m, slices * sizeof *b->plane / sizeof(float), 0);
    b->list = (struct hf_view_plane *)(void *)hf_layers_take(m, slices * sizeof *b->list / sizeof(float), 0);
    const size_t rows = (size_t)(b->c.rows + 2);
    b->blended = (uint64_t *)(void *)hf_layers_take(m, 2 * rows, 0);
    uint64_t *reached = (uint64_t *)(void *)hf_layers_take(m, 2 * slices * rows, 0);
    for (int i = 0; m->memory && i < l->slices; i++)
        b->plane[i] = (struct hf_slice_plane){.reached = reached + i * (b->c.rows + 2)};
    for (int i = 0; i < l->slices; i++) {
        struct hf_slice_plane p;
        if (!has_planes(l, i))
            continue;
        shape_plane(b, i, &p);
        uint64_t *cleared = (uint64_t *)(void *)hf_layers_take(m, 2 * (size_t)(b->c.rows + 2 * p.around), 0);
        uint32_t *held =
            (uint32_t *)(void *)hf_layers_take(m, (size_t)((b->c.rows + 2 * p.around) * TILE >> p.level), 0);
        if (m->memory) {
            b->plane[i].cleared = cleared;
            b->plane[i].held = held;
        }
    }
    b->memory = hf_layers_take(m, 0, 0);
    for (int i = 0; i < l->slices; i++) {
        struct hf_slice_plane p;
        m->used += has_planes(l, i) ? (shape_plane(b, i, &p) + 15) & ~(size_t)15 : 0;
    }
}

struct taker {
    struct hf_slice_plane *p;
    const struct hf_view_block *b;
};

static void add_row(float *to, const float *in, int n, int level)
{
    for (int i = 0; i < n << level; i++)
        to[i] += in[i >> level];
}

static void take_row(void *cookie, const float *in, ptrdiff_t channel, int x, int y, int n)
{
    const struct taker *t = cookie;
    struct hf_slice_plane *p = t->p;
    const int size = TILE >> p->level, left = -p->around * size, right = t->b->c.columns * size - left,
              high = t->b->c.rows * size + p->around * size, level = p->level - t->b->unit,
              channels = t->b->c.l->channels;
    if (y < left || y >= high)
        return;
    const int from = x > left ? x : left, to = x + n < right ? x + n : right;
    if (from >= to)
        return;
    float *out = p->at + y * p->row + from * (1 << level);
    p->filled = (struct hf_rect){hf_min(from * (1 << level), p->filled.x0), hf_min(y, p->filled.y0),
                                 hf_max(to * (1 << level), p->filled.x1), hf_max(y + 1, p->filled.y1)};
    in += from - x;
    for (int c = 0; c < channels; c++)
        add_row(out + (c + 1) * p->channel, in + c * channel, to - from, level);
    add_row(out, in + channels * channel, to - from, level);
}

// A slice at the resolution that views need, of samples of pixels (finest 0) or of quads.
static struct hf_slice slice_of(const struct hf_layers *l, const struct hf_slice *from, const struct hf_slice_plane *p,
                                int finest)
{
    struct hf_slice s = *from;
    s.level = p->level;
    s.shape = NULL;
    s.rows = s.reach = (int)ceil(fabs((double)s.radius) * hf_layers_view_width(l)) >> p->level;
    s.scale = 1 / (float)(1 << 2 * (p->level - finest));
    return s;
}

// Leave out samples of tiles whose blur, `by` tiles wide, reaches none of the tiles `seen`: bits as in `blended`.
static void leave_unseen(const struct hf_view_block *b, const uint64_t *seen, int by)
{
    const struct hf_cell *c = &b->c;
    // A row of bits must hold the tiles around as well.
    if (c->columns + 2 + 2 * by > 64)
        return;
    for (int ty = c->box.y0; ty < c->box.y1; ty++) {
        uint64_t row = 0, wide = 0;
        for (int y = hf_max(ty - by, -1); y <= hf_min(ty + by, c->rows); y++)
            row |= seen[y + 1];
        for (int i = 0; i <= 2 * by; i++)
            wide |= row << i;
        for (int tx = c->box.x0; tx < c->box.x1; tx++) {
            const int bit = tx + 1 + by;
            if (bit < 0 || bit > 63 || !(wide >> bit & 1))
                *hf_layers_map_at(&c->used, tx, ty) = 0;
        }
    }
}

// Clear tiles of a plane: those of row ty with bits in `tiles`, as in `cleared`; with the last of them what runs of pixels read
// behind it.
static void clear_tiles(const struct hf_view_block *b, const struct hf_slice_plane *p, int ty, uint64_t tiles)
{
    const int size = TILE >> p->level, columns = b->c.columns + 2 * p->around;
    while (tiles) {
        const struct hf_bit_run run = hf_next_bits(&tiles);
        const int floats = (run.x1 - run.x0) * b->tile + (run.x1 == columns ? SPARE : 0);
        for (int y = ty * size; y < (ty + 1) * size; y++)
            for (int c = 0; c <= b->c.l->channels; c++)
                memset(p->at + y * p->row + c * p->channel + (run.x0 - p->around) * b->tile, 0,
                       sizeof(float) * (size_t)floats);
    }
}

// Clear what views of the tiles `seen` may read of a plane: bits as in `blended`. A run of pixels is made as a whole, so what the
// tiles beside read is cleared as well.
static void clear_around(const struct hf_view_block *b, struct hf_slice_plane *p, const uint64_t *seen)
{
    const struct hf_cell *c = &b->c;
    const int columns = c->columns + 2 * p->around, more = HF_LAYERS_VIEW_RUN / b->tile;
    // Fewer than 64: blocks have at most 20 columns, and planes 9 more on either side.
    const uint64_t all = ((uint64_t)1 << columns) - 1;
    for (int ty = -p->around; ty < c->rows + p->around; ty++) {
        uint64_t row = 0, wide = 0;
        for (int y = hf_max(ty - p->around, -1); y <= hf_min(ty + p->around, c->rows); y++)
            row |= seen[y + 1];
        // Bit tx + 1 of a row becomes bit tx + around of the plane, and those up to around + more beside it.
        for (int i = -1 - more; row && i < 2 * p->around + more; i++)
            wide |= i < 0 ? row >> -i : row << i;
        wide &= all & ~p->cleared[ty + p->around];
        clear_tiles(b, p, ty, wide);
        p->cleared[ty + p->around] |= wide;
    }
}

// Place a slice's planes.
static void begin_planes(const struct hf_view_block *b, int at, size_t *used)
{
    struct hf_slice_plane *p = &b->plane[at];
    const size_t n = shape_plane(b, at, p);
    p->any = 1;
    p->at = b->memory + *used + (p->around * TILE >> p->level) * p->row + p->around * b->tile;
    p->filled = (struct hf_rect){FAR_OFF, FAR_OFF, -FAR_OFF, -FAR_OFF};
    memset(p->cleared, 0, sizeof *p->cleared * (size_t)(b->c.rows + 2 * p->around));
    memset(p->held, 0, sizeof *p->held * (size_t)((b->c.rows + 2 * p->around) * TILE >> p->level));
    *used += (n + 15) & ~(size_t)15;
}

// Whether samples of a kind reach tiles where views count. Notes which they are, leaves out all samples that reach none, and
// begins the planes, those of slice `at`, if they are the first.
static int reach(struct hf_view_block *b, int i, int at, enum hf_kind kind, const struct hf_slice *s, size_t *used)
{
    struct hf_slice_plane *p = &b->plane[at];
    uint64_t seen[HF_LAYERS_BLOCK_ROWS + 2];
    uint64_t any = 0;
    if (!hf_layers_mark_used(&b->c, i, kind) || !hf_layers_mark_touched(&b->c, s, &b->c.touched))
        return 0;
    for (int ty = -1; ty <= b->c.rows; ty++) {
        uint64_t row = 0;
        for (int tx = -1; tx <= b->c.columns; tx++)
            row |= (uint64_t)(*hf_layers_map_at(&b->c.touched, tx, ty) != 0) << (tx + 1);
        seen[ty + 1] = row & b->blended[ty + 1];
        p->reached[ty + 1] |= seen[ty + 1];
        any |= seen[ty + 1];
    }
    if (!any)
        return 0;
    leave_unseen(b, seen, hf_layers_blur_tiles(s));
    if (!p->any)
        begin_planes(b, at, used);
    clear_around(b, p, seen);
    return 1;
}

// Add a slice's samples to planes: sums of samples, without their highlights.
static void gather(struct hf_view_block *b, int i, size_t *used)
{
    const struct hf_layers *l = b->c.l;
    const struct hf_samples *samples = b->c.samples;
    const int at = hf_layers_view_slice(l, i);
    struct hf_slice_plane *p = &b->plane[at];
    struct taker to = {.p = p, .b = b};
    shape_plane(b, at, p);
    const struct hf_slice seen = slice_of(l, &l->slice[i], p, 0);
    if (reach(b, i, at, HF_KIND_SEEN, &seen, used)) {
        const struct hf_build build = {.s = &seen,
                                       .set = &samples->seen,
                                       .weight = samples->seen.weight,
                                       .share = l->set.highlights && l->slice[i].level > 0 ? samples->share : NULL,
                                       .channels = l->channels + 1,
                                       .more = &samples->mixed};
        hf_layers_take_sources(&b->c, &build, take_row, &to);
    }
    const int quads = !l->known && p->level > 0;
    const struct hf_slice behind = slice_of(l, l->known ? &l->slice[i] : &l->behind[i], p, quads);
    if (reach(b, i, at, HF_KIND_HIDDEN, &behind, used)) {
        const struct hf_build build = {.s = &behind,
                                       .set = &samples->hidden,
                                       .weight = samples->hidden.weight,
                                       .finest = quads,
                                       .spread = !quads && !l->known,
                                       .channels = l->channels + 1,
                                       .more = &samples->beyond};
        hf_layers_take_sources(&b->c, &build, take_row, &to);
    }
}

// Colours of a slice are means of its samples. Weights are divided by the number of views, so sums of theirs are means
// and cannot overflow.
static void divide_row(const struct hf_view_block *b, const struct hf_slice_plane *p, int x, int n, int y)
{
    float *w = p->at + y * p->row + x;
    for (int c = 1; c <= b->c.l->channels; c++) {
        float *v = w + c * p->channel;
        for (int i = 0; i < n; i++)
            v[i] = v[i] / (w[i] > 1e-30f ? w[i] : 1e-30f);
    }
    const float one = 1 / (float)b->c.l->set.views;
    const int lead = p->around * b->tile;
    uint32_t held = 0;
    for (int from = 0, to; from < n; from = to) {
        const int group = (x + from + lead) >> 4;
        int any = 0;
        to = hf_min((group + 1) * 16 - lead - x, n);
        for (int i = from; i < to; i++) {
            any |= w[i] > 0;
            w[i] *= one;
        }
        held |= (uint32_t)any << group;
    }
    p->held[y + (p->around * TILE >> p->level)] |= held;
}

// The same for all that is cleared and holds samples.
static void divide(const struct hf_view_block *b, const struct hf_slice_plane *p)
{
    const int size = TILE >> p->level;
    for (int y = p->filled.y0; y < p->filled.y1; y++) {
        uint64_t tiles = p->cleared[(y + p->around * size) / size];
        while (tiles) {
            const struct hf_bit_run run = hf_next_bits(&tiles);
            const int x0 = hf_max((run.x0 - p->around) * b->tile, p->filled.x0),
                      x1 = hf_min((run.x1 - p->around) * b->tile, p->filled.x1);
            if (x0 < x1)
                divide_row(b, p, x0, x1 - x0, y);
        }
    }
}

void hf_layers_make_planes(struct hf_view_block *b)
{
    const struct hf_layers *l = b->c.l;
    size_t used = 0;
    for (int i = 0; i < l->slices; i++) {
        b->plane[i].any = 0;
        memset(b->plane[i].reached, 0, sizeof *b->plane[i].reached * (size_t)(b->c.rows + 2));
    }
    for (int i = 0; i < l->slices && !hf_stopped(l->stop); i++) {
        if (is_in(l, i))
            gather(b, i, &used);
        if (b->plane[i].any)
            divide(b, &b->plane[i]);
    }
}

// Whether a slice reaches any of some tiles.
static int is_reached(const struct hf_slice_plane *p, struct hf_rect tiles)
{
    const uint64_t columns = ((uint64_t)1 << (tiles.x1 - tiles.x0)) - 1;
    uint64_t any = 0;
    for (int ty = tiles.y0; ty < tiles.y1; ty++)
        any |= p->reached[ty + 1] >> (tiles.x0 + 1) & columns;
    return any != 0;
}

int hf_layers_list_planes(const struct hf_view_block *b, struct hf_rect tiles, struct hf_view_plane *to, int *far)
{
    const struct hf_layers *l = b->c.l;
    int n = 0;
    *far = 0;
    for (int i = 0; i < l->slices; i++) {
        const struct hf_slice_plane *p = &b->plane[i];
        if (!p->any || !is_reached(p, tiles))
            continue;
        *far += l->slice[i].radius <= 0;
        to[n++] =
            (struct hf_view_plane){.at = p->at,
                                   .row = p->row,
                                   .channel = p->channel,
                                   .level = p->level - b->unit,
                                   .held = p->held + (p->around * TILE >> p->level),
                                   .lead = p->around * b->tile,
                                   .shift = (const int16_t(*)[2])l->shift[l->group_used] + (ptrdiff_t)i * l->set.views};
    }
    return n;
}
