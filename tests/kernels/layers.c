// SPDX-License-Identifier: BSD-3-Clause
// The kernels of layers one by one. Lines of samples hold colour, weight, radius, with room around for what a kernel
// reads beside them. Exact levels give the bits of the C. Fused ones must also stay within their lines. Where all terms
// of a sum are positive, the sum's error is at most half a unit per rounding.
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "layers.h"

struct layers_case now;

// ---- samples ----

static void unmix_make(struct world *w)
{
    for (int y = 0; y < 7; y++) {
        fill_surfaces(w, y, -3, w->n + 3);
        fill(w, 7 + y, -3, w->n + 3, WEIGHT);
        for (int c = 0; c < 4; c++)
            fill(w, 14 + 4 * y + c, -3, w->n + 3, COLOUR);
    }
    fill_surfaces(w, 42, 0, w->n);
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, 43)[x] = rng_float(&w->rng, 0.1f, 2);
    put_set(w, IN, 6, w->n);
    put_set(w, IN + 6, 6, w->n);
}

// How many values are not 0 although their 16 pixels are not marked.
static int unmarked(const uint8_t *any, const float *v, int n)
{
    int count = 0;
    for (int x = 0; x < n; x++)
        count += v[x] != 0 && !any[x / 16];
    return count;
}

static void unmix_call(struct world *w, const struct kernels *k, enum arena a)
{
    uint8_t any[17] = {0};
    struct hf_unmix_row u = {.channels = now.channels, .middle = line(w, a, 42), .slope = line(w, a, 43), .any = any};
    for (int y = 0; y < 7; y++) {
        u.radius[y] = line(w, a, y);
        u.sure[y] = line(w, a, 7 + y);
        for (int c = 0; c < 4; c++)
            u.colour[y][c] = line(w, a, 14 + 4 * y + c);
    }
    set_of(w, a, IN, u.seen);
    set_of(w, a, IN + 6, u.mixed);
    static float scratch[14][17 * 16 + 2 * ROOM];
    uint8_t done[7][2 + 17 * 4] = {0};
    for (int y = 0; y < 7; y++) {
        u.light[y] = scratch[y] + ROOM;
        u.square[y] = scratch[7 + y] + ROOM;
        u.done[y] = done[y];
    }
    k->layers.unmix(&u, w->n);
    w->result[a].returned = unmarked(any, u.mixed[4], w->n);
    // Without weight the other values are undefined.
    for (int x = 0; x < w->n; x++)
        for (int c = 0; c < 6; c++)
            if (u.mixed[4][x] == 0 && (c < now.channels || c == 5))
                u.mixed[c][x] = 0;
}

// Two sets of samples, which may change places, and means, some of surroundings without light. Some tiles have no mixed pixels.
static void shares_make(struct world *w)
{
    fill_set(w, IN, 0, w->n);
    fill_set(w, IN + 6, 0, w->n);
    for (int x = 0; x < w->n; x++)
        if (rng_one_in(&w->rng, 2) || (now.rows >> x / 16 % 3 & 1))
            line(w, ARENA_MADE, IN + 10)[x] = 0;
    for (int i = 0; i < 3; i++)
        for (int x = 0; x < w->n; x++)
            line(w, ARENA_MADE, i)[x] = rng_one_in(&w->rng, 8) ? 0 : rng_float(&w->rng, 0, 0.5f);
    for (int i = 0; i < 13; i++)
        put(w, IN + i, w->n, 32);
}

static void shares_call(struct world *w, const struct kernels *k, enum arena a, int alpha)
{
    const float *in[3] = {line(w, a, 0), line(w, a, 1), line(w, a, 2)};
    float *seen[6], *mixed[6], *const out = line(w, a, IN + 12);
    uint8_t any[17] = {0}, mixes[17];
    for (int i = 0; i < 17; i++)
        mixes[i] = (uint8_t) !(now.rows >> i % 3 & 1);
    set_of(w, a, IN, seen);
    set_of(w, a, IN + 6, mixed);
    if (!alpha)
        seen[3] = mixed[3] = NULL;
    k->layers.shares(seen, mixed, mixes, (const float *const[]){in[0], in[1], in[2], in[0] + 1, in[1] + 1},
                     alpha ? (const float *const[]){in[2], in[0], in[1], in[2] + 1, in[0] + 1} : NULL, w->n, out, any);
    w->result[a].returned = unmarked(any, out, w->n);
}

static void quads_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *set[4][6], *out[6];
    for (int i = 0; i < 4; i++)
        set_of(w, a, 6 * i, set[i]);
    set_of(w, a, IN, out);
    k->layers.quads((const float *const(*)[6])set, (const float *const(*)[6])(set + 2), now.channels, w->n, out);
}

static void merge_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *set[3][6], *out[6];
    for (int i = 0; i < 3; i++)
        set_of(w, a, 6 * i, set[i]);
    set_of(w, a, IN, out);
    k->layers.merge((const float *const(*)[6])set, now.channels, now.scale, w->n, out);
}

// The planes of sums: those of a set, and coverage.
static void sums_of(const struct world *w, enum arena a, int i, float *sum[7])
{
    set_of(w, a, i, sum);
    sum[6] = line(w, a, i + 6);
}

// Up to three taps, each with samples of its own.
static void taps_call(const struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_hidden_tap tap[3];
    const struct hf_hidden_tap *const taps[3] = {&tap[0], &tap[1], &tap[2]};
    float *sum[7];
    sums_of(w, a, IN, sum);
    for (int i = 0; i < 3; i++) {
        tap[i] = (struct hf_hidden_tap){.from = 4 * now.off + (float)(2 * i),
                                        .scale = now.scale / (float)(1 << i),
                                        .part = now.part / (float)(1 << i),
                                        .whole = (float)(4 << i)};
        tap[i].least = fmaxf(tap[i].from, 1);
        set_of(w, a, 7 + 6 * i, (float **)tap[i].in);
    }
    k->layers.taps(taps, now.rows % 4, 0, now.channels, line(w, a, 6), w->n, sum);
}

// Sums begin with 0, which has no sign.
static void sums_make(struct world *w)
{
    fill_set(w, IN, 0, w->n);
    fill(w, IN + 6, 0, w->n, WEIGHT);
    for (int i = IN; i < IN + 7; i++)
        for (int x = 0; x < w->n; x++)
            line(w, ARENA_MADE, i)[x] += 0.0f;
    put_set(w, IN, 7, w->n);
}

// Four steps on either side, where surfaces often continue; the nearest radii; sums.
static void between_make(struct world *w)
{
    for (int i = 0; i < 8; i++)
        fill_set(w, 6 * i, 0, w->n);
    for (int i = 0; i < 4; i++)
        for (int x = 0; x < w->n; x++)
            if (rng_one_in(&w->rng, 2))
                line(w, ARENA_MADE, 6 * (4 + i) + 5)[x] = line(w, ARENA_MADE, 6 * i + 5)[x] + rng_float(&w->rng, -4, 4);
    fill_surfaces(w, 48, 0, w->n);
    for (int x = 0; x < w->n; x++)
        if (rng_one_in(&w->rng, 16))
            line(w, ARENA_MADE, 48)[x] = HUGE_VALF;
    sums_make(w);
}

static void between_call(const struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_hidden_line l = {.steps = 4, .away = {1, 2, 3, 4}};
    float *in[6], *sum[7];
    set_of(w, a, 0, in);
    for (int i = 0; i < 8; i++)
        l.side[i / 4][i % 4] = line(w, a, 6 * i) - line(w, a, 0);
    for (int i = 0; i < 4; i++)
        l.least[i] = hf_layers_line_least(l.away[i]);
    sums_of(w, a, IN, sum);
    k->layers.between(&l, l.steps, (const float *const *)in, now.channels, line(w, a, 48), w->n, sum);
}

static void found_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *sum[7], *out[6];
    const float *const radius[4] = {line(w, a, 6), line(w, a, 7), line(w, a, 8), line(w, a, 9)}, *const weight[4] = {
                                                                                                     line(w, a, 10),
                                                                                                     line(w, a, 11),
                                                                                                     line(w, a, 12),
                                                                                                     line(w, a, 13)};
    set_of(w, a, 0, sum);
    sum[6] = line(w, a, 14);
    set_of(w, a, IN, out);
    k->layers.found((const float *const *)sum, radius, weight, now.channels, w->n, out);
}

static void spread_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *in[6], *out[6];
    const float *const radius[4] = {line(w, a, 6), line(w, a, 7), line(w, a, 8), line(w, a, 9)}, *const weight[4] = {
                                                                                                     line(w, a, 10),
                                                                                                     line(w, a, 11),
                                                                                                     line(w, a, 12),
                                                                                                     line(w, a, 13)};
    set_of(w, a, 0, in);
    set_of(w, a, IN, out);
    k->layers.spread((const float *const *)in, radius, weight, now.rows & 1, now.channels, w->n, out);
}

// Nine lines; some are the same line.
static void smooth_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *set[HF_LAYERS_TAPS][6], *out[6];
    for (int i = 0; i < HF_LAYERS_TAPS; i++)
        set_of(w, a, 6 * (i % 9), set[i]);
    set_of(w, a, IN, out);
    const float *const along[2] = {line(w, a, 4), line(w, a, 5)};
    k->layers.smooth((const float *const(*)[6])set, now.with ? along : NULL, now.channels, w->n, out);
}

// ---- stacks ----

static void blend_call(const struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_stack_row to = {.weight = line(w, a, IN + 4),
                              .open = line(w, a, IN + 5),
                              .behind = line(w, a, IN + 6),
                              .held = line(w, a, IN + 8)};
    float *in[6];
    set_of(w, a, 0, in);
    for (int c = 0; c < 4; c++)
        to.colour[c] = line(w, a, IN + c);
    k->layers.blend(&to, now.channels, in, (enum hf_layers_sums)(now.rows % 4), w->n);
}

static void finish_call(const struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_stack_row near = {.weight = line(w, a, 4)};
    float *far[6], *own[6], *light[6], *out[6];
    set_of(w, a, 6, far);
    set_of(w, a, 12, own);
    set_of(w, a, 18, light);
    set_of(w, a, IN, out);
    for (int c = 0; c < 4; c++)
        near.colour[c] = line(w, a, c);
    k->layers.finish(&near, now.with ? (const float *const *)far : NULL,
                     now.rows % 2 ? (const float *const *)light : NULL, (const float *const *)own, now.channels,
                     now.add ? HF_LAYERS_FAINT : HF_LAYERS_FAINT_ALONE, w->n, out);
}

// ---- all ----

static void start(struct world *w, int which)
{
    struct rng *r = &w->rng;
    world_clear(w);
    now.which = which;
    now.roundings = 0;
    w->colours = w->bench ? COLOURS_PLAIN : rng_one_in(r, 2) ? COLOURS_MIXED : COLOURS_PLAIN;
    w->n = w->bench ? 256 : rng_int(r, 1, 130);
    now.channels = rng_int(r, 3, 4);
    now.add = rng_int(r, 0, 1);
    now.with = rng_int(r, 0, 1);
    now.rows = rng_int(r, 1, 8);
    now.scale = rng_float(r, 0.01f, 0.5f);
    now.off = rng_float(r, -1, 0.5f);
    now.part = rng_float(r, 0.001f, 1);
    make_lines(w, LINES, (size_t)(2 * w->n) + 2 * ROOM);
}

void layers_make(struct world *w, int which)
{
    start(w, which);
    switch (which) {
    case LAYERS_UNMIX:
        unmix_make(w);
        return;
    case LAYERS_ROOTS:
    case LAYERS_NINE:
        for (int i = 0; i < 9; i++)
            fill(w, i, 0, 2 * w->n, COLOUR);
        put(w, IN, w->n, 32);
        return;
    case LAYERS_SHARES:
    case LAYERS_SHARES_ALPHA:
        shares_make(w);
        return;
    case LAYERS_LAMPS:
    case LAYERS_LAMPS_ALPHA:
        fill_set(w, 0, 0, w->n);
        for (int i = 0; i < 3; i++)  // roots of samples of at most 2^125
            for (int x = 0; x < w->n; x++)
                line(w, ARENA_MADE, i)[x] = fmaxf(fminf(line(w, ARENA_MADE, i)[x], 6e18f), -6e18f);
        for (int i = 6; i < 8; i++)
            fill_surfaces(w, i, 0, 2 * w->n);
        for (int i = 8; i < 14; i++)  // means, and alpha, which may be above 1
            for (int x = 0; x < 2 * w->n; x++)
                line(w, ARENA_MADE, i)[x] = rng_float(&w->rng, 0, i < 10 ? 0.5f : 1.5f);
        put(w, IN, w->n, 32);
        return;
    case LAYERS_QUADS:
        for (int i = 0; i < 4; i++)
            fill_set(w, 6 * i, 0, 2 * w->n);
        put_set(w, IN, 6, w->n);
        return;
    case LAYERS_MERGE:
        for (int i = 0; i < 3; i++)
            fill_set(w, 6 * i, 0, w->n);
        put_set(w, IN, 6, w->n);
        return;
    case LAYERS_TAPS:
        for (int i = 0; i < 3; i++)
            fill_set(w, 7 + 6 * i, 0, w->n);
        fill_surfaces(w, 6, 0, w->n);
        sums_make(w);
        return;
    case LAYERS_BETWEEN:
        between_make(w);
        return;
    case LAYERS_ALIKE:
        alike_make(w);
        return;
    case LAYERS_FOUND:
    case LAYERS_SPREAD:
        fill_set(w, 0, 0, w->n);
        for (int i = 6; i < 14; i++)
            fill(w, i, 0, 2 * w->n, i < 10 ? RADIUS : WEIGHT);
        fill(w, 14, 0, w->n, WEIGHT);
        put_set(w, IN, 6, which == LAYERS_SPREAD ? 2 * w->n : w->n);
        return;
    case LAYERS_SMOOTH:
        for (int i = 0; i < 9; i++)
            fill_set(w, 6 * i, -HF_LAYERS_SMOOTH, w->n + HF_LAYERS_SMOOTH);
        put_set(w, IN, 6, w->n);
        return;
    case LAYERS_NEAREST:
        for (int i = 0; i < 8; i++)
            if (i < 4)
                fill_surfaces(w, i, 0, 2 * w->n);
            else
                fill(w, i, 0, 2 * w->n, WEIGHT);
        for (int x = 0; x < 2 * w->n; x++)  // fronts that are hardly there
            line(w, ARENA_MADE, 4)[x] *= rng_one_in(&w->rng, 3) ? 0.01f : 1;
        put(w, IN, w->n, 32);
        return;
    case LAYERS_EXTREMES:
    case LAYERS_INSIDE:
        for (int y = 0; y < now.rows; y++) {
            fill_surfaces(w, y, 0, w->n);
            fill(w, 8 + y, 0, w->n, WEIGHT);
        }
        line(w, ARENA_MADE, IN)[0] = now.add ? HUGE_VALF : -1;
        line(w, ARENA_MADE, IN)[1] = now.add ? -HUGE_VALF : 1;
        put(w, IN, 2, 0);
        return;
    case LAYERS_WEIGH:
        weigh_make(w);
        return;
    case LAYERS_VIEWS:
        views_make(w);
        return;
    case LAYERS_DISC:
        disc_make(w);
        return;
    case LAYERS_RUNS:
        runs_make(w);
        break;
    case LAYERS_FOLD:
    case LAYERS_PAIRS:
        fill(w, 0, 0, 2 * w->n, COLOUR);
        now.rows = rng_int(&w->rng, 1, w->n);
        put(w, IN, w->n, 0);
        return;
    case LAYERS_WEIGHTS:
    case LAYERS_STAMP:
        now.taps = rng_int(&w->rng, 1, MOST);
        fill(w, 0, -MOST, w->n + MOST, COLOUR);
        for (int x = 0; x < hf_max(w->n, MOST); x++)
            line(w, ARENA_MADE, 1)[x] = rng_float(&w->rng, 0, 1);
        now.roundings = 2 * MOST + 4;
        break;
    case LAYERS_LIGHT:
        fill(w, 0, 0, w->n, WEIGHT);
        fill(w, 1, 0, w->n, COLOUR);
        now.roundings = 3;
        break;
    case LAYERS_DIM:
        dim_make(w);
        return;
    case LAYERS_PASSED:
        passed_make(w);
        return;
    case LAYERS_UP:
        fill(w, 0, -1, w->n + 1, COLOUR);
        fill(w, 1, -1, w->n + 1, COLOUR);
        put(w, IN, 2 * w->n, 32);
        now.roundings = 8;
        return;
    default:  // stacks
        for (int i = 0; i < 4; i++)
            fill_set(w, 6 * i, 0, w->n);
        // Slices' sums, which are cleared; they begin with 0, which has no sign.
        for (int c = 0; which == LAYERS_BLEND && c < 5; c++) {
            for (int x = 0; x < w->n; x++)
                line(w, ARENA_MADE, c)[x] += 0.0f;
            if (c < now.channels || c == 4)
                put(w, c, w->n, 32);
        }
        for (int i = 0; i < 7; i++)
            fill(w, IN + i, 0, w->n, i < 4 ? COLOUR : WEIGHT);
        fill(w, IN + 8, 0, w->n, WEIGHT);
        put_set(w, IN, which == LAYERS_BLEND ? 6 : 4, w->n);
        if (which == LAYERS_BLEND && now.rows % 4 != HF_SUMS_HIDING)
            put(w, IN + 6, w->n, 32);
        if (which == LAYERS_BLEND && now.rows % 4 == HF_SUMS_HELD)
            put(w, IN + 8, w->n, 32);
        return;
    }
    fill(w, IN, 0, w->n, COLOUR);
    put(w, IN, w->n, which == LAYERS_STAMP ? 0 : 32);
}

static void drawing_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_layers_kernels *s = &k->layers;
    float *const out = line(w, a, IN);
    if (which == LAYERS_DISC)
        disc_call(w, k, a);
    else if (which == LAYERS_RUNS)
        s->runs(now.run, now.taps, line(w, a, 0), stride(w), now.with ? line(w, a, 6) : NULL, w->n, out);
    else if (which == LAYERS_WEIGHTS)
        s->weights(line(w, a, 1), now.taps, line(w, a, 0), w->n, out);
    else if (which == LAYERS_STAMP)
        s->stamp(line(w, a, 1), w->n, now.part, out);
    else if (which == LAYERS_PAIRS)
        s->pairs(line(w, a, 0), now.rows, w->n, out);
    else if (which == LAYERS_FOLD)
        s->fold(line(w, a, 0), w->n, out);
    else if (which == LAYERS_DIM)
        s->dim(line(w, a, 0), line(w, a, 1), w->n, out);
    else if (which == LAYERS_LIGHT)
        s->light(line(w, a, 0), line(w, a, 1), w->n, out);
    else
        s->up(line(w, a, 0), line(w, a, 1), w->n, out);
}

static void lamps_call(struct world *w, const struct kernels *k, enum arena a, int alpha)
{
    struct hf_lamp_tap tap[HF_LAYERS_LAMP_TAPS];
    const float *in[6];
    float *const out = line(w, a, IN);
    for (int i = 0; i < 6; i++)
        in[i] = line(w, a, i);
    for (int i = 0; i < HF_LAYERS_LAMP_TAPS; i++)
        tap[i] = (struct hf_lamp_tap){
            line(w, a, 8 + i % 2),
            {line(w, a, 6 + i / 2 % 2), line(w, a, 7 - i / 2 % 2)},
            {alpha ? line(w, a, 10 + (i < 4 ? 0 : 2)) : NULL, alpha ? line(w, a, 11 + (i < 4 ? 0 : 2)) : NULL}};
    memcpy(out, in[4], sizeof *out * (size_t)w->n);
    k->layers.lamps(in, tap, w->n, out);
}

void layers_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_layers_kernels *s = &k->layers;
    const float *in[9];
    float *const out = line(w, a, IN);
    for (int i = 0; i < 9; i++)
        in[i] = line(w, a, i);
    switch (which) {
    case LAYERS_UNMIX:
        unmix_call(w, k, a);
        return;
    case LAYERS_ROOTS:
        s->roots(in, in + 3, w->n, out);
        return;
    case LAYERS_NINE:
        s->nine(in, w->n, out);
        return;
    case LAYERS_SHARES:
    case LAYERS_SHARES_ALPHA:
        shares_call(w, k, a, which == LAYERS_SHARES_ALPHA);
        return;
    case LAYERS_LAMPS:
    case LAYERS_LAMPS_ALPHA:
        lamps_call(w, k, a, which == LAYERS_LAMPS_ALPHA);
        return;
    case LAYERS_QUADS:
        quads_call(w, k, a);
        return;
    case LAYERS_MERGE:
        merge_call(w, k, a);
        return;
    case LAYERS_TAPS:
        taps_call(w, k, a);
        return;
    case LAYERS_BETWEEN:
        between_call(w, k, a);
        return;
    case LAYERS_SPREAD:
        spread_call(w, k, a);
        return;
    case LAYERS_FOUND:
        found_call(w, k, a);
        return;
    case LAYERS_SMOOTH:
        smooth_call(w, k, a);
        return;
    case LAYERS_ALIKE:
        alike_call(w, k, a);
        return;
    case LAYERS_NEAREST:
        s->nearest(in, in + 4, w->n, out);
        return;
    case LAYERS_EXTREMES:
        s->extremes(in[0], now.with ? in[8] : NULL, stride(w), w->n, now.rows, (struct hf_layers_range *)(void *)out);
        return;
    case LAYERS_INSIDE:
        w->result[a].returned = s->inside(in[0], now.with ? in[8] : NULL, stride(w), w->n, now.rows, 20 * now.off,
                                          20 * now.off + now.part) != 0;
        return;
    case LAYERS_WEIGH:
        weigh_call(w, k, a);
        return;
    case LAYERS_PASSED:
        passed_call(w, k, a);
        return;
    case LAYERS_VIEWS:
        views_call(w, k, a);
        return;
    case LAYERS_BLEND:
        blend_call(w, k, a);
        return;
    case LAYERS_FINISH:
        finish_call(w, k, a);
        return;
    default:
        drawing_call(w, k, a, which);
    }
}

// Checks fused sums of positive terms; of other kernels only that they stay in their lines.
static int fused_check(const struct world *w, const struct level *l, char message[256])
{
    static struct world other;
    other = *w;
    for (int i = 0; i < w->region_count; i++) {
        const struct region *g = &w->regions[i];
        if (g->kind != REGION_FLOATS)
            continue;
        other.regions[i].kind = REGION_SCRATCH;
        const float *want = (const float *)(const void *)(slot_start(w, ARENA_REFERENCE, g->slot) + g->offset);
        const float *got = (const float *)(const void *)(slot_start(w, ARENA_TEST, g->slot) + g->offset);
        for (size_t x = 0; x < g->row_bytes / 4 && now.roundings && w->colours == COLOURS_PLAIN; x++)
            if (!(fabs((double)want[x] - got[x]) <= now.roundings * FLT_EPSILON * fabs((double)want[x]) + 0x1p-140)) {
                snprintf(message, 256, "sample %zu of region %d: %a, the C %a", x, i, got[x], want[x]);
                return 0;
            }
    }
    return world_compare(&other, l, message);
}

int layers_check(const struct world *w, const struct level *l, char message[256])
{
    if (w->result[ARENA_TEST].returned != w->result[ARENA_REFERENCE].returned) {
        snprintf(message, 256, "returned %d, the C %d", w->result[ARENA_TEST].returned,
                 w->result[ARENA_REFERENCE].returned);
        return 0;
    }
    return l->exact ? world_compare(w, l, message) : fused_check(w, l, message);
}
