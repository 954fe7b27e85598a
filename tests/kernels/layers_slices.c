// SPDX-License-Identifier: BSD-3-Clause
// The kernels of layers that weigh and draw slices, those of views, and the one that compares patterns.
#include "layers.h"

void weigh_make(struct world *w)
{
    struct rng *r = &w->rng;
    const float before = rng_float(r, -20, 10), own = before + rng_float(r, 0.5f, 8),
                after = own + rng_float(r, 0.5f, 8);
    now.rows = 1 << rng_int(r, 0, 3);
    now.whole = rng_one_in(r, 3);
    now.slice = (struct hf_slice){.radius = own, .before = before, .after = after, .scale = rng_float(r, 0.01f, 1)};
    now.slice.square = own * own;
    now.slice.before_square = before * before;
    now.slice.before_scale = 1 / (own * own - before * before);
    now.slice.after_scale = 1 / (after * after - own * own);
    for (int y = 0; y < now.rows; y++)
        for (int c = 0; c < 7; c++)  // share last, a part of the weight
            if (c == 5)
                fill_surfaces(w, 8 * c + y, 0, w->n);
            else
                fill(w, 8 * c + y, 0, w->n, c < 4 ? COLOUR : WEIGHT);
    for (int c = 0; c < 5; c++)
        fill(w, IN + c, 0, w->n, COLOUR);
    now.channels = rng_one_in(r, 3) ? 0 : now.channels;  // weights alone
    put_set(w, IN, 5, w->n);
    const size_t any = (size_t)(w->n + 15) / 16;
    slot_use(w, SLOT_WORK, any, 0);
    world_region(w, REGION_BYTES, SLOT_WORK, slot_start(w, ARENA_MADE, SLOT_WORK), any, 0, 1, 0);
}

void weigh_call(const struct world *w, const struct kernels *k, enum arena a)
{
    const float *in[6];
    float *out[6];
    for (int c = 0; c < 6; c++)
        in[c] = line(w, a, 8 * c);
    if (now.whole)
        in[4] = NULL;
    set_of(w, a, IN, out);
    k->layers.weigh(&now.slice, in, now.with ? line(w, a, 48) : NULL, stride(w), now.rows, now.channels, w->n, now.add,
                    out, slot_start(w, a, SLOT_WORK));
}

// Light of either sign, of which all, nothing or some is cut.
void dim_make(struct world *w)
{
    w->colours = COLOURS_PLAIN;
    fill(w, 0, 0, w->n, WEIGHT);
    fill(w, 1, 0, w->n, COLOUR);
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, IN)[x] =
            line(w, ARENA_MADE, 1)[x] * (rng_one_in(&w->rng, 3) ? 1 : rng_float(&w->rng, 0.5f, 2));
    put(w, IN, w->n, 32);
}

// The rays of some pixels leave the row of coverage on either side; pixels after the last one keep what they have.
void passed_make(struct world *w)
{
    struct rng *r = &w->rng;
    const int level = rng_int(r, 1, 4), place = rng_int(r, -40, 40);
    now.rays = (struct hf_layers_rays){.part = rng_float(r, -1, 1),
                                       .most = rng_one_in(r, 4) ? 0 : rng_float(r, 0, 60),
                                       .lamp = (float)place + rng_float(r, -50, 50),
                                       .x = place / 2 + rng_int(r, -30, 10),
                                       .size = 1 / (float)(1 << level),
                                       .above = rng_float(r, 0, 1),
                                       .below = rng_one_in(r, 4) ? 0 : rng_float(r, 0, 1),
                                       .first = (place >> level) + rng_int(r, -20, 10),
                                       .samples = rng_int(r, 1, 2 * w->n)};
    for (int i = 0; i < 2; i++)
        fill(w, i, 0, now.rays.samples, WEIGHT);
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, IN)[x] = rng_one_in(r, 3) ? 0 : rng_float(r, 0, 1);
    put(w, IN, w->n, 0);
    put(w, IN + 1, now.rays.samples, 32);
}

void passed_call(struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_layers_rays rays = now.rays;
    rays.upper = line(w, a, 0);
    rays.lower = line(w, a, 1);
    rays.line = line(w, a, IN + 1);
    w->result[a].returned = k->layers.passed(&rays, w->n, line(w, a, IN));
}

// Planes of two rows: weight, colours. Views see either row of them, displaced by up to 16 pixels.
enum { PLANE_LINES = 16, EYE = 48 };

void views_make(struct world *w)
{
    struct rng *r = &w->rng;
    w->colours = COLOURS_PLAIN;  // samples are finite, as layers clamps them
    w->n = 16 * rng_int(r, 1, 2);
    for (int i = 0; i < PLANES; i++)
        for (int y = 0; y < 2; y++) {
            for (int c = 0; c <= now.channels; c++)
                fill(w, PLANE_LINES * i + 8 * y + c, -16, w->n + 16, c ? COLOUR : WEIGHT);
            float *weight = line(w, ARENA_MADE, PLANE_LINES * i + 8 * y);
            for (int x = -16; x < w->n + 16; x += 16)
                if (rng_one_in(r, 3))
                    memset(weight + x, 0, 16 * sizeof *weight);
        }
    for (int v = 0; v < VIEWS; v++) {
        now.parts[v] = rng_float(r, 0, 2);
        now.point[v][2] = rng_float(r, 0.5f, 1);
    }
    for (int v = 0; v < VIEWS; v++)
        for (int k = 0; k < 2; k++) {
            now.point[v][k] = rng_float(r, -1, 1);
            for (int i = 0; i < PLANES; i++)
                now.shift[i][v][k] = (int16_t)(k ? rng_int(r, 0, 1) : rng_int(r, -16, 16));
        }
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, EYE)[x] = rng_float(r, -1, 1);
    for (int i = 0; i < 11; i++)
        if (i < 10 ? i % 5 < now.channels || i % 5 == 4 : now.with)
            put(w, IN + i, w->n, 0);
}

// Bit 0 of what views_call() gives stands for the first 16 pixels.
static uint32_t held_in(const float *weight, int n)
{
    uint32_t held = 0;
    for (int x = 0; x < n; x++)
        held |= (uint32_t)(weight[x] > 0) << x / 16;
    return held;
}

void views_call(const struct world *w, const struct kernels *k, enum arena a)
{
    uint32_t held[PLANES][2];
    struct hf_view_plane plane[PLANES];
    const struct hf_view_eye eye = {.x = line(w, a, EYE),
                                    .y = now.off,
                                    .sharp = 3,
                                    .point = (const float(*)[3])now.point,
                                    .total = line(w, a, IN + 10)};
    struct hf_view_row row = {.plane = plane,
                              .planes = PLANES,
                              .far = now.rows % (PLANES + 1),
                              .views = VIEWS,
                              .channels = now.channels,
                              .n = w->n,
                              .part = now.add ? now.parts : NULL,
                              .eye = now.with ? &eye : NULL};
    for (int i = 0; i < PLANES; i++) {
        for (int y = 0; y < 2; y++)
            held[i][y] = held_in(line(w, a, PLANE_LINES * i + 8 * y) - 16, w->n + 32);
        plane[i] = (struct hf_view_plane){.at = line(w, a, PLANE_LINES * i),
                                          .row = 8 * stride(w),
                                          .channel = stride(w),
                                          .level = i == 1,
                                          .held = held[i],
                                          .lead = 16,
                                          .shift = (const int16_t(*)[2])now.shift[i]};
    }
    for (int i = 0; i < 5; i++) {
        row.near[i] = line(w, a, IN + i);
        row.beyond[i] = line(w, a, IN + 5 + i);
    }
    k->layers.views(&row);
}

// Rows of any lengths that decrease from the middle outwards.
void disc_make(struct world *w)
{
    struct rng *r = &w->rng;
    now.slice = (struct hf_slice){.rows = rng_int(r, 1, DISC_ROWS), .row = now.disc};
    int n = rng_int(r, -1, 2);
    for (int d = now.slice.rows - 1; d >= 0; d--) {
        now.disc[d] = (struct hf_disc_row){n, rng_float(r, 0, 1)};
        now.slice.reach = n + 1;
        n = hf_min(n + rng_int(r, 0, 3), MOST);
    }
    now.from = rng_int(r, -DISC_ROWS, 0);
    now.to = rng_int(r, now.from, DISC_ROWS + 1);
    // Colours, then weights; where those are 0, colours are too. Often few sources; sums begin with 0, so none is -0.
    const int sparse = rng_one_in(r, 2);
    for (int i = 0; i < 2; i++) {
        fill(w, i, -MOST - 2, w->n + MOST + 2, COLOUR);
        fill(w, 2 + i, -MOST - 2, w->n + MOST + 2, WEIGHT);
        for (int x = -MOST - 2; x < w->n + MOST + 2; x++) {
            float *colour = &line(w, ARENA_MADE, i)[x], *weight = &line(w, ARENA_MADE, 2 + i)[x];
            *weight = !sparse || rng_one_in(r, 40) ? *weight : 0;
            *colour = *weight > 0 ? *colour : 0;
        }
    }
    for (int i = 0; i < 2 * DISC_LINES; i++) {
        fill(w, LINES - 1 - i, 0, w->n, COLOUR);
        for (int x = 0; x < w->n; x++)
            line(w, ARENA_MADE, LINES - 1 - i)[x] += 0.0f;
        put(w, LINES - 1 - i, w->n, 32);
    }
    now.roundings = 4 * MOST + 8;
}

void disc_call(const struct world *w, const struct kernels *k, enum arena a)
{
    const struct hf_layers_sources in = {.upper = line(w, a, 0),
                                         .lower = line(w, a, 1),
                                         .plane = 2 * stride(w),
                                         .planes = 2,
                                         .n = w->n,
                                         .from = now.from,
                                         .to = now.to,
                                         .out = line(w, a, LINES - 2 * DISC_LINES + DISC_ROWS),
                                         .out_plane = DISC_LINES * stride(w),
                                         .stride = stride(w)};
    k->layers.disc(&now.slice, &in);
}

void runs_make(struct world *w)
{
    struct rng *r = &w->rng;
    fill(w, 0, -ROOM, w->n + ROOM, COLOUR);
    for (int k = 1; k < 6; k++)
        for (int x = -ROOM; x + (1 << k) <= w->n + ROOM; x++)
            line(w, ARENA_MADE, k)[x] = line(w, ARENA_MADE, k - 1)[x] + line(w, ARENA_MADE, k - 1)[x + (1 << (k - 1))];
    now.taps = rng_int(r, 1, 3);
    for (int i = 0; i < now.taps; i++) {
        const int start = rng_int(r, -MOST, 20);
        now.run[i] = (struct hf_shape_run){start, rng_int(r, 0, MOST - hf_max(start, 0)), rng_float(r, 0, 1),
                                           rng_float(r, 0, 1), rng_one_in(r, 2) ? 1 : rng_float(r, 0, 1)};
    }
    for (int x = 0; x < w->n + 32; x++)  // 0 where a node does not reach
        line(w, ARENA_MADE, 6)[x] = x >= w->n || rng_one_in(r, 4) ? 0 : rng_float(r, 0, 1);
    now.roundings = 3 * (6 + 4) + 4;
}

// Samples of up to two surfaces, and taps on either side of a place.
void alike_make(struct world *w)
{
    fill_set(w, 0, -16, w->n + 16);
    put(w, IN, w->n, 32);
    put(w, IN + 1, w->n, 32);
    now.taps = rng_int(&w->rng, 0, MOST);
    now.place = (struct hf_pattern_place){rng_float(&w->rng, -30, 30), rng_float(&w->rng, 0.05f, 4)};
    for (int i = 0; i < now.taps; i++) {
        now.around[i] = (struct hf_pattern_tap){.at = rng_int(&w->rng, -16, 16), .weight = sample(w, WEIGHT)};
        for (int c = 0; c < 4; c++)
            now.around[i].colour[c] = sample(w, COLOUR);
    }
}

void alike_call(const struct world *w, const struct kernels *k, enum arena a)
{
    float *in[6];
    set_of(w, a, 0, in);
    k->layers.alike(&now.place, now.around, now.taps, (const float *const *)in, now.channels, w->n, line(w, a, IN),
                    line(w, a, IN + 1));
}
