// SPDX-License-Identifier: BSD-3-Clause
// What the tests of layers' kernels share: lines of samples, and what of a case does not fit the world.
#ifndef HF_TESTS_KERNELS_LAYERS_H
#define HF_TESTS_KERNELS_LAYERS_H

#include "harness.h"
#include "engine/layers/hidden.h"
#include "engine/layers/patterns.h"
#include "engine/layers/views.h"

enum { ROOM = 64, IN = 56, OUT = 32, LINES = IN + OUT, MOST = 40, PLANES = 3, VIEWS = 9 };
enum { DISC_ROWS = 13, DISC_LINES = 2 * DISC_ROWS + 2 };  // of a disc on either side, and of what it is drawn to

struct layers_case {
    int which, channels, rows, add, with, whole, taps;
    int roundings;  // of a fused sum whose terms are all positive; 0: no bound is known
    float scale, off, part;
    struct hf_slice slice;
    struct hf_disc_row disc[DISC_ROWS];
    struct hf_shape_run run[3];
    struct hf_layers_rays rays;
    int from, to;
    struct hf_pattern_place place;
    struct hf_pattern_tap around[MOST];
    int16_t shift[PLANES][VIEWS][2];
    float point[VIEWS][3], parts[VIEWS];
};
extern struct layers_case now;

// Line i: sample 0, with ROOM floats before it and after the last of the longest line.
static inline float *line(const struct world *w, enum arena a, int i)
{
    return (float *)(void *)slot_start(w, a, SLOT_LINES) + (size_t)i * w->line_floats + ROOM;
}

static inline ptrdiff_t stride(const struct world *w)
{
    return (ptrdiff_t)w->line_floats;
}

enum kind { COLOUR, WEIGHT, RADIUS };

static inline float sample(struct world *w, enum kind kind)
{
    struct rng *r = &w->rng;
    switch (kind) {
    case WEIGHT:
        return rng_one_in(r, 4) ? 0 : rng_one_in(r, 2) ? 1 : rng_float(r, 0, 1);
    case RADIUS:
        return rng_one_in(r, 8) ? 0 : rng_one_in(r, 2) ? rng_float(r, -30, 30) : (float)rng_int(r, -30, 30);
    default:
        return random_colour(r, w->colours);
    }
}

static inline void fill(struct world *w, int i, int from, int to, enum kind kind)
{
    for (int x = from; x < to; x++)
        line(w, ARENA_MADE, i)[x] = sample(w, kind);
}

// Radii that change seldom, as on surfaces.
static inline void fill_surfaces(struct world *w, int i, int from, int to)
{
    for (int x = from; x < to; x++)
        line(w, ARENA_MADE, i)[x] =
            x > from && !rng_one_in(&w->rng, 5) ? line(w, ARENA_MADE, i)[x - 1] : sample(w, RADIUS);
}

// Colour (4), weight, radius from line i on.
static inline void fill_set(struct world *w, int i, int from, int to)
{
    for (int c = 0; c < 4; c++)
        fill(w, i + c, from, to, COLOUR);
    fill(w, i + 4, from, to, WEIGHT);
    fill_surfaces(w, i + 5, from, to);
}

// spare: samples beyond the last one that may be written.
static inline void put(struct world *w, int i, int n, int spare)
{
    world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, i), (size_t)n * 4, (size_t)spare * 4, 1, 0);
}

static inline void put_set(struct world *w, int i, int count, int n)
{
    for (int k = 0; k < count; k++)
        if (k < now.channels || k >= 4)
            put(w, i + k, n, 32);
}

static inline void set_of(const struct world *w, enum arena a, int i, float *set[6])
{
    for (int k = 0; k < 6; k++)
        set[k] = line(w, a, i + k);
}

// layers_slices.c
void weigh_make(struct world *w);
void weigh_call(const struct world *w, const struct kernels *k, enum arena a);
void views_make(struct world *w);
void views_call(const struct world *w, const struct kernels *k, enum arena a);
void disc_make(struct world *w);
void disc_call(const struct world *w, const struct kernels *k, enum arena a);
void dim_make(struct world *w);
void passed_make(struct world *w);
void passed_call(struct world *w, const struct kernels *k, enum arena a);
void runs_make(struct world *w);
void alike_make(struct world *w);
void alike_call(const struct world *w, const struct kernels *k, enum arena a);

#endif
