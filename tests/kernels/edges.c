// SPDX-License-Identifier: BSD-3-Clause
// Kernels of mixed pixels (pixel/edges.h). Nothing is fused, so every level has the bits of the C.
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "harness.h"

// Rows of radii, sure, colours, then middle, slope, the row's own radii; and the results.
enum { RADIUS, SURE = 5, COLOUR = 10, MIDDLE = 30, SLOPE, OWN, IN, OUT = 11, LINES = IN + OUT };

static int channels;

static float *line(const struct world *w, enum arena a, int i)
{
    return (float *)(void *)slot_start(w, a, SLOT_LINES) + (size_t)i * w->line_floats + HF_PAD;
}

// Radii that change seldom, as on surfaces; at most 40, or their products would round differently.
static void fill_surfaces(struct world *w, int i)
{
    struct rng *r = &w->rng;
    for (int x = -2; x < w->n + 2; x++)
        line(w, ARENA_MADE, i)[x] = x > -2 && !rng_one_in(r, 5) ? line(w, ARENA_MADE, i)[x - 1]
                                    : rng_one_in(r, 8)          ? 0
                                                                : rng_float(r, -40, 40);
}

static void put(struct world *w, int i, int from, int to)
{
    world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, i) + from, (size_t)(to - from) * 4, HF_PAD * 4, 1,
                 0);
}

void edges_make(struct world *w, int which)
{
    struct rng *r = &w->rng;
    world_clear(w);
    w->colours = w->bench ? COLOURS_PLAIN : rng_one_in(r, 2) ? COLOURS_MIXED : COLOURS_POSITIVE;
    w->n = w->bench ? 256 : rng_int(r, 3, 130);
    channels = rng_int(r, 3, 4);
    make_lines(w, LINES, (size_t)w->n + 2 * HF_PAD + 4);
    for (int j = 0; j < 5; j++)
        fill_surfaces(w, RADIUS + j);
    if (which == EDGES_SURE) {
        for (int i = IN; i < IN + 3; i++) {  // the first and the last pixel are undefined
            put(w, i, 0, w->n);
            w->regions[w->region_count - 1].kind = REGION_SCRATCH;
            put(w, i, 1, w->n - 1);
        }
        return;
    }
    const int ends = !w->bench && rng_one_in(r, 8);  // colours that are the largest floats
    for (int x = -2; x < w->n + 2; x++) {
        for (int j = 0; j < 5; j++)
            line(w, ARENA_MADE, SURE + j)[x] = rng_one_in(r, 3) ? 1 : rng_one_in(r, 2) ? 0 : rng_float(r, 0, 1);
        for (int i = COLOUR; i < MIDDLE; i++)
            line(w, ARENA_MADE, i)[x] = !ends || rng_one_in(r, 3) ? random_colour(r, w->colours)
                                        : rng_one_in(r, 2)        ? FLT_MAX
                                                                  : -FLT_MAX;
        line(w, ARENA_MADE, MIDDLE)[x] = rng_float(r, -20, 20);
        line(w, ARENA_MADE, SLOPE)[x] = rng_float(r, 0.02f, 2.7f);
        line(w, ARENA_MADE, OWN)[x] = rng_float(r, -40, 40);
    }
    for (int i = 0; i < OUT; i++)
        put(w, IN + i, 0, w->n);
}

void edges_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const float *const radius[3] = {line(w, a, RADIUS), line(w, a, RADIUS + 1), line(w, a, RADIUS + 2)};
    if (which == EDGES_SURE) {
        k->pixel.edges.sure(radius, w->n, line(w, a, IN), line(w, a, IN + 1), line(w, a, IN + 2));
        return;
    }
    struct hf_edge_row row = {.channels = channels,
                              .sharp = 0.5f,
                              .own = line(w, a, OWN),
                              .middle = line(w, a, MIDDLE),
                              .slope = line(w, a, SLOPE)};
    struct hf_sides out = {.radius = {line(w, a, IN + 8), line(w, a, IN + 9)}, .share = line(w, a, IN + 10)};
    for (int j = 0; j < 5; j++) {
        row.radius[j] = line(w, a, RADIUS + j);
        row.sure[j] = line(w, a, SURE + j);
        for (int c = 0; c < 4; c++)
            row.colour[j][c] = line(w, a, COLOUR + 4 * j + c);
    }
    for (int i = 0; i < 8; i++)
        out.colour[i / 4][i % 4] = line(w, a, IN + i);
    k->pixel.edges.take(&row, w->n, &out);
    // Without a share the other values are undefined. The fourth channel exists only if asked for.
    for (int x = 0; x < w->n; x++) {
        for (int c = 0; c < 4 && !(out.share[x] > 0); c++)
            out.colour[1][c][x] = 0;
        out.radius[1][x] = out.share[x] > 0 ? out.radius[1][x] : 0;
        for (int i = 0; i < 2 && channels == 3; i++)
            out.colour[i][3][x] = 0;
    }
}

int edges_check(const struct world *w, const struct level *l, char message[256])
{
    for (int i = 0; i < OUT; i++)
        for (int x = 0; x < w->n; x++) {
            const float v = line(w, ARENA_REFERENCE, IN + i)[x];
            if (isfinite(v))
                continue;
            snprintf(message, 256, "result %d of pixel %d is %g", i, x, (double)v);
            return 0;
        }
    return row_check(w, l, message);
}
