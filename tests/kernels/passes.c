// SPDX-License-Identifier: BSD-3-Clause
// The passes of gather and chapter one by one: random input buffers, only as large as engine.c's table says that they are read.
#include <math.h>
#include <stdio.h>

#include "harness.h"

#define BIT(buf) HF_BIT(buf)

struct hf_rect rect_grown(struct hf_rect r, struct hf_reach by)
{
    return (struct hf_rect){r.x0 - by.x, r.y0 - by.y, r.x1 + by.x, r.y1 + by.y};
}

// Rows at full resolution for HF_BUF_COC.
static struct hf_rect rows_of(const struct world *w, int b, struct hf_rect r)
{
    if (b != HF_BUF_COC)
        return r;
    return (struct hf_rect){r.x0, 2 * r.y0, r.x1, hf_min(2 * r.y1, w->setup.height)};
}

// Fields and their sources are consistent with the CoC, as the passes before make them: so their quotient is a colour,
// and where nothing covers, the field is 0.
static float buffer_value(struct world *w, int b, int x, int y)
{
    const int is_far = b == HF_BUF_COLORFAR4 || (is_chapter(w) && (b == HF_BUF_FAR || b == HF_BUF_FAR_FILL));
    const float colour = random_colour(&w->rng, w->colours);
    if (!is_chapter(w) && b == HF_BUF_COLORNEAR4)
        return colour * *world_at(w, ARENA_MADE, HF_BUF_COC4, HF_AREA_NEAR, x, y);
    if (b == HF_BUF_NEAR && !is_chapter(w))
        return colour * *world_at(w, ARENA_MADE, HF_BUF_COVER, 0, x, y);
    if (!is_far)
        return colour;
    const float f = *world_at(w, ARENA_MADE, HF_BUF_COC4, 1, x, y);
    return b == HF_BUF_COLORFAR4 ? colour * f : f > 0 ? colour : 0;
}

static int is_coc(const struct world *w, int b)
{
    return b == HF_BUF_COC || b == HF_BUF_COC4 || (!is_chapter(w) && (b == HF_BUF_COVER || b == HF_BUF_FAR_PART)) ||
           (b >= HF_BUF_MAX_X && b <= HF_BUF_BLUR);
}

// CoC anywhere; in patches with none between them, some wider than any vector; everywhere; so small that sums of
// products vanish.
enum { COC_ANY, COC_PATCHES, COC_EVERYWHERE, COC_VANISHING, COC_MODES };

static float coc_value(struct world *w, int mode, int patch)
{
    if (w->bench)
        return rng_float(&w->rng, 0.001f, 1);
    const float v = random_coc(&w->rng, w->setup.storage);
    if (mode == COC_VANISHING && w->setup.storage == HF_STORAGE_FLOAT)
        return v * 1e-36f;
    return mode == COC_PATCHES && patch ? 0 : mode == COC_EVERYWHERE && v == 0 ? 1 : v;
}

// With area kernels, the near and far parts of a quad sum to at most 1, a part has a largest CoC, and what has no part has no
// colour.
static float of_part(struct world *w, int b, int c, int x, int y, float v)
{
    const int field = b == HF_BUF_COLORFAR4 || (b == HF_BUF_COC4 && c % 2);
    if (is_chapter(w) || (b != HF_BUF_COC4 && b != HF_BUF_COLORNEAR4 && b != HF_BUF_COLORFAR4))
        return v;
    if (b == HF_BUF_COC4 && c < HF_AREA_NEAR_MOST)
        return c == HF_AREA_NEAR ? v : fminf(v, 1 - *world_at(w, ARENA_MADE, HF_BUF_COC4, HF_AREA_NEAR, x, y));
    const float part = *world_at(w, ARENA_MADE, HF_BUF_COC4, field, x, y);
    return b == HF_BUF_COC4 ? fmaxf(v, part) : part > 0 ? v : 0;
}

// Buffers of the whole frame are 0 beyond it, where the engine says so.
static int is_zero(const struct world *w, int b, int x, int y)
{
    const int inside = x >= 0 && y >= 0 && x < w->setup.half_width && y < w->setup.half_height;
    return w->engine->plan.zero_beyond && w->engine->bufs[b].frame && b != HF_BUF_COC && !inside;
}

static void fill_buf(struct world *w, int b, struct hf_rect r)
{
    const int mode = rng_int(&w->rng, 0, rng_one_in(&w->rng, 2) ? COC_MODES - 1 : COC_EVERYWHERE);
    const int size = 4 << rng_int(&w->rng, 0, 4);
    const uint32_t pattern = rng_next(&w->rng);
    for (int c = 0; c < buf_channels(w, b); c++)
        for (int y = r.y0; y < r.y1; y++)
            for (int x = r.x0; x < r.x1; x++) {
                const int patch = pattern >> ((x - r.x0) / size + 3 * ((y - r.y0) / 2) + 5 * (c / 2)) % 32 & 1;
                const float v = is_coc(w, b) ? coc_value(w, mode, patch) : buffer_value(w, b, x, y);
                world_put(w, b, c, x, y, is_zero(w, b, x, y) ? 0 : of_part(w, b, c, x, y, v));
            }
}

// A buffer that the flags exclude exists, but nobody has written it.
static int wanted(const struct world *w, int b)
{
    const unsigned near =
        BIT(NEAR) | BIT(BLUR) | BIT(COLOR4) | (is_chapter(w) ? BIT(NEAR_FILL) : BIT(COLORNEAR4) | BIT(COVER));
    const unsigned far = BIT(FAR) | BIT(COLORFAR4) | (is_chapter(w) ? BIT(FAR_FILL) : BIT(FAR_PART));
    return !(!w->near && (near >> b & 1)) && !(!w->far && (far >> b & 1));
}

static void make_inputs(struct world *w, int pass)
{
    const struct hf_pass *p = &w->engine->passes[pass];
    const struct hf_reach halo = w->engine->plan.halo(&w->setup, p->halo);
    const int cover = is_chapter(w) ? w->engine->buf_count : (int)HF_BUF_COVER;  // none, or that
    const unsigned all = p->reads | p->around;
    for (int i = -2; i < w->engine->buf_count; i++) {
        const int b = i == -2 ? cover : i < 0 ? HF_BUF_COC4 : i;  // first: others depend on them
        if (b == w->engine->buf_count || !(all >> b & 1) || i == HF_BUF_COC4 || i == cover || !buf_channels(w, b))
            continue;
        const struct hf_rect r = rows_of(w, b, p->around >> b & 1 ? rect_grown(w->r, halo) : w->r);
        make_buf(w, b, r);
        // Karis weights come from the colour, for either field; what near pixels occlude comes partly from far samples.
        if (wanted(w, b) || (b == HF_BUF_COLOR4 && world_fields(w)->karis) ||
            (b == HF_BUF_COLORFAR4 && !is_chapter(w) && w->gather.leaves))
            fill_buf(w, b, r);
    }
    const int composite = pass == w->engine->pass_count - 1;
    if (pass == HF_PASS_COC || composite)
        make_depth(w, pass == HF_PASS_COC || rng_one_in(&w->rng, 4));
    if (pass == HF_PASS_DOWN || composite)
        make_image(w, &w->src, SLOT_SRC, rng_one_in(&w->rng, 4));
}

static void add_region(struct world *w, enum region_kind kind, int b, int c, struct hf_rect r)
{
    const int bytes = buf_bytes(w, b);
    struct region *g =
        world_region(w, bytes < 4 ? REGION_NARROW : kind, SLOT_BUF + 4 * b + c,
                     hf_narrow_at(&w->buf[b], c, r.x0, r.y0, bytes), (size_t)(r.x1 - r.x0) * (size_t)bytes,
                     HF_PAD * sizeof(float), r.y1 - r.y0, w->buf[b].stride * (ptrdiff_t)sizeof(float));
    g->buf = b;
    g->channel = c;
    g->x0 = r.x0;
    g->y0 = r.y0;
}

void make_output(struct world *w, enum region_kind kind, int b, struct hf_rect r)
{
    make_buf(w, b, r);
    for (int c = 0; c < buf_channels(w, b); c++)
        add_region(w, kind, b, c, r);
}

static void gather_output(struct world *w, enum region_kind kind, int b, struct hf_rect r)
{
    make_buf(w, b, r);
    if (wanted(w, b))
        for (int c = 0; c < buf_channels(w, b); c++)
            if (b != HF_BUF_COC4 || (c % 2 == 0 ? w->near : w->far))
                add_region(w, kind, b, c, r);
}

void make_dst(struct world *w)
{
    const struct hf_rect r = w->r;
    if (w->src.format == w->dst.format && hf_image_channels(&w->src) == hf_image_channels(&w->dst) &&
        rng_one_in(&w->rng, 3)) {
        w->dst = w->src;
    } else {
        make_image(w, &w->dst, SLOT_DST, 0);
    }
    const struct hf_image *m = &w->dst;
    const int slot = m->data[0] == w->src.data[0] ? SLOT_SRC : SLOT_DST;
    for (int i = 0; i < hf_plane_count(m); i++) {
        struct region *g =
            world_region(w, REGION_PIXELS, slot + i,
                         (uint8_t *)m->data[i] + 2 * r.y0 * m->stride[i] + hf_row_bytes(m->format, 2 * r.x0),
                         hf_row_bytes(m->format, hf_min(2 * r.x1, m->width) - 2 * r.x0), 0,
                         hf_min(2 * r.y1, m->height) - 2 * r.y0, m->stride[i]);
        g->channel = i;
        g->x0 = 2 * r.x0;
        g->y0 = 2 * r.y0;
    }
}

static void make_outputs(struct world *w, int pass)
{
    for (int b = 0; b < w->engine->buf_count; b++)
        if (w->engine->passes[pass].writes >> b & 1)
            gather_output(w, REGION_FLOATS, b, rows_of(w, b, w->r));
    if (pass == HF_PASS_COMPUTATION) {
        const struct hf_pass *p = &w->engine->passes[pass];
        const struct hf_rect weighed = rect_grown(w->r, w->engine->plan.halo(&w->setup, HF_HALO_TAPS));
        for (int b = 0; b < w->engine->buf_count; b++)
            if ((p->inside | p->weighed) >> b & 1 && buf_channels(w, b))
                gather_output(w, REGION_SCRATCH, b, p->inside >> b & 1 ? w->r : weighed);
    }
    if (pass == w->engine->pass_count - 1)
        make_dst(w);
}

const struct hf_taps *world_taps(const struct world *w)
{
    return is_chapter(w) ? &w->chapter.taps.taps : &w->gather.levels[0].level[0].kernel.taps;
}

// Scratch is longer than render.c makes it; whole_frame.c tests that render.c's is long enough.
static void make_scratch(struct world *w)
{
    const struct hf_taps *t = world_taps(w);
    const int width = w->r.x1 - w->r.x0, height = w->r.y1 - w->r.y0;
    make_lines(w, HF_LINES, (size_t)(width + 4 * hf_max(world_fields(w)->max_x, t->rx) + 8 + 2 * HF_PAD));
    const size_t rows = 2 * (size_t)t->ry + 1, strips = HF_STRIP_PLANES * HF_STRIP * (size_t)height;
    const size_t known = HF_ROW_FLOATS * (size_t)(height + 2 * t->ry + 2 * 64);
    const size_t gather = strips + known + (rows + 1) * rows * 128 + (2 * (size_t)t->rx + 3) * 256;
    const size_t near = 64 * (size_t)(height + 2 * world_fields(w)->max_y), fill = 3 * w->line_floats;
    const size_t floats = gather > near ? gather : near;
    slot_use(w, SLOT_WORK, (floats > fill ? floats : fill) * sizeof(float), 0xff);
}

void random_area(struct world *w)
{
    struct rng *r = &w->rng;
    const struct hf_setup *s = &w->setup;
    w->r = (struct hf_rect){0, 0, s->half_width, s->half_height};
    if (rng_one_in(r, 2) || w->bench)
        return;
    w->r.x0 = rng_int(r, 0, s->half_width - 1);
    w->r.y0 = rng_int(r, 0, s->half_height - 1);
    w->r.x1 = rng_one_in(r, 2) ? s->half_width : rng_int(r, w->r.x0 + 1, s->half_width);
    w->r.y1 = rng_one_in(r, 2) ? s->half_height : rng_int(r, w->r.y0 + 1, s->half_height);
}

static int is_shared(int pass)
{
    return pass == HF_PASS_COC || (pass >= HF_PASS_MAX_X && pass <= HF_PASS_BLUR_Y);
}

void pass_make(struct world *w, int index)
{
    const int pass = index % CHAPTER_PASS;
    world_clear(w);
    if (index >= CHAPTER_PASS || (is_shared(pass) && rng_one_in(&w->rng, 2)))
        w->engine = &hf_chapter_engine;
    const int half_width = rng_int(&w->rng, 1, 70), half_height = rng_int(&w->rng, 1, 10);
    make_setup(w, w->bench ? 128 : half_width, w->bench ? 64 : half_height);
    random_area(w);
    // Passes with a reach also get random reaches.
    if (!w->bench && pass >= HF_PASS_MAX_X && pass <= HF_PASS_BLUR_Y && rng_one_in(&w->rng, 4)) {
        struct hf_fields *g = world_fields(w);
        g->max_x = g->blur_x = rng_int(&w->rng, 1, 140);
        g->max_y = g->blur_y = rng_int(&w->rng, 1, 140);
        g->edge_x = rng_one_in(&w->rng, 2) ? 1 : rng_float(&w->rng, 0, 1);
        g->edge_y = rng_one_in(&w->rng, 2) ? 1 : rng_float(&w->rng, 0, 1);
    }
    if (pass == HF_PASS_COC)
        w->r.x0 &= ~15;  // as cells are
    w->is_pass = 1;
    w->near = w->far = 1;
    if (!w->bench && (pass == HF_PASS_DOWN || pass >= HF_PASS_COMPUTATION) && rng_one_in(&w->rng, 3))
        rng_one_in(&w->rng, 2) ? (w->near = 0) : (w->far = 0);
    make_scratch(w);
    make_inputs(w, pass);
    make_outputs(w, pass);
}

void pass_call(struct world *w, const struct kernels *k, enum arena a, int index)
{
    const struct hf_passes *passes = is_chapter(w) ? &k->chapter.passes : &k->gather.passes;
    const struct hf_frame f = world_frame(w, k, a);
    if (a == ARENA_REFERENCE)
        w->reference = f;
    passes->pass[index % CHAPTER_PASS](&f, w->r);
}

int pass_check(const struct world *w, const struct level *l, char message[256])
{
    struct hf_counts want = w->result[ARENA_REFERENCE].counts, got = w->result[ARENA_TEST].counts;
    if (!l->exact)
        want.clamped = got.clamped = 0;  // a colour at the end of its range may be clamped in one of them only
    if (memcmp(&want, &got, sizeof want) ||
        memcmp(&w->result[ARENA_REFERENCE].seen, &w->result[ARENA_TEST].seen, sizeof want)) {
        snprintf(message, 256, "other counts than the C: clamped %llu, not %llu", (unsigned long long)got.clamped,
                 (unsigned long long)want.clamped);
        return 0;
    }
    return world_compare(w, l, message);
}

int pass_pixels(const struct world *w)
{
    return (w->r.x1 - w->r.x0) * (w->r.y1 - w->r.y0);
}
