// SPDX-License-Identifier: BSD-3-Clause
// Composites the slices of a cell. The near and the far stack have half resolution, the middle stack around the focus
// has full resolution. At the end the three are combined.
#include <math.h>
#include <string.h>

#include "engine/layers/parts.h"

// Upsample the touched tiles of a level to the next finer one.
static void refine(struct hf_cell *c, const struct hf_tile_map *touched, int level)
{
    const struct hf_window *from = &c->sum[level], *to = &c->sum[level - 1];
    const int height = c->rows * (TILE >> (level - 1)) + MARGIN, right = c->columns * (TILE >> (level - 1)) + LEFT;
    for (int ty = -1; ty <= c->rows && !hf_stopped(c->l->stop); ty++)
        for (struct hf_span s = {.tx = -1}; hf_layers_next_span(c, touched, level - 1, ty, &s);) {
            // One more on every side, which the next step reads.
            const int x0 = s.x0 - 16 > -LEFT ? s.x0 - 16 : -LEFT, x1 = s.x1 + 16 < right ? s.x1 + 16 : right;
            int y0, y1;
            hf_layers_clip_rows(c, level - 1, ty, &y0, &y1);
            y0 = y0 - 1 > -MARGIN ? y0 - 1 : -MARGIN;
            y1 = y1 + 1 < height ? y1 + 1 : height;
            for (int y = y0; y < y1; y++)
                for (int i = 0; i <= c->l->channels; i++) {
                    const float *a = from->at + (y >> 1) * from->row + i * from->channel + x0 / 2;
                    c->k->up(a, a + (y & 1 ? from->row : -from->row), (x1 - x0) / 2,
                             to->at + y * to->row + i * to->channel + x0);
                }
        }
}

// A map's bytes, with the tiles around, lie without gaps.
static uint8_t *first_of(const struct hf_tile_map *m)
{
    return m->at - m->stride - 1;
}

static int bytes_of(const struct hf_cell *c)
{
    return (c->columns + 2) * (c->rows + 2);
}

// Clear sums of the touched tiles where no slice has been yet, and draw a slice.
static void draw(struct hf_cell *c, const struct hf_build *b)
{
    const int level = b->s->level, n = bytes_of(c);
    uint8_t *fresh = first_of(&c->fresh), *clean = first_of(&c->clean[level]);
    const uint8_t *touched = first_of(&c->touched);
    uint8_t any = 0;
    for (int i = 0; i < n; i++) {
        const uint8_t had = clean[i], is = touched[i], first = is & (uint8_t)~had;
        fresh[i] = first;
        clean[i] = had | is;
        any |= first;
    }
    // All channels are cleared, as the next slice may draw more of them.
    if (any)
        hf_layers_clear_tiles(c, &c->fresh, &c->sum[level], level, 0, c->l->channels + 1);
    hf_layers_draw_slice(c, b, &c->sum[level]);
}

// Put the sums of a slice under what a stack holds, and clear them.
static void put_under(struct hf_cell *c, int stack, int level, enum hf_layers_sums sums)
{
    const int finest = stack == MIDDLE ? 0 : 1, channels = c->l->channels, coarsest = level;
    while (level > finest + 1)
        refine(c, &c->touched, level--);
    const struct hf_window *from = &c->sum[level];
    for (int ty = -1; ty <= c->rows && !hf_stopped(c->l->stop); ty++)
        for (struct hf_span s = {.tx = -1}; hf_layers_next_span(c, &c->touched, finest, ty, &s);) {
            int y0, y1;
            hf_layers_clip_rows(c, finest, ty, &y0, &y1);
            for (int y = y0; y < y1; y++) {
                const struct hf_stack_row to = hf_layers_stack_at(c, stack, s.x0, y);
                float *in[5];
                for (int i = 0; i <= channels; i++) {
                    float *a = from->at + (y >> (level - finest)) * from->row + i * from->channel;
                    const int as = i < channels ? i : 4;
                    in[as] = level > finest ? c->row[as] : a + s.x0;
                    if (level > finest)
                        c->k->up(a + s.x0 / 2, a + s.x0 / 2 + (y & 1 ? from->row : -from->row), (s.x1 - s.x0) / 2,
                                 c->row[as]);
                }
                c->k->blend(&to, channels, in, sums, s.x1 - s.x0);
            }
        }
    // Rows that are upsampled are read more than once.
    for (level = coarsest; level > finest; level--)
        hf_layers_clear_tiles(c, &c->touched, &c->sum[level], level, 0, channels + 1);
}

// Draw a slice, put it under what a stack holds, and leave no sums.
static void put(struct hf_cell *c, const struct hf_build *b, int stack, enum hf_layers_sums sums)
{
    const int level = b->s->level;
    if (stack == NEAR && !hf_layers_leave_to_views(c, b->s))
        return;
    draw(c, b);
    put_under(c, stack, level, sums);
    if (stack == NEAR && hf_layers_views_are_near(c))
        hf_layers_clear_tiles(c, &c->left, &c->sum[level], level, 0, c->l->channels + 1);
}

static void mark(const struct hf_cell *c, const struct hf_tile_map *from, struct hf_tile_map *to)
{
    const uint8_t *in = first_of(from);
    uint8_t *out = first_of(to);
    const int n = bytes_of(c);
    for (int i = 0; i < n; i++)
        out[i] |= in[i];
}

// Fill one row of a tile in a window's channel.
static void fill_tile(const struct hf_window *w, int channel, int tx, int y, float value)
{
    float *p = w->at + y * w->row + channel * w->channel + tx * TILE;
    for (int x = 0; x < TILE; x++)
        p[x] = value;
}

#define LEAST_OPEN (1.0f / 16)

// Clear the tiles of the middle stack that a slice is the first to touch.
static void begin_tiles(const struct hf_cell *c)
{
    const int channels = c->l->channels;
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0; tx < c->columns; tx++) {
            uint8_t *begun = hf_layers_map_at(&c->begun, tx, ty);
            if (*begun || !*hf_layers_map_at(&c->touched, tx, ty))
                continue;
            *begun = 1;
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++)
                for (int i = 0; i <= channels + 3; i++)
                    fill_tile(&c->stack[MIDDLE], i, tx, y, i == channels + 1 || i == channels + 2);
        }
}

// Clear a stack at half resolution.
static void begin_stack(struct hf_cell *c, int stack)
{
    const int channels = c->l->channels, n = c->columns * TILE / 2 + 2 * MARGIN;
    if (c->opened[stack])
        return;
    c->opened[stack] = 1;
    for (int y = -MARGIN; y < c->rows * TILE / 2 + MARGIN; y++) {
        const struct hf_stack_row r = hf_layers_stack_at(c, stack, -MARGIN, y);
        for (int i = 0; i < channels; i++)
            memset(r.colour[i], 0, sizeof(float) * (size_t)n);
        memset(r.weight, 0, sizeof(float) * (size_t)n);
        for (int x = 0; x < n; x++)
            r.open[x] = r.behind[x] = 1;
        for (int x = 0; stack == FAR && x < n; x++)
            c->lift[y * c->lift_row - MARGIN + x] = 1;
    }
}

static void begin(struct hf_cell *c, int stack)
{
    if (stack == MIDDLE)
        begin_tiles(c);
    else
        begin_stack(c, stack);
}

// At the slice in focus: set the visible coverage to withhold, a part of what the near slices cover.
static void hold_back(const struct hf_cell *c)
{
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0; tx < c->columns; tx++)
            for (int y = ty * TILE; *hf_layers_map_at(&c->begun, tx, ty) && y < (ty + 1) * TILE; y++) {
                const struct hf_stack_row r = hf_layers_stack_at(c, MIDDLE, tx * TILE, y);
                for (int x = 0; x < TILE; x++)
                    r.held[x] = c->l->set.held * (1 - r.open[x]);
            }
}

// How a slice's visible samples go under a stack.
static enum hf_layers_sums sums_of(const struct hf_layers *l, const struct hf_slice *s, int stack)
{
    return stack == NEAR                                         ? HF_SUMS_HIDING
           : stack == MIDDLE && s->radius > 0 && l->set.held > 0 ? HF_SUMS_HELD
                                                                 : HF_SUMS_SEEN;
}

void hf_layers_put_slice(struct hf_cell *c, int i)
{
    const struct hf_layers *l = c->l;
    const struct hf_slice *s = &l->slice[i], *behind = &l->behind[i];
    const int stack = s->level == 0 ? MIDDLE : s->radius < 0 ? NEAR : FAR;
    struct hf_tile_map *reached = stack == NEAR ? &c->near : stack == FAR ? &c->far : &c->middle;
    if (s->radius == 0)
        hold_back(c);
    if (hf_layers_mark_used(c, i, HF_KIND_SEEN) && hf_layers_mark_touched(c, s, &c->touched)) {
        const int shares = l->set.highlights && s->level > 0;
        const struct hf_build b = {.s = s,
                                   .set = &c->samples->seen,
                                   .weight = c->samples->seen.weight,
                                   .share = shares ? c->samples->share : NULL,
                                   .channels = l->channels + 1,
                                   .more = &c->samples->mixed};
        begin(c, stack);
        if (s->radius != 0)
            mark(c, &c->touched, reached);
        put(c, &b, stack, sums_of(l, s, stack));
    }
    // Next to the focus, the border between visible and hidden samples must be as fine as the picture; at quads'
    // resolution a line would stay open.
    const int pixels = l->known || (s->level == 0 && fabsf(s->radius) < 2);
    behind = pixels ? s : behind;
    if (l->levels && hf_layers_mark_used(c, i, HF_KIND_HIDDEN) && hf_layers_mark_touched(c, behind, &c->touched)) {
        const struct hf_build b = {.s = behind,
                                   .set = &c->samples->hidden,
                                   .weight = c->samples->hidden.weight,
                                   .finest = !pixels,
                                   .spread = pixels && !l->known,
                                   .channels = l->channels + 1,
                                   .more = &c->samples->beyond};
        begin(c, stack);
        mark(c, &c->touched, reached);
        put(c, &b, stack, HF_SUMS_HIDDEN);
    }
}

// Reduce the far stack's openness by a cover.
static void cover_with(struct hf_cell *c, enum hf_kind kind)
{
    const struct hf_layers *l = c->l;
    const int hidden = kind == HF_KIND_HIDDEN;
    const struct hf_slice *s = &l->cover[hidden && !l->known];
    const struct hf_layers_set *set = hidden ? &c->samples->hidden : &c->samples->seen;
    const struct hf_build b = {.s = s,
                               .set = set,
                               .weight = set->weight,
                               .finest = hidden && !l->known,
                               .first = l->channels,
                               .channels = l->channels + 1,
                               .more = hidden ? &c->samples->beyond : &c->samples->mixed};
    if (!hf_layers_mark_used(c, l->last + 1, kind) || !hf_layers_mark_touched(c, s, &c->touched))
        return;
    const struct hf_window *from = &c->sum[1];
    draw(c, &b);
    begin_stack(c, FAR);
    c->covering = 1;
    mark(c, &c->touched, &c->covered);
    for (int ty = -1; ty <= c->rows; ty++)
        for (struct hf_span span = {.tx = -1}; hf_layers_next_span(c, &c->touched, 1, ty, &span);) {
            int y0, y1;
            hf_layers_clip_rows(c, 1, ty, &y0, &y1);
            for (int y = y0; y < y1; y++) {
                const struct hf_stack_row to = hf_layers_stack_at(c, FAR, span.x0, y);
                const float *v = from->at + y * from->row + l->channels * from->channel + span.x0;
                for (int x = 0; x < span.x1 - span.x0; x++) {
                    const float left = v[x] < 1 ? 1 - v[x] : 0;
                    to.open[x] *= left;
                    to.behind[x] *= hidden ? left : 1;
                }
            }
        }
    hf_layers_clear_tiles(c, &c->touched, from, 1, l->channels, l->channels + 1);
}

// Divide the far stack by its initial openness, so that partly covered edges sum to 1. The divisor is at least
// LEAST_OPEN, so where almost nothing is open, less is added. whole 0: compute the factors; 1: apply them.
static void lift(const struct hf_cell *c, int whole)
{
    for (int ty = -1; ty <= c->rows; ty++)
        for (struct hf_span s = {.tx = -1}; hf_layers_next_span(c, &c->covered, 1, ty, &s);) {
            int y0, y1;
            hf_layers_clip_rows(c, 1, ty, &y0, &y1);
            for (int y = y0; y < y1; y++) {
                const struct hf_stack_row r = hf_layers_stack_at(c, FAR, s.x0, y);
                float *by = c->lift + y * c->lift_row + s.x0;
                for (int x = 0; !whole && x < s.x1 - s.x0; x++)
                    by[x] = 1 / (r.open[x] > LEAST_OPEN ? r.open[x] : LEAST_OPEN);
                for (int i = 0; whole && i < c->l->channels; i++)
                    for (int x = 0; x < s.x1 - s.x0; x++)
                        r.colour[i][x] *= by[x];
                for (int x = 0; whole && x < s.x1 - s.x0; x++)
                    r.weight[x] *= by[x];
            }
        }
}

void hf_layers_cover(struct hf_cell *c)
{
    cover_with(c, HF_KIND_SEEN);
    if (c->l->levels)
        cover_with(c, HF_KIND_HIDDEN);
    lift(c, 0);
}

int hf_layers_is_sharp(const struct hf_cell *c, int tx, int ty)
{
    const struct hf_layers_range r = hf_layers_range_at(c, c->l->seen_range, tx, ty),
                                 m = hf_layers_range_at(c, c->l->mixed_range, tx, ty);
    return r.low == 0 && r.high == 0 && m.low > m.high && !*hf_layers_map_at(&c->near, tx, ty) &&
           !*hf_layers_map_at(&c->far, tx, ty) && !*hf_layers_map_at(&c->middle, tx, ty);
}

// Copy a tile of pixels.
static void copy_tile(const struct hf_cell *c, int tx, int ty, float *const out[4], ptrdiff_t stride)
{
    const struct hf_layers_set *s = &c->samples->seen;
    for (int i = 0; i < c->l->channels; i++)
        for (int y = ty * TILE; y < (ty + 1) * TILE; y++)
            memcpy(out[i] + y * stride + tx * TILE, s->colour[i] + (c->y0 + y) * s->stride + c->x0 + tx * TILE,
                   sizeof(float) * TILE);
}

void hf_layers_raise(const struct hf_cell *c, int stack, int plane, int x, int n, int y, float *out)
{
    const struct hf_window *w = &c->stack[stack];
    const float *a = w->at + (y >> 1) * w->row + plane * w->channel + (x >> 1);
    c->k->up(a, a + (y & 1 ? w->row : -w->row), n / 2, out);
}

// Upsample a row of a stack's colours and weight.
static void raise(const struct hf_cell *c, int stack, int x, int n, int y, float *const out[5])
{
    for (int i = 0; i <= c->l->channels; i++)
        hf_layers_raise(c, stack, i, x, n, y, out[i < c->l->channels ? i : 4]);
}

void hf_layers_begin_middle(const struct hf_cell *c)
{
    for (int ty = 0; ty < c->rows && !hf_stopped(c->l->stop); ty++)
        for (int tx = 0, end; (end = hf_layers_next_run(&c->near, &tx, ty, c->columns, 1)) > tx; tx = end)
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                const struct hf_stack_row r = hf_layers_stack_at(c, MIDDLE, tx * TILE, y);
                float *const out[5] = {r.colour[0], r.colour[1], r.colour[2], r.colour[3], r.weight};
                raise(c, NEAR, tx * TILE, (end - tx) * TILE, y, out);
                memcpy(r.open, r.weight, sizeof(float) * (size_t)((end - tx) * TILE));
                hf_layers_add_near_cover(c, tx, end, y, r.open);
                for (int x = 0; x < (end - tx) * TILE; x++)
                    r.open[x] = r.open[x] < 1 ? 1 - r.open[x] : 0;
                hf_layers_raise(c, NEAR, c->l->channels + 2, tx * TILE, (end - tx) * TILE, y, r.behind);
                memset(hf_layers_map_at(&c->begun, tx, ty), 1, (size_t)(end - tx));
            }
}

// Bits of what a tile has: far slices reach it, the middle stack holds something, there is light from behind the focus, and from
// before it. Tiles with the same bits are finished together.
enum { IS_FAR = 1, IS_BEGUN = 2, LIT_FAR = 4, LIT_NEAR = 8 };

static int state_of(const struct hf_cell *c, int tx, int ty)
{
    return *hf_layers_map_at(&c->far, tx, ty) * IS_FAR | *hf_layers_map_at(&c->begun, tx, ty) * IS_BEGUN |
           *hf_layers_map_at(&c->lit[FAR], tx, ty) * LIT_FAR | *hf_layers_map_at(&c->lit[NEAR], tx, ty) * LIT_NEAR;
}

// Finish one row of a run of tiles.
static void finish_row(const struct hf_cell *c, int state, int x, int y, int n, float *const out[4])
{
    const int far = state & IS_FAR, lit = state & (LIT_FAR | LIT_NEAR), whole = !(state & (IS_BEGUN | LIT_NEAR)),
              channels = c->l->channels;
    struct hf_stack_row r = hf_layers_stack_at(c, MIDDLE, x, y);
    const float *own[6] = {NULL};
    hf_layers_planes_at(c->l, &c->samples->seen, c->samples->seen.weight, c->x0 + x, c->y0 + y, own);
    if (!(state & IS_BEGUN)) {
        for (int i = 0; i < channels; i++)
            r.colour[i] = c->none;
        r.weight = c->none;
    }
    const float *light[6];
    for (int i = 0; i < 6; i++)
        light[i] = c->light_row[i];
    // With nothing in the middle stack all far light is seen as it is.
    for (int i = 0; lit && whole && i < 6; i++)
        light[i] = hf_layers_light_at(c, FAR, i < channels ? i : channels + (i == 5), x, y);
    if (lit && !whole)
        hf_layers_light_row(c, x / TILE, (x + n) / TILE, y, c->light_row);
    if (far)
        raise(c, FAR, x, n, y, c->row);
    c->k->finish(&r, far ? (const float *const *)c->row : NULL, lit ? light : NULL, own, channels,
                 c->l->set.hidden ? HF_LAYERS_FAINT : HF_LAYERS_FAINT_ALONE, n, out);
}

void hf_layers_finish_cell(const struct hf_cell *c, float *const out[4], ptrdiff_t stride)
{
    lift(c, 1);
    for (int ty = 0; ty < c->rows && !hf_stopped(c->l->stop); ty++)
        for (int tx = 0, end; tx < c->columns; tx = end) {
            const int state = state_of(c, tx, ty);
            for (end = tx + 1; end < c->columns && state_of(c, end, ty) == state;)
                end++;
            for (int y = ty * TILE; y < (ty + 1) * TILE; y++) {
                float *to[4] = {NULL};
                for (int i = 0; i < c->l->channels; i++)
                    to[i] = out[i] + y * stride + tx * TILE;
                finish_row(c, state, tx * TILE, y, (end - tx) * TILE, to);
            }
        }
    for (int ty = 0; ty < c->rows; ty++)
        for (int tx = 0; tx < c->columns; tx++)
            if (hf_layers_is_sharp(c, tx, ty))
                copy_tile(c, tx, ty, out, stride);
}
