// SPDX-License-Identifier: BSD-3-Clause
// Rows of the gaussian engine. None of them fuses anything: every level has the bits of the C.
#include "harness.h"
#include "engine/gaussian/wide.h"

enum { LINE, LINE_FAITHFUL, COLUMNS, COLUMNS_FAITHFUL, COLUMNS_IN_PLACE, UP_HALF, UP_QUARTER };

// The data of a case of columns, upsampling or boxes that do not fit the world.
static struct {
    int rows, from, to, in_stride, out_stride, left;
    struct hf_wide wide;
} now;

static float *floats_of(const struct world *w, enum arena a, int slot)
{
    return (float *)(void *)slot_start(w, a, slot);
}

// Random colours over a whole slot.
static void fill(struct world *w, int slot, size_t floats)
{
    float *p = (float *)(void *)slot_use(w, slot, floats * sizeof(float), 0xff);
    for (size_t i = 0; i < floats; i++)
        p[i] = random_colour(&w->rng, w->colours);
}

static void start(struct world *w)
{
    world_clear(w);
    make_setup(w, w->bench ? 128 : rng_int(&w->rng, 1, 70), w->bench ? 1 : rng_int(&w->rng, 1, 3));
    w->colours = w->bench ? COLOURS_PLAIN : COLOURS_MIXED;
}

// count: only the counts are wanted.
void blend_row_make(struct world *w, int count)
{
    start(w);
    struct rng *r = &w->rng;
    w->params.engine = HF_ENGINE_GAUSSIAN;
    w->params.gaussian.faithful = w->params.chapter.faithful;
    w->params.aperture.blades = 0;
    if (rng_one_in(r, 2)) {
        w->params.model = HF_MODEL_RANGE;
        w->params.range.distance = w->params.range.near_begin = w->params.range.far_end = HF_DERIVE;
    }
    world_setup(w, &w->gaussian);
    const int half = w->setup.half_width;
    w->x = rng_one_in(r, 2) || w->bench ? 0 : rng_int(r, 0, half - 1);
    w->n = half - w->x;
    w->y = w->bench ? 0 : rng_int(r, 0, w->setup.height - 1);
    make_depth(w, rng_one_in(r, 2));
    w->with_counts = count || !rng_one_in(r, 3);
    w->x &= w->with_counts ? ~15 : ~0;
    make_lines(w, 4, (size_t)w->n + HF_PAD);
    for (int i = 0; i < 4; i++)
        world_region(w, i < 2 && !count ? REGION_FLOATS : REGION_SCRATCH, SLOT_LINES,
                     floats_of(w, ARENA_MADE, SLOT_LINES) + (size_t)i * w->line_floats, (size_t)w->n * 4, HF_PAD * 4, 1,
                     0);
}

void blend_row_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    const struct hf_frame f = world_frame(w, k, a);
    float *out[4];
    for (int i = 0; i < 4; i++)
        out[i] = floats_of(w, a, SLOT_LINES) + (size_t)i * w->line_floats;
    k->gaussian.blend_row(&f, w->x, w->y, w->n, out, w->with_counts ? &w->result[a].counts : NULL);
}

void count_row_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    const struct hf_frame f = world_frame(w, k, a);
    k->gaussian.count_row(&f, w->x, w->y, w->n, &w->result[a].counts);
}

void lerp_row_make(struct world *w, int index)
{
    (void)index;
    start(w);
    w->n = w->setup.half_width;
    const size_t length = (size_t)((w->n + 15) & ~15) + HF_PAD;
    fill(w, SLOT_LINES, 3 * length);
    float *p = floats_of(w, ARENA_MADE, SLOT_LINES);
    w->line_floats = length;
    for (int i = 0; i < w->n; i++)
        p[2 * length + (size_t)i] = random_coc(&w->rng, HF_STORAGE_FLOAT);
    world_region(w, REGION_FLOATS, SLOT_LINES, p, (size_t)w->n * 4, HF_PAD * 4, 1, 0);
}

void lerp_row_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    float *p = floats_of(w, a, SLOT_LINES);
    k->gaussian.lerp_row(p, p + w->line_floats, p + 2 * w->line_floats, w->n);
}

static void line_make(struct world *w)
{
    w->n = w->bench ? 256 : rng_int(&w->rng, 1, 140);
    fill(w, SLOT_WORK, (size_t)w->n + 2 * HF_PAD);
    make_lines(w, 1, (size_t)w->n + HF_PAD);
    world_region(w, REGION_FLOATS, SLOT_LINES, floats_of(w, ARENA_MADE, SLOT_LINES), (size_t)w->n * 4, HF_PAD * 4, 1,
                 0);
}

static void columns_make(struct world *w, int in_place)
{
    struct rng *r = &w->rng;
    w->n = w->bench ? HF_GAUSSIAN_STRIP : rng_int(r, 1, HF_GAUSSIAN_STRIP);
    now.rows = w->bench ? 64 : rng_int(r, 1, 20);
    now.from = rng_one_in(r, 2) ? 0 : rng_int(r, 0, now.rows - 1);
    now.to = rng_one_in(r, 2) ? now.rows : rng_int(r, now.from + 1, now.rows);
    now.in_stride = HF_GAUSSIAN_STRIP + (in_place ? 0 : 16 * rng_int(r, 0, 2));
    now.out_stride = in_place ? now.in_stride : HF_GAUSSIAN_STRIP + 16 * rng_int(r, 0, 2);
    fill(w, SLOT_WORK, (size_t)(now.rows * now.in_stride));
    if (!in_place)
        fill(w, SLOT_LINES, (size_t)((now.to - now.from) * now.out_stride));
    const int slot = in_place ? SLOT_WORK : SLOT_LINES;
    world_region(w, REGION_FLOATS, slot, floats_of(w, ARENA_MADE, slot) + (in_place ? now.from * now.in_stride : 0),
                 (size_t)w->n * 4, (size_t)(HF_GAUSSIAN_STRIP - w->n) * 4, now.to - now.from, now.out_stride * 4);
}

static void up_make(struct world *w, int scale)
{
    struct rng *r = &w->rng;
    now.left = 16;
    w->x = w->bench ? 0 : rng_int(r, 0, 20);
    w->n = w->bench ? 128 : rng_int(r, 1, 70);
    w->y = rng_int(r, 0, 2 * scale - 1);
    now.rows = 4;  // rows -1 to 2
    now.in_stride = now.left + (2 * (w->x + w->n) + scale - 1) / scale + 1 + HF_PAD;
    fill(w, SLOT_WORK, (size_t)(now.rows * now.in_stride));
    make_lines(w, 2, (size_t)w->n + HF_PAD);
    for (int i = 0; i < 2; i++)
        world_region(w, REGION_FLOATS, SLOT_LINES, floats_of(w, ARENA_MADE, SLOT_LINES) + (size_t)i * w->line_floats,
                     (size_t)w->n * 4, HF_PAD * 4, 1, 0);
}

void gaussian_make(struct world *w, int which)
{
    start(w);
    if (which <= LINE_FAITHFUL)
        line_make(w);
    else if (which <= COLUMNS_IN_PLACE)
        columns_make(w, which == COLUMNS_IN_PLACE);
    else
        up_make(w, which == UP_HALF ? 2 : 4);
}

void gaussian_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    float *in = floats_of(w, a, SLOT_WORK), *out = floats_of(w, a, SLOT_LINES);
    if (which <= LINE_FAITHFUL) {
        k->gaussian.line(in + HF_PAD, w->n, out, which == LINE_FAITHFUL);
    } else if (which <= COLUMNS_IN_PLACE) {
        k->gaussian.columns(in, now.in_stride, now.rows, now.from, now.to,
                            which == COLUMNS_IN_PLACE ? in + now.from * now.in_stride : out, now.out_stride, w->n,
                            which == COLUMNS_FAITHFUL);
    } else {
        const struct hf_buf b = {.ch = {in + now.in_stride + now.left}, .stride = now.in_stride};
        k->gaussian.up(&b, 0, which == UP_QUARTER, w->x, w->y, w->n, out, out + w->line_floats);
    }
}

void wide_make(struct world *w, int index)
{
    (void)index;
    start(w);
    struct rng *r = &w->rng;
    w->n = w->bench ? 512 : rng_int(r, 1, 120);
    const float sigma = w->bench ? 20 : rng_one_in(r, 2) ? rng_float(r, 0, 4) : rng_float(r, 0, 200);
    now.wide = hf_wide_of((double)sigma * sigma);
    fill(w, SLOT_LINES, HF_WIDE_LANES * (size_t)w->n);
    slot_use(w, SLOT_WORK, (hf_wide_floats(w->n) - HF_WIDE_LANES * (size_t)w->n) * sizeof(float), 0xff);
    const size_t bytes = HF_WIDE_LANES * (size_t)w->n * sizeof(float);
    world_region(w, REGION_FLOATS, SLOT_LINES, floats_of(w, ARENA_MADE, SLOT_LINES), bytes, 0, 1, 0);
    world_region(w, REGION_SCRATCH, SLOT_WORK, floats_of(w, ARENA_MADE, SLOT_WORK), 2 * bytes, 0, 1, 0);
}

void wide_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    (void)index;
    k->gaussian.wide_block(floats_of(w, a, SLOT_LINES), w->n, &now.wide, floats_of(w, a, SLOT_WORK));
}
