// SPDX-License-Identifier: BSD-3-Clause
// The scatter's kernels one by one: weights and sprites of sources, lists, means, sums. The sums are integers and their
// shares are truncated, so nothing here may be fused: every level has the bits of the C.
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "harness.h"
#include "engine/scatter/kernels.h"
#include "engine/scatter/walk.h"

enum { LINES_IN = 12, LINES_OUT = 8, LINES = LINES_IN + LINES_OUT, INVERSES = 64 };

// The data of a case that do not fit the world.
static struct {
    int which;
    struct hf_scatter scatter;
    struct hf_aperture aperture;  // a disc
    float sign, scale, part[4], inverse[INVERSES];
    int channels, fields, from, columns, rows, x, y, window_x, window_y, width, height;
    struct hf_bins bins;
    int64_t share[4];
    struct hf_run run[40];
    int16_t tap[40 * 12];
} now;

// Line i: n floats with HF_PAD before and after them.
static float *line(const struct world *w, enum arena a, int i)
{
    return (float *)(void *)slot_start(w, a, SLOT_LINES) + (size_t)i * w->line_floats + HF_PAD;
}

static void lines(struct world *w, int longest)
{
    make_lines(w, LINES, (size_t)longest + 2 * HF_PAD);
}

static void put_out(struct world *w, int i, int n)
{
    world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, i), (size_t)n * 4, HF_PAD * 4, 1, 0);
}

// A signed radius: zero, near or far, some similar, some denormal.
static float random_radius(struct rng *r)
{
    switch (rng_int(r, 0, 9)) {
    case 0:
        return 0;
    case 1:
        return 1e-42f;
    case 2:
        return -rng_float(r, 0, 30);
    case 3:
        return rng_float(r, 0.4f, 1.6f);
    case 4:
    case 5:
        return rng_float(r, 7, 7.2f);
    default:
        return rng_float(r, 0, 30);
    }
}

static void fill_radii(struct world *w, int i, int from, int to, int side)
{
    const int calm = rng_one_in(&w->rng, 2);
    for (int x = from; x < to; x++) {
        const float r =
            calm && x > from && !rng_one_in(&w->rng, 6) ? line(w, ARENA_MADE, i)[x - 1] : random_radius(&w->rng);
        line(w, ARENA_MADE, i)[x] = side ? (r < 0 ? rng_one_in(&w->rng, 2) ? -1 : 0 : r) : r;
    }
}

static void fill_colours(struct world *w, int i, int from, int to)
{
    for (int x = from; x < to; x++)
        line(w, ARENA_MADE, i)[x] = random_colour(&w->rng, w->colours);
}

static void fill_weights(struct world *w, int i)
{
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, i)[x] = rng_one_in(&w->rng, 3) ? 0 : rng_float(&w->rng, 0, 1.2f);
}

static void start(struct world *w)
{
    struct rng *r = &w->rng;
    world_clear(w);
    w->colours = w->bench ? COLOURS_PLAIN : rng_one_in(r, 2) ? COLOURS_MIXED : COLOURS_POSITIVE;
    w->n = w->bench ? 256 : rng_int(r, 1, 130);
    const int half = rng_one_in(r, 2);
    now.scatter = (struct hf_scatter){.half_from = half ? -1 : rng_float(r, 1, 20), .fade = half ? 2.5f : 1.5f};
    now.scatter.half_to = half ? 0 : now.scatter.half_from + 4;
    now.scatter.half_slope = 1 / (now.scatter.half_to - now.scatter.half_from);
    now.scatter.fade_slope = 1 / (now.scatter.fade - 0.5f);
    now.scatter.dim = rng_one_in(r, 2) ? 1 : 0x1p-14f;
    now.scatter.undim = 1 / now.scatter.dim;
    now.scatter.most = FLT_MAX * now.scatter.dim;
    now.sign = rng_one_in(r, 2) ? 1 : -1;
    now.scale = rng_one_in(r, 2) ? 1 : rng_float(r, 0.4f, 1.6f);
    now.channels = rng_int(r, 1, 3);
    lines(w, 2 * w->n + 2);
}

// ---- weights, numbers and lists of sources ----

static void weights_make(struct world *w)
{
    fill_radii(w, 0, 0, w->n, 0);
    for (int c = 0; c < 3; c++)
        fill_colours(w, 1 + c, 0, w->n);
    for (int c = 0; c < 4; c++)
        if (c < now.channels || c == 3)
            put_out(w, LINES_IN + c, w->n);
}

static void weights_call(struct world *w, const struct kernels *k, enum arena a)
{
    const float *const colour[3] = {line(w, a, 1), line(w, a, 2), line(w, a, 3)};
    float *const out[4] = {line(w, a, LINES_IN), line(w, a, LINES_IN + 1), line(w, a, LINES_IN + 2),
                           line(w, a, LINES_IN + 3)};
    k->scatter.source_weights(&now.scatter, now.sign, line(w, a, 0), colour, now.channels, w->n, out);
}

static void pictures_make(struct world *w)
{
    fill_radii(w, 0, 0, w->n, 0);
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, 1)[x] = random_coc(&w->rng, HF_STORAGE_FLOAT);
    put_out(w, LINES_IN, w->n);
}

static void pictures_call(struct world *w, const struct kernels *k, enum arena a)
{
    k->scatter.source_pictures(line(w, a, 0), line(w, a, 1), now.scale, w->n, (int32_t *)(void *)line(w, a, LINES_IN));
}

static struct hf_splats *list_of(const struct world *w, enum arena a)
{
    return (struct hf_splats *)(void *)slot_start(w, a, SLOT_WORK);
}

static void list_make(struct world *w)
{
    struct rng *r = &w->rng;
    w->n = w->n < HF_SPLATS ? w->n : HF_SPLATS;
    slot_use(w, SLOT_WORK, HF_BINS * sizeof(struct hf_splats), 0xff);
    now.bins = (struct hf_bins){.count = rng_int(r, 1, HF_BINS), .least = {0.5f, 0.1f, 0.01f}};
    for (int b = 0; b < HF_BINS; b++) {
        list_of(w, ARENA_MADE)[b].count = rng_int(r, 0, HF_SPLATS - w->n);
        for (int c = 0; c < 4; c++)
            now.bins.scale[b][c] = 1 << (c < 3 ? 16 + 6 * b : 20);
    }
    now.bins.least[now.bins.count - 1] = 0;
    now.from = rng_int(r, 0, w->n - 1);
    for (int i = 0; i < INVERSES; i++)
        now.inverse[i] = rng_float(r, 1e-6f, 1);
    for (int x = 0; x < w->n; x++)
        ((int32_t *)(void *)line(w, ARENA_MADE, 4))[x] = rng_one_in(r, 3) ? -1 : rng_int(r, 0, INVERSES - 1);
    for (int i = 0; i < 4; i++)
        for (int x = 0; x < w->n; x++)
            line(w, ARENA_MADE, i)[x] = rng_one_in(r, 6) ? 0 : rng_float(r, i < 3 ? -4 : 0, 4) / (float)(x / 8 + 1);
    world_region(w, REGION_SCRATCH, SLOT_WORK, slot_start(w, ARENA_MADE, SLOT_WORK), HF_BINS * sizeof(struct hf_splats),
                 0, 1, 0);
}

static void list_call(struct world *w, const struct kernels *k, enum arena a)
{
    const struct hf_source_row row = {.x = 5,
                                      .y = 3,
                                      .colour = {line(w, a, 0), line(w, a, 1), line(w, a, 2)},
                                      .weight = line(w, a, 3),
                                      .picture = (const int32_t *)(const void *)line(w, a, 4)};
    k->scatter.list_row(list_of(w, a), &row, now.from, w->n, now.inverse, &now.bins);
}

static int adds_nothing(const int64_t share[4])
{
    return !share[0] && !share[1] && !share[2] && !share[3];
}

// The next entry from i on that adds something.
static int next_entry(const struct hf_splats *list, int i)
{
    while (i < list->count && adds_nothing(list->share[i]))
        i++;
    return i;
}

// A vector kernel may list sources of other bins too, with shares of 0: it lists four at a time.
static int same_lists(const struct world *w, int bin, char message[256])
{
    const struct hf_splats *want = list_of(w, ARENA_REFERENCE) + bin, *got = list_of(w, ARENA_TEST) + bin;
    int i = next_entry(want, 0), j = next_entry(got, 0);
    for (; i < want->count && j < got->count; i = next_entry(want, i + 1), j = next_entry(got, j + 1))
        if (want->x[i] != got->x[j] || want->y[i] != got->y[j] || want->picture[i] != got->picture[j] ||
            memcmp(want->share[i], got->share[j], sizeof want->share[i])) {
            snprintf(message, 256, "entry %d of %d is another than the C's %d of %d", j, got->count, i, want->count);
            return 0;
        }
    if (i < want->count || j < got->count) {
        snprintf(message, 256, "one of the lists goes on at entry %d, the C's at %d", j, i);
        return 0;
    }
    return 1;
}

// ---- means of half resolution ----

static void quad_make(struct world *w)
{
    for (int i = 0; i < 2; i++)
        fill_radii(w, i, 0, 2 * w->n, 0);
    put_out(w, LINES_IN, w->n);
    put_out(w, LINES_IN + 1, w->n);
}

static void site_make(struct world *w)
{
    for (int i = 0; i < 6; i++)
        fill_radii(w, i, -1, w->n + 1, 1);
    put_out(w, LINES_IN, w->n);
}

static void tent_weights_make(struct world *w)
{
    now.from = rng_one_in(&w->rng, 2) ? 0 : rng_int(&w->rng, 0, w->n - 1);
    fill_radii(w, 0, 0, 2 * w->n, 0);
    for (int c = 0; c < 3; c++)
        fill_colours(w, 1 + c, 0, 2 * w->n);
    for (int i = 4; i < 6; i++) {
        fill_radii(w, i, -1, w->n + 1, 1);
        // Mostly the radii that the pixels have, so that some are alike.
        for (int x = 0; x < w->n; x++)
            if (!rng_one_in(&w->rng, 4)) {
                const float like = now.sign * line(w, ARENA_MADE, 0)[2 * x];
                line(w, ARENA_MADE, i)[x] = like > 0 ? like : 0;
            }
    }
    for (int i = 0; i < 8; i++)
        if (i % 4 < now.channels || i % 4 == 3)
            world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, LINES_IN + i) + now.from,
                         (size_t)(w->n - now.from) * 4, HF_PAD * 4, 1, 0);
}

static void tent_weights_call(struct world *w, const struct kernels *k, enum arena a)
{
    struct hf_tent_row t = {.scatter = &now.scatter,
                            .sign = now.sign,
                            .n = w->n,
                            .channels = now.channels,
                            .radius = line(w, a, 0),
                            .colour = {line(w, a, 1), line(w, a, 2), line(w, a, 3)},
                            .own = line(w, a, 4),
                            .next = line(w, a, 5)};
    for (int i = 0; i < 8; i++)
        t.pixel[i / 4][i % 4] = line(w, a, LINES_IN + i);
    w->result[a].returned = k->scatter.tent_weights(&t, now.from) != 0;
}

static void tent_make(struct world *w)
{
    for (int i = 0; i < 2; i++)
        fill_colours(w, i, -1, w->n + 1);
    put_out(w, LINES_IN, w->n);
}

static void mean_make(struct world *w)
{
    for (int i = 0; i < 4; i++) {
        fill_colours(w, i, 0, w->n);
        now.part[i] = rng_float(&w->rng, 0, 1);
    }
    put_out(w, LINES_IN, w->n);
}

static void note_make(struct world *w)
{
    now.channels = rng_int(&w->rng, 3, 4);
    fill_radii(w, 0, 0, w->n, 0);
    for (int c = 0; c < 4; c++)
        fill_colours(w, 1 + c, 0, w->n);
    for (int x = 0; x < w->n; x++)
        if (!rng_one_in(&w->rng, 5))
            line(w, ARENA_MADE, 4)[x] = 1;
}

// ---- slices ----

// Radii, and the rows that are multiplied by their part in a slice.
static void slice_row_make(struct world *w)
{
    fill_radii(w, 0, 0, w->n, 0);
    for (int c = 0; c < 4; c++) {
        fill_colours(w, LINES_IN + c, 0, w->n);
        put_out(w, LINES_IN + c, w->n);
    }
}

// Radii and backs, a slice, and what lies in front of it.
static void slice_behind_make(struct world *w)
{
    slice_row_make(w);
    fill_radii(w, 1, 0, w->n, 0);
    fill_weights(w, 2);
    for (int c = 0; c < 3; c++)
        fill_colours(w, 3 + c, 0, w->n);
    fill_weights(w, 6);
    fill_weights(w, LINES_IN + 3);
    now.from = rng_one_in(&w->rng, 2);
}

static void slice_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_scatter_slice slice = {.begin = {4, 5}, .end = {12, 15}};
    const float *const at[3] = {line(w, a, 0), now.from ? line(w, a, 2) : NULL, line(w, a, 1)};
    float *in[4], *out[4];
    for (int c = 0; c < 4; c++) {
        in[c] = line(w, a, 3 + c);
        out[c] = which == SCATTER_SLICE_ROW || c < now.channels || c == 3 ? line(w, a, LINES_IN + c) : NULL;
    }
    if (which == SCATTER_SLICE_ROW)
        k->scatter.slice_row(&slice, now.sign, at[0], now.channels, w->n, out);
    else
        k->scatter.slice_behind(&now.scatter, at, in, w->n, out);
}

// ---- putting together ----

static void blend_make(struct world *w)
{
    struct rng *r = &w->rng;
    now.x = w->bench ? 0 : rng_int(r, 0, 40);
    now.y = rng_int(r, 0, 30);
    now.fields = w->bench ? 7 : rng_int(r, 0, 7);
    now.width = now.x + w->n + rng_int(r, 0, 20);
    now.height = now.y + 1 + rng_int(r, 0, 20);
    now.scatter.aperture.key.scale_x = rng_one_in(r, 2) ? 1 : rng_float(r, 0.4f, 2);
    fill_radii(w, 0, 0, w->n, 0);
    for (int x = 0; x < w->n; x++)  // smaller radii count as sharp
        if (!(fabsf(line(w, ARENA_MADE, 0)[x]) > 0.5f))
            line(w, ARENA_MADE, 0)[x] = 0;
    for (int i = 1; i < 6; i++)
        i == 2 || i == 4 ? fill_weights(w, i) : fill_colours(w, i, 0, w->n);
    fill_colours(w, LINES_IN, 0, w->n);
    put_out(w, LINES_IN, w->n);
}

// Bits of fields: far, near, what is behind near.
static void blend_call(struct world *w, const struct kernels *k, enum arena a)
{
    const struct hf_setup setup = {.width = now.width, .height = now.height, .own = &now.scatter};
    const struct hf_scatter_row row = {.setup = &setup,
                                       .x = now.x,
                                       .y = now.y,
                                       .n = w->n,
                                       .radius = line(w, a, 0),
                                       .far = now.fields & 1 ? line(w, a, 1) : NULL,
                                       .far_weight = now.fields & 1 ? line(w, a, 2) : NULL,
                                       .near = now.fields & 2 ? line(w, a, 3) : NULL,
                                       .near_weight = now.fields & 2 ? line(w, a, 4) : NULL,
                                       .behind = (now.fields & 6) == 6 ? line(w, a, 5) : NULL};
    k->scatter.blend(&row, line(w, a, LINES_IN));
}

// ---- what lies behind near pixels ----

// Rows to read, and one to write or to add to.
static void rows_make(struct world *w)
{
    for (int i = 0; i < 3; i++)
        fill_colours(w, i, -1, 2 * w->n + 1);
    fill_colours(w, LINES_IN, 0, w->n);
    put_out(w, LINES_IN, now.which == SCATTER_UP ? 2 * w->n : w->n);
}

static void near_make(struct world *w)
{
    fill_radii(w, 0, 0, 2 * w->n, 0);
    fill_radii(w, LINES_IN, 0, w->n, 1);
    put_out(w, LINES_IN, w->n);
}

static void seen_make(struct world *w)
{
    now.from = rng_one_in(&w->rng, 2) ? 0 : rng_int(&w->rng, 0, w->n - 1) & ~1;
    fill_radii(w, 0, 0, w->n, 0);
    fill_radii(w, 1, 0, w->n, 1);
    for (int i = 0; i < 2; i++)
        world_region(w, REGION_FLOATS, SLOT_LINES, line(w, ARENA_MADE, LINES_IN + i) + now.from,
                     (size_t)(w->n - now.from) * 4, HF_PAD * 4, 1, 0);
}

// Radii around, none of them negative.
static void part_make(struct world *w)
{
    for (int x = 0; x < w->n; x++)
        line(w, ARENA_MADE, 0)[x] = rng_one_in(&w->rng, 4) ? 0 : rng_float(&w->rng, 0, 40);
    put_out(w, LINES_IN, w->n);
}

static void behind_make(struct world *w)
{
    now.fields = w->bench ? 3 : rng_int(&w->rng, 0, 3);
    for (int i = 1; i < 10; i++)
        i == 2 || i == 4 || i == 6 || i == 7 ? fill_weights(w, i) : fill_colours(w, i, 0, w->n);
    put_out(w, LINES_IN, w->n);
}

static void behind_call(struct world *w, const struct kernels *k, enum arena a)
{
    const struct hf_setup setup = {.own = &now.scatter};
    const struct hf_scatter_row row = {.setup = &setup,
                                       .n = w->n,
                                       .far = now.fields & 1 ? line(w, a, 1) : NULL,
                                       .far_weight = now.fields & 1 ? line(w, a, 2) : NULL,
                                       .near = now.fields & 2 ? line(w, a, 3) : NULL,
                                       .near_weight = now.fields & 2 ? line(w, a, 4) : NULL};
    const float *const weight[2] = {line(w, a, 6), line(w, a, 7)}, *const colour[2] = {line(w, a, 8), line(w, a, 9)};
    k->scatter.behind_blend(&row, weight, colour, line(w, a, 5), line(w, a, LINES_IN));
}

// Returns 0 if it is none of these.
static int behind_rows_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_behind_kernels *s = &k->pixel.behind;
    const float *const in[3] = {line(w, a, 0), line(w, a, 1), line(w, a, 2)};
    float *const out[2] = {line(w, a, LINES_IN), line(w, a, LINES_IN + 1)};
    if (which == SCATTER_NEAR)
        s->near_row(in[0], w->n, out[0]);
    else if (which == SCATTER_MOST)
        s->most_row(in[0], in[1], in[2], w->n, out[0]);
    else if (which == SCATTER_SEEN_WEIGHTS)
        w->result[a].returned = k->scatter.seen_weights(&now.scatter, in[0], in[1], now.from, w->n, out);
    else if (which == SCATTER_SEEN)
        s->seen_row(in[0], in[1], now.scale, w->n, out[0]);
    else if (which == SCATTER_THIRD)
        s->third_row(in[0], in[1], in[2], w->n, out[0]);
    else if (which == SCATTER_PART)
        s->part_row(in[0], 0.25f, 4, w->n, out[0]);
    else if (which == SCATTER_ADD_PART)
        s->add_part(in[0], in[1], w->n, out[0]);
    else if (which == SCATTER_UP)
        s->up_row(in[0], in[1], w->n, out[0]);
    else if (which == SCATTER_BEHIND)
        behind_call(w, k, a);
    else
        return 0;
    return 1;
}

// ---- sums ----

// A window of sums: its rows one after the other, with their margins.
static int64_t *lane_of(const struct world *w, enum arena a)
{
    return (int64_t *)(void *)slot_start(w, a, SLOT_WORK);
}

static size_t row_lanes(void)
{
    return 4 * (size_t)(now.width + 2 * HF_SUMS_MARGIN);
}

static void window_make(struct world *w)
{
    struct rng *r = &w->rng;
    now.width = w->bench ? 200 : rng_int(r, 1, 60);
    now.height = w->bench ? 40 : rng_int(r, 1, 12);
    now.window_x = rng_int(r, -5, 30);
    now.window_y = rng_int(r, -5, 30);
    const size_t bytes = row_lanes() * (size_t)now.height * sizeof(int64_t);
    slot_use(w, SLOT_WORK, bytes, 0);
    world_region(w, REGION_SCRATCH, SLOT_WORK, lane_of(w, ARENA_MADE), bytes, 0, 1, 0);
    for (int c = 0; c < 4; c++)
        now.share[c] = rng_int(r, c < 3 ? -30000 : 0, 30000);
    now.x = now.window_x + rng_int(r, -30, now.width + 20);
    now.y = now.window_y + rng_int(r, -12, now.height + 3);
    now.rows = rng_int(r, 1, 12);
    now.columns = rng_int(r, 1, 40);
    for (int i = 0; i < 40; i++) {
        const int a = rng_int(r, -5000, 5000);
        now.run[i] = (struct hf_run){a, a + rng_int(r, 0, 9000), rng_int(r, 0, 16)};
    }
    for (int i = 0; i < 40 * 12; i++)
        now.tap[i] = (int16_t)rng_int(r, -1023, 1023);
}

static void splat_make(struct world *w)
{
    struct rng *r = &w->rng;
    window_make(w);
    if (!now.aperture.count) {
        static const struct hf_aperture_key disc = {.largest = 20, .scale_x = 1};
        hf_aperture_build(&now.aperture, &disc, &hf_mem_default, NULL);
    }
    slot_use(w, SLOT_BUF, sizeof(struct hf_splats), 0);
    struct hf_splats *list = (struct hf_splats *)(void *)slot_start(w, ARENA_MADE, SLOT_BUF);
    list->count = rng_int(r, 1, HF_SPLATS);
    for (int i = 0; i < list->count; i++) {
        list->x[i] = now.window_x + rng_int(r, -15, now.width + 15);
        list->y[i] = now.window_y + rng_int(r, -15, now.height + 15);
        list->picture[i] = rng_int(r, 0, hf_picture_number(12));
        for (int c = 0; c < 4; c++)
            list->share[i][c] = rng_int(r, c < 3 ? -30000 : 0, 30000);
    }
}

static void sums_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    static ptrdiff_t rows[64];
    for (int y = 0; y < now.height; y++)
        rows[y] = (ptrdiff_t)(row_lanes() * (size_t)y) + 4 * HF_SUMS_MARGIN;
    const struct hf_sums s = {.lane = lane_of(w, a),
                              .row = rows,
                              .x0 = now.window_x,
                              .y0 = now.window_y,
                              .x1 = now.window_x + now.width,
                              .y1 = now.window_y + now.height};
    if (which == SCATTER_RUNS)
        k->scatter.splat_runs(&s, now.x, now.y, now.run, now.rows, now.share);
    else if (which == SCATTER_TAPS)
        k->scatter.splat_taps(&s, now.x, now.y, now.tap, now.columns, now.rows, now.share);
    else
        k->scatter.splat(&s, &now.aperture, (const struct hf_splats *)(const void *)slot_start(w, a, SLOT_BUF));
}

// Shares that begin or end outside the window may be in any of a row's spare pixels: only the running sum inside
// counts.
static int same_sums(const struct world *w, char message[256])
{
    for (int y = 0; y < now.height; y++) {
        const int64_t *want = lane_of(w, ARENA_REFERENCE) + row_lanes() * (size_t)y;
        const int64_t *got = lane_of(w, ARENA_TEST) + row_lanes() * (size_t)y;
        uint64_t a[4] = {0}, b[4] = {0};
        for (int x = -HF_SUMS_MARGIN; x < now.width; x++, want += 4, got += 4)
            for (int c = 0; c < 4; c++) {
                a[c] += (uint64_t)want[c];
                b[c] += (uint64_t)got[c];
                if (x >= 0 && a[c] != b[c]) {
                    snprintf(message, 256, "the sum of lane %d at (%d, %d) of %d is %lld, the C's %lld", c, x, y,
                             now.width, (long long)b[c], (long long)a[c]);
                    return 0;
                }
            }
    }
    return 1;
}

static void settle_make(struct world *w)
{
    window_make(w);
    now.height = 1;
    now.bins.count = rng_int(&w->rng, 1, HF_BINS);
    const size_t bytes = HF_BINS * row_lanes() * sizeof(int64_t);
    w->region_count = 0;
    slot_use(w, SLOT_WORK, bytes, 0);
    world_region(w, REGION_BYTES, SLOT_WORK, lane_of(w, ARENA_MADE), bytes, 0, 1, 0);
    for (size_t i = 0; i < HF_BINS * row_lanes(); i++)
        lane_of(w, ARENA_MADE)[i] = ((int64_t)rng_int(&w->rng, -1000000, 1000000) << rng_int(&w->rng, 0, 36));
    lines(w, now.width);
    for (int c = 0; c < 4; c++) {
        for (int b = 0; b < HF_BINS; b++)
            now.bins.unscale[b][c] = ldexp(rng_float(&w->rng, 0.5f, 1), -rng_int(&w->rng, 20, 50));
        if (c < now.channels || c == 3)
            put_out(w, LINES_IN + c, now.width);
    }
}

static void settle_call(struct world *w, const struct kernels *k, enum arena a)
{
    float *const out[4] = {line(w, a, LINES_IN), line(w, a, LINES_IN + 1), line(w, a, LINES_IN + 2),
                           line(w, a, LINES_IN + 3)};
    int64_t *lane[HF_BINS];
    for (int b = 0; b < HF_BINS; b++)
        lane[b] = lane_of(w, a) + (size_t)b * row_lanes() + 4 * HF_SUMS_MARGIN;
    k->scatter.settle(lane, now.bins.count, now.width, now.channels, (const double(*)[4])now.bins.unscale, out);
}

// ---- the rows of the table ----

void scatter_make(struct world *w, int which)
{
    static void (*const make[])(struct world *) = {
        [SCATTER_WEIGHTS] = weights_make,     [SCATTER_PICTURES] = pictures_make,
        [SCATTER_LIST] = list_make,           [SCATTER_QUAD] = quad_make,
        [SCATTER_SITE] = site_make,           [SCATTER_TENT_WEIGHTS] = tent_weights_make,
        [SCATTER_TENT] = tent_make,           [SCATTER_MEAN] = mean_make,
        [SCATTER_SLICE_ROW] = slice_row_make, [SCATTER_SLICE_BEHIND] = slice_behind_make,
        [SCATTER_NOTE] = note_make,           [SCATTER_RUNS] = window_make,
        [SCATTER_TAPS] = window_make,         [SCATTER_SPLAT] = splat_make,
        [SCATTER_SETTLE] = settle_make,       [SCATTER_BLEND] = blend_make,
        [SCATTER_NEAR] = near_make,           [SCATTER_MOST] = rows_make,
        [SCATTER_SEEN] = rows_make,           [SCATTER_SEEN_WEIGHTS] = seen_make,
        [SCATTER_THIRD] = rows_make,          [SCATTER_PART] = part_make,
        [SCATTER_ADD_PART] = rows_make,       [SCATTER_UP] = rows_make,
        [SCATTER_BEHIND] = behind_make};
    start(w);
    now.which = which;
    make[which](w);
}

void scatter_call(struct world *w, const struct kernels *k, enum arena a, int which)
{
    const struct hf_scatter_kernels *s = &k->scatter;
    const float *const in[6] = {line(w, a, 0), line(w, a, 1), line(w, a, 2),
                                line(w, a, 3), line(w, a, 4), line(w, a, 5)};
    float *const out = line(w, a, LINES_IN);
    if (behind_rows_call(w, k, a, which))
        return;
    switch (which) {
    case SCATTER_WEIGHTS:
        weights_call(w, k, a);
        return;
    case SCATTER_PICTURES:
        pictures_call(w, k, a);
        return;
    case SCATTER_LIST:
        list_call(w, k, a);
        return;
    case SCATTER_QUAD:
        s->quad_row(&now.scatter, in[0], in[1], w->n, now.sign, (float *const[2]){out, line(w, a, LINES_IN + 1)});
        return;
    case SCATTER_SITE:
        s->site_row(in, in + 3, w->n, out);
        return;
    case SCATTER_TENT_WEIGHTS:
        tent_weights_call(w, k, a);
        return;
    case SCATTER_TENT:
        s->tent(in[0], in[1], w->n, out);
        return;
    case SCATTER_MEAN:
        s->mean_row(in, now.part, w->n, out);
        return;
    case SCATTER_NOTE: {
        float *const colour[4] = {line(w, a, 1), line(w, a, 2), line(w, a, 3), line(w, a, 4)};
        s->note(in[0], colour, now.channels, w->n, &w->result[a].counts);
        return;
    }
    case SCATTER_SLICE_ROW:
    case SCATTER_SLICE_BEHIND:
        slice_call(w, k, a, which);
        return;
    case SCATTER_SETTLE:
        settle_call(w, k, a);
        return;
    case SCATTER_BLEND:
        blend_call(w, k, a);
        return;
    default:
        sums_call(w, k, a, which);
    }
}

int scatter_check(const struct world *w, const struct level *l, char message[256])
{
    const int which = now.which;
    for (int b = 0; which == SCATTER_LIST && b < HF_BINS; b++)
        if (!same_lists(w, b, message))
            return 0;
    if ((which == SCATTER_RUNS || which == SCATTER_TAPS || which == SCATTER_SPLAT) && !same_sums(w, message))
        return 0;
    return row_check(w, l, message);
}
