// SPDX-License-Identifier: BSD-3-Clause
// Rows that hexagon and scatter share: signed CoC radii, and pixels in order or split into even and odd ones. Nothing
// is fused: every level has the bits of the C.
#include "harness.h"

enum { RADIUS, ZIP, UNZIP };

static float *line(const struct world *w, enum arena a, int i)
{
    return (float *)(void *)slot_start(w, a, SLOT_LINES) + (size_t)i * w->line_floats;
}

static void output(struct world *w, int i, int n)
{
    world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, i), (size_t)n * 4, HF_PAD * 4, 1, 0);
}

static void start(struct world *w)
{
    world_clear(w);
    make_setup(w, w->bench ? 128 : rng_int(&w->rng, 1, 70), w->bench ? 1 : rng_int(&w->rng, 1, 3));
}

// Radii by a lens, by ranges, or given; with or without a sharp limit. Where rows are counted, cells begin at multiples
// of 32.
static void make_radii(struct world *w)
{
    struct rng *r = &w->rng;
    w->params.engine = rng_one_in(r, 2) ? HF_ENGINE_HEXAGON : HF_ENGINE_SCATTER;
    w->params.aperture.blades = 0;
    w->params.hexagon.uniform = w->params.engine == HF_ENGINE_HEXAGON && rng_one_in(r, 8);
    world_setup(w, w->params.engine == HF_ENGINE_HEXAGON ? (void *)&w->hexagon : &w->scatter);
    w->setup.sharp_radius = rng_one_in(r, 2) ? 0 : rng_float(r, 0, 2);
    make_depth(w, rng_one_in(r, 2));
    w->with_counts = !rng_one_in(r, 3);
    w->x = rng_one_in(r, 2) || w->bench ? 0 : rng_int(r, 0, w->setup.width - 1);
    w->x &= w->with_counts ? ~31 : ~0;
    w->y = w->bench ? 0 : rng_int(r, 0, w->setup.height - 1);
    w->n = w->setup.width - w->x;
    make_lines(w, 1, (size_t)w->n + HF_PAD);
    output(w, 0, w->n);
}

void radius_make(struct world *w, int index)
{
    start(w);
    if (index == RADIUS) {
        make_radii(w);
        return;
    }
    // Rows 0 and 1: even and odd pixels. From row 2 on, two lines long: pixels in order.
    w->n = w->setup.half_width;
    const size_t length = (size_t)((w->n + 15) & ~15) + HF_PAD;
    float *p = (float *)(void *)slot_use(w, SLOT_LINES, 4 * length * sizeof(float), 0xff);
    w->line_floats = length;
    for (size_t i = 0; i < 4 * length; i++)
        p[i] = random_colour(&w->rng, w->bench ? COLOURS_PLAIN : COLOURS_MIXED);
    if (index == ZIP)
        output(w, 2, 2 * w->n);
    for (int i = 0; i < 2 && index == UNZIP; i++)
        output(w, i, w->n);
}

void radius_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    const struct hf_frame f = world_frame(w, k, a);
    if (index == RADIUS)
        k->pixel.radius_row(&f, w->x, w->y, w->n, line(w, a, 0), w->with_counts ? &w->result[a].counts : NULL);
    else if (index == ZIP)
        k->pixel.zip(line(w, a, 0), line(w, a, 1), w->n, line(w, a, 2));
    else
        k->pixel.unzip(line(w, a, 2), w->n, line(w, a, 0), line(w, a, 1));
}
