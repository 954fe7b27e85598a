// SPDX-License-Identifier: BSD-3-Clause
// The search for hidden samples in the levels of a band.
#include <math.h>
#include <string.h>

#include "engine/layers/band.h"
#include "pixel/pass_c.h"

// A search goes down a band row by row, behind the levels. What it finds is smoothed along the row at once, and across rows as
// soon as the rows below are there.
struct search {
    struct hf_hidden_band b;
    struct hf_hidden_line line[HF_LAYERS_LINES];
    struct hf_hidden_tap tap[HF_LAYERS_LEVELS][9];  // with the samples of a row
    // Of the first hidden surface, and of the one behind it: rows that are smoothed along themselves, how many levels each
    // block has searched in each row, and which tiles of a row of tiles may have something.
    struct hf_hidden_ring along[2];
    uint8_t *needed[2], *some[2];
    struct hf_hidden_ring found;  // a row that is not smoothed yet
    float *behind;                // behind which radius the second surface lies, of the quads of a row
};

size_t hf_layers_hidden_floats(const struct hf_layers *l, int width, int height)
{
    const size_t columns = ((size_t)width + HF_HIDDEN_BLOCK - 1) / HF_HIDDEN_BLOCK;
    return hf_hidden_band_floats(l, width, height + 2 * HF_LAYERS_SMOOTH) +
           (2 * HF_LAYERS_TAPS + 1) * hf_hidden_row_floats(l, width) + columns * HF_HIDDEN_BLOCK +
           2 * columns * ((size_t)height + 2 * HF_LAYERS_SMOOTH + 2) / sizeof(float) + HF_HIDDEN_PAD;
}

// The lines through a sample of level 0: row, column and both diagonals, no longer than the levels' reach.
static void make_lines(struct search *s)
{
    static const int step[HF_LAYERS_STEPS] = {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16},
                     along[HF_LAYERS_LINES][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
    for (int k = 0; k < HF_LAYERS_LINES; k++) {
        struct hf_hidden_line *line = &s->line[k];
        const ptrdiff_t apart = along[k][1] * s->b.quads.stride + along[k][0];
        line->steps = 0;
        for (int i = 0; i < HF_LAYERS_STEPS && step[i] <= 1 << s->b.l->levels; i++, line->steps++) {
            line->side[0][i] = step[i] * apart;
            line->side[1][i] = -step[i] * apart;
            line->away[i] = (float)step[i] * (k < 2 ? 1 : 1.41421356f);
            line->least[i] = hf_layers_line_least(line->away[i]);
        }
    }
}

// How levels are tapped: where a tap's ramp begins and how steep it is. It begins at a radius half a step before the tap, but
// not before the level is needed.
static void make_taps(struct search *s)
{
    static const float distance[3] = {0, 1, 1.41421356f}, share[3] = {1, 0.5f, 0.25f};
    float part = 1;
    for (int j = 0; j < s->b.l->levels; j++, part /= 256)
        for (int i = 0; i < 9; i++) {
            const int of = (i % 3 != 1) + (i / 3 != 1);
            const float away = distance[of], step = (float)(2 << j), full = (of || !j ? away + 0.5f : 1.5f) * step,
                        from = fmaxf((away - 0.5f) * step, hf_layers_level_from(j));
            s->tap[j][i] = (struct hf_hidden_tap){.from = from,
                                                  .scale = 1 / (full - from),
                                                  .part = part * share[of],
                                                  .whole = HF_LAYERS_REACHED / part,
                                                  .least = fmaxf(from, 1)};
        }
}

// The taps of a row: with its samples, from column 0 on.
static void place_taps(struct search *s, int y)
{
    for (int j = 0; j < s->b.l->levels; j++)
        for (int i = 0; i < 9; i++)
            hf_hidden_level(&s->b, j, (i % 3 - 1) * (1 << j), y + (i / 3 - 1) * (1 << j), (float **)s->tap[j][i].in);
}

// The next run of blocks in a row that need equally many levels; at most STEP samples.
struct run {
    int x, n, needed, end;
};

static int next_run(const struct hf_hidden_band *b, const uint8_t *needed, struct run *run)
{
    const int start = run->end;
    if (start >= b->columns)
        return 0;
    for (run->end++; run->end < b->columns && needed[run->end] == needed[start] &&
                     (run->end - start) * HF_HIDDEN_BLOCK < HF_HIDDEN_STEP;)
        run->end++;
    run->x = b->r.x0 + start * HF_HIDDEN_BLOCK;
    run->n = hf_min(b->r.x0 + run->end * HF_HIDDEN_BLOCK, b->r.x1) - run->x;
    run->needed = needed[start];
    return 1;
}

// How many levels the blocks of a row have searched for the first or second surface.
static uint8_t *needed_of(const struct search *s, int second, int y)
{
    return s->needed[second] + (y - s->b.r.y0) * s->b.columns;
}

// The farthest radius within reach of blocks in row y.
static const float *within_of(const struct hf_hidden_band *b, int y)
{
    return b->within + (y - b->r.y0) / HF_HIDDEN_BLOCK * b->stride;
}

// An upper bound of how far behind its nearest surface a run may find anything, rounding allowed for.
static float farthest_behind(const struct hf_hidden_band *b, const float *nearest, const struct run *run, int y)
{
    const int first = (run->x - b->r.x0) / HF_HIDDEN_BLOCK;
    float high = -HUGE_VALF;
    for (int i = first; i < run->end; i++)
        high = fmaxf(within_of(b, y)[i], high);
    return high - hf_hidden_range(b, nearest, NULL, 0, run->n, 1).low + HF_HIDDEN_ROUNDED;
}

// Add surfaces that continue between opposite sides. Steps beyond the reach of that bound are left out.
static void find_between(const struct search *s, const float *nearest, float behind, const struct run *run, int y,
                         float *const sum[7])
{
    float *in[6] = {NULL};
    hf_hidden_planes(&s->b.quads, s->b.l->channels, run->x, y, in);
    for (int k = 0; k < HF_LAYERS_LINES; k++) {
        const struct hf_hidden_line *line = &s->line[k];
        int steps = line->steps;
        while (steps > 0 && behind * (1.0f / 3) + (1 - line->away[steps - 1]) < -HF_HIDDEN_ROUNDED)
            steps--;
        hf_layers_kernels(s->b.f)->between(line, steps, (const float *const *)in, s->b.l->channels, nearest, run->n,
                                           sum);
    }
}

// Search behind the radii `nearest` of a run.
static void find(const struct search *s, const float *nearest, const struct run *run, int y)
{
    const struct hf_hidden_band *b = &s->b;
    const struct hf_layers_kernels *k = hf_layers_kernels(b->f);
    const int channels = b->l->channels;
    _Alignas(64) float memory[7][HF_HIDDEN_STEP + HF_HIDDEN_PAD];
    float *sum[7], *out[6] = {NULL};
    for (int i = 0; i < 7; i++) {
        sum[i] = memory[i];
        memset(sum[i], 0, sizeof(float) * (size_t)(run->n + HF_HIDDEN_BLOCK));  // the rest of the last vector too
    }
    const float behind = farthest_behind(b, nearest, run, y);
    const struct hf_hidden_tap *taps[9 * HF_LAYERS_LEVELS];
    int count = 0;
    for (int j = 0; j < run->needed; j++)
        for (int i = 0; i < 9; i++)
            if (behind > s->tap[j][i].least)
                taps[count++] = &s->tap[j][i];
    k->taps(taps, count, run->x, channels, nearest, run->n, sum);
    find_between(s, nearest, behind, run, y, sum);
    const float *radius[4], *weight[4];
    hf_layers_quad_rows(b->f, run->x, y, radius, weight);
    hf_hidden_planes(&s->found.set, channels, run->x, 0, out);
    k->found((const float *const *)sum, radius, weight, channels, run->n, out);
}

// Whether anything may lie at least a pixel of radius behind one of a block's quads in row y.
static int is_behind(const struct hf_hidden_band *b, const float *nearest, int block, int y)
{
    const float before = within_of(b, y)[block] - 1 + HF_HIDDEN_ROUNDED;
    const int first = block * HF_HIDDEN_BLOCK, end = hf_min(b->r.x1 - b->r.x0, first + HF_HIDDEN_BLOCK);
    int any = 0;
    for (int x = first; x < end; x++)
        any |= nearest[x] < before;
    return any;
}

// Clear weights of a row, and those beside the band that a mean reads: beyond the frame nothing is hidden.
static void clear_ends(const struct hf_hidden_band *b, float *weight)
{
    memset(weight + b->r.x0 - HF_LAYERS_SMOOTH, 0, sizeof(float) * HF_LAYERS_SMOOTH);
    memset(weight + b->r.x1, 0, sizeof(float) * HF_LAYERS_SMOOTH);
}

// Search row y behind the radii `nearest` where one of a block's quads needs it. most: how many levels blocks may need;
// needed: becomes how many they have searched.
static void find_row(struct search *s, const float *nearest, const uint8_t *most, int y, uint8_t *needed)
{
    const struct hf_hidden_band *b = &s->b;
    float *weight = s->found.set.weight;
    for (int i = 0; i < b->columns; i++)
        needed[i] = most[i] && is_behind(b, nearest, i, y) ? most[i] : 0;
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, needed, &run);)
        if (run.needed)
            find(s, nearest + run.x - b->r.x0, &run, y);
        else
            memset(weight + run.x, 0, sizeof(float) * (size_t)run.n);
    clear_ends(b, weight);
}

// Neighbouring samples may come from different levels. Means along rows, then along columns, hide those steps.
static void smooth_along(const struct search *s, int second, int y)
{
    const struct hf_hidden_band *b = &s->b;
    const struct hf_layers_set *set = &s->along[second].set;
    const int channels = b->l->channels, row = hf_hidden_ring_row(&s->along[second], y);
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, needed_of(s, second, y), &run);) {
        float *in[HF_LAYERS_TAPS][6] = {{NULL}}, *out[6] = {NULL};
        hf_hidden_planes(set, channels, run.x, row, out);
        for (int i = 0; run.needed && i < HF_LAYERS_TAPS; i++)
            hf_hidden_planes(&s->found.set, channels, run.x + i - HF_LAYERS_SMOOTH, 0, in[i]);
        if (run.needed)
            hf_layers_kernels(b->f)->smooth((const float *const(*)[6])in, NULL, channels, run.n, out);
        else
            memset(out[4], 0, sizeof(float) * (size_t)run.n);
    }
    clear_ends(b, set->weight + row * set->stride);
}

static void smooth_down(const struct search *s, int second, int y)
{
    static const float none[HF_HIDDEN_STEP + HF_HIDDEN_PAD];
    const struct hf_hidden_band *b = &s->b;
    const int channels = b->l->channels, colour = second ? HF_LAYERS_BUF_BEYOND : HF_LAYERS_BUF_HIDDEN,
              at = second ? HF_LAYERS_BUF_BEYOND_AT : HF_LAYERS_BUF_HIDDEN_AT;
    for (struct run run = {0}; !hf_stopped(b->f->s->stop) && next_run(b, needed_of(s, second, y), &run);) {
        float *in[HF_LAYERS_TAPS][6] = {{NULL}}, *out[6] = {NULL};
        hf_row(&b->f->buf[colour], channels, run.x, y, out);
        out[4] = hf_at(&b->f->buf[at], 0, run.x, y);
        out[5] = hf_at(&b->f->buf[at], 1, run.x, y);
        if (!run.needed) {
            memset(out[4], 0, sizeof(float) * (size_t)run.n);
            continue;
        }
        for (int i = 0; i < HF_LAYERS_TAPS; i++) {
            const int from = y + i - HF_LAYERS_SMOOTH, inside = from >= b->r.y0 && from < b->r.y1;
            hf_hidden_planes(&s->along[second].set, channels, run.x,
                             hf_hidden_ring_row(&s->along[second], inside ? from : y), in[i]);
            in[i][4] = inside ? in[i][4] : (float *)none;
        }
        const float *const along[2] = {in[HF_LAYERS_SMOOTH][4], in[HF_LAYERS_SMOOTH][5]};
        hf_layers_kernels(b->f)->smooth((const float *const(*)[6])in, along, channels, run.n, out);
    }
}

// A near sample that was found takes the place of the visible one, and the second search looks behind it. That search
// accepts only samples less than half as near, because it is the last: of three blades before a wall it must find the
// wall. A found sample that is far or in focus needs none behind it; the far field's blur fills the gap there. One that
// covers little of its quad hides as little as one that is hardly near.
static void look_behind(const struct search *s, const uint8_t *needed)
{
    const float *weight = s->found.set.weight, *radius = s->found.set.radius;
    for (struct run run = {0}; next_run(&s->b, needed, &run);)
        for (int x = run.x; run.needed && x < run.x + run.n; x++) {
            const float part = hf_saturate(HF_LAYERS_WHOLE * weight[x]), half = radius[x] * 0.5f;
            s->behind[x - s->b.r.x0] = !(part > 0) || radius[x] >= -1 ? HUGE_VALF
                                       : part < 1                     ? part * (half + 1) - 1
                                                                      : half;
        }
}

// A sample behind one that is hardly near counts less, so nothing appears at once when the latter comes nearer.
static void begin_softly(const struct search *s, const uint8_t *needed)
{
    float *weight = s->found.set.weight;
    for (struct run run = {0}; next_run(&s->b, needed, &run);)
        for (int x = run.x; run.needed && x < run.x + run.n; x++)
            weight[x] = weight[x] * hf_saturate(-1 - s->behind[x - s->b.r.x0]);
}

// Search row y for both surfaces.
static void search_row(struct search *s, int y)
{
    const struct hf_hidden_band *b = &s->b;
    uint8_t *first = needed_of(s, 0, y), *second = needed_of(s, 1, y);
    place_taps(s, y);
    find_row(s, hf_at(&b->f->buf[HF_LAYERS_BUF_QUADS_AT], 2, b->r.x0, y),
             b->needed + (y - b->r.y0) / HF_HIDDEN_BLOCK * b->stride, y, first);
    look_behind(s, first);
    smooth_along(s, 0, y);
    find_row(s, s->behind, first, y, second);
    begin_softly(s, second);
    smooth_along(s, 1, y);
}

// Finish row y of the band's own rows r; after the last row of a row of tiles, note what these have. Where nothing was sought,
// tiles are not read: their radii are in no cache, and that would take 3 % of a frame.
static void finish_row(const struct search *s, struct hf_rect r, int y)
{
    const struct hf_hidden_band *b = &s->b;
    const int size = HF_LAYERS_TILE / 2, top = y / size * size;
    for (int i = 0; i < 2; i++) {
        smooth_down(s, i, y);
        if (y == top)
            memset(s->some[i], 0, 2 * (size_t)b->columns);
        for (int tile = 0; tile < 2 * b->columns; tile++)
            s->some[i][tile] |= needed_of(s, i, y)[tile * size / HF_HIDDEN_BLOCK];
    }
    if (!b->l->known && (y == top + size - 1 || y == r.y1 - 1))
        hf_layers_mark_hidden(b->f, (struct hf_rect){r.x0, top, r.x1, y + 1}, (const uint8_t *const *)s->some);
}

// Place what a search needs in memory, behind its band.
static void begin(struct search *s, float *memory)
{
    struct hf_hidden_band *b = &s->b;
    memory = hf_hidden_begin(b, memory);
    s->found = hf_hidden_ring(b, 1, &memory);
    for (int i = 0; i < 2; i++)
        s->along[i] = hf_hidden_ring(b, HF_LAYERS_TAPS, &memory);
    s->behind = memory;
    uint8_t *bytes = (uint8_t *)(memory + b->columns * HF_HIDDEN_BLOCK);
    for (int i = 0; i < 2; i++) {
        s->needed[i] = bytes;
        s->some[i] = bytes + (b->r.y1 - b->r.y0) * b->columns;
        bytes = s->some[i] + 2 * b->columns;
    }
    make_lines(s);
    make_taps(s);
}

// Set alpha to 1 where no alpha was searched, for readers of the samples.
static void fill_alpha(const struct hf_frame *f, struct hf_rect r, int colour)
{
    for (int y = r.y0; y < r.y1; y++) {
        float *alpha = hf_at(&f->buf[colour], 3, r.x0, y);
        for (int x = 0; x < r.x1 - r.x0; x++)
            alpha[x] = 1;
    }
}

// Find the hidden samples of a band.
static void find_hidden(const struct hf_frame *f, struct hf_rect r)
{
    struct hf_layers l = *hf_layers(f->s);
    const int channels = l.channels;
    struct search s = {.b = {.f = f, .l = &l, .r = r, .reach = hf_layers_hidden_reach(&l)}};
    struct hf_hidden_band *b = &s.b;
    const struct hf_buf *colour = &f->buf[HF_LAYERS_BUF_QUADS], *at = &f->buf[HF_LAYERS_BUF_QUADS_AT];
    l.channels = hf_layers_drawn(&l);
    b->r.y0 = hf_max(r.y0 - HF_LAYERS_SMOOTH, 0);
    b->r.y1 = hf_min(r.y1 + HF_LAYERS_SMOOTH, f->s->half_height);
    b->quads = (struct hf_layers_set){.weight = at->ch[0], .radius = at->ch[1], .stride = colour->stride};
    memcpy(b->quads.colour, colour->ch, sizeof colour->ch);
    begin(&s, f->work);
    for (int y = b->r.y0; y < r.y1 + HF_LAYERS_SMOOTH && !hf_stopped(f->s->stop); y++) {
        if (y < b->r.y1) {
            hf_hidden_advance(b, y);
            search_row(&s, y);
        }
        if (y - HF_LAYERS_SMOOTH >= r.y0)
            finish_row(&s, r, y - HF_LAYERS_SMOOTH);
    }
    if (l.channels == channels)
        return;
    fill_alpha(f, r, HF_LAYERS_BUF_HIDDEN);
    fill_alpha(f, r, HF_LAYERS_BUF_BEYOND);
}

void hf_layers_hidden_pass(const struct hf_frame *f, struct hf_rect r)
{
    const int levels = hf_layers(f->s)->levels;
    if (levels)
        find_hidden(f, r);
    hf_layers_bound_border(f, r);
    if (!levels)
        return;
    if (hf_layers(f->s)->guessed) {
        hf_layers_set_colours(f, HF_LAYERS_BUF_HIDDEN, r, 0);
        hf_layers_set_colours(f, HF_LAYERS_BUF_BEYOND, r, 0);
    }
}
