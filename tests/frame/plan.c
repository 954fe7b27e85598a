// SPDX-License-Identifier: BSD-3-Clause
// The plan: what hf_plan foretells is what hf_render does, and what a scene does not call for is not done. The budget:
// settings follow it, without flicker.
#include <stdlib.h>
#include <string.h>

#include "frame/budget.h"
#include "support/check.h"
#include "support/random_scene.h"

static struct hf_context *context(void)
{
    struct hf_config config = scene_config(HF_ISA_AUTO, 2);
    struct hf_context *c = NULL;
    config.tile_width = 32;
    config.tile_height = 32;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    return c;
}

// All in focus but for what `paint` puts into the depth.
static struct scene sharp(int w, int h)
{
    struct rng rng = rng_seed(5);
    return scene_new(&rng, SCENE_SHARP, w, h, 3);
}

static void put(struct scene *s, int x0, int y0, int x1, int y1, float z)
{
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            s->depth.plane[0][y * s->depth.width + x] = z;
}

static struct hf_report plan(struct hf_context *c, const struct scene *s, const struct hf_params *p)
{
    struct hf_report r;
    const struct hf_image image = picture_image(&s->colour);
    const struct hf_depth depth = picture_depth(&s->depth);
    CHECK_INT(hf_plan(c, &image, &image, &depth, p, &r), HF_OK);
    return r;
}

static struct hf_report render(struct hf_context *c, const struct scene *s, const struct hf_params *p)
{
    struct picture out = picture_new(s->colour.width, s->colour.height, 3);
    struct hf_report r;
    const struct hf_image dst = picture_image(&out), src = picture_image(&s->colour);
    const struct hf_depth depth = picture_depth(&s->depth);
    CHECK_INT(hf_render(c, &dst, &src, &depth, p), HF_OK);
    hf_get_report(c, &r);
    picture_free(&out);
    return r;
}

static uint32_t run_of(const struct hf_report *r, const char *pass)
{
    for (int i = 0; i < r->passes; i++)
        if (!strcmp(r->pass[i].name, pass))
            return r->pass[i].run;
    CHECK_MSG(0, "no pass %s", pass);
    return 0;
}

// The same before and after, but for the times.
static void check_same(const struct hf_report *a, const struct hf_report *b)
{
    CHECK_INT(a->columns, b->columns);
    CHECK_INT(a->rows, b->rows);
    CHECK(!memcmp(a->tile_count, b->tile_count, sizeof a->tile_count));
    CHECK_INT(a->memory, b->memory);
    CHECK_INT(a->memory_saved, b->memory_saved);
    CHECK(a->near_radius == b->near_radius && a->far_radius == b->far_radius);
    for (int i = 0; i < a->passes; i++) {
        CHECK_INT(a->pass[i].run, b->pass[i].run);
        CHECK_INT(a->pass[i].all, b->pass[i].all);
    }
    CHECK(a->total_ms == 0 && b->total_ms > 0);
}

static void planned_and_done(void)
{
    struct hf_context *c = context();
    for (int kind = 0; kind < SCENE_KINDS; kind++) {
        struct rng rng = rng_seed((unsigned)kind + 1);
        struct scene s = scene_new(&rng, (enum scene_kind)kind, 300, 200, 3);
        struct hf_params p = scene_params();
        for (int engine = 0; engine < HF_ENGINE_COUNT; engine++) {
            if (!hf_engine_name((enum hf_engine)engine))
                continue;
            p.engine = (enum hf_engine)engine;
            const struct hf_report before = plan(c, &s, &p), after = render(c, &s, &p);
            check_same(&before, &after);
            // What has been measured is foretold.
            render(c, &s, &p);
            const struct hf_report again = plan(c, &s, &p);
            CHECK(again.tile_count[HF_TILE_SHARP] == (uint32_t)(again.columns * again.rows) || again.predicted_ms > 0);
            // Learned: times differ from frame to frame, and so does what is made of them, in some bit.
            CHECK(again.tile_count[HF_TILE_SHARP] == (uint32_t)(again.columns * again.rows) ||
                  again.predicted_ms != before.predicted_ms);
        }
        scene_free(&s);
    }
    hf_close(&c);
}

// 10 columns, 7 rows of tiles of 64 pixels.
static void only_what_is_called_for(void)
{
    struct hf_context *c = context();
    struct scene s = sharp(640, 448);
    struct hf_params p = scene_params();
    struct hf_report r = plan(c, &s, &p);
    CHECK_INT(r.tile_count[HF_TILE_SHARP], 70);
    CHECK_INT(run_of(&r, "Downsample"), 0);
    CHECK_INT(run_of(&r, "Composite"), 0);
    CHECK(r.near_radius == 0 && r.far_radius == 0);

    // Far CoC stays in its tile; near CoC spreads by twice the reach of 6 and the gather's rim: into all neighbours.
    put(&s, 330, 210, 340, 220, 40);
    r = plan(c, &s, &p);
    CHECK_INT(r.tile_count[HF_TILE_FAR], 1);
    CHECK_INT(r.tile_count[HF_TILE_NEAR], 0);
    CHECK_INT(run_of(&r, "Near CoC Max X"), 0);
    CHECK_INT(run_of(&r, "Computation"), 1);
    uint8_t tiles[10 * 8] = {0};
    CHECK_INT(hf_get_tiles(c, tiles, sizeof tiles), r.columns * r.rows);
    CHECK_INT(tiles[3 * 10 + 5], HF_TILE_FAR);
    CHECK(r.near_radius == 0 && r.far_radius == 12);
    const size_t far_memory = r.memory;
    CHECK(r.memory_saved > 0);
    put(&s, 330, 210, 340, 220, 5);
    r = plan(c, &s, &p);
    // Known by chunks of 64 x 16 pixels: (320..384) x (208..224), and what is less than 26 pixels away from that.
    CHECK_INT(r.tile_count[HF_TILE_NEAR], 6);
    CHECK_INT(r.tile_count[HF_TILE_FAR], 0);
    CHECK_INT(run_of(&r, "Near CoC Max X"), 6);
    put(&s, 100, 100, 110, 110, 40);
    r = plan(c, &s, &p);
    CHECK_INT(r.tile_count[HF_TILE_FAR], 1);
    CHECK(r.memory > far_memory && r.memory_saved == 0);

    p.run.no_skip = 1;
    r = plan(c, &s, &p);
    CHECK_INT(r.tile_count[HF_TILE_BOTH], 70);
    p.run.no_skip = 0;
    p.range.strength = 0;
    r = plan(c, &s, &p);
    CHECK_INT(r.tile_count[HF_TILE_SHARP], 70);
    CHECK(r.memory == 0 || r.memory < far_memory);
    scene_free(&s);
    hf_close(&c);
}

// A machine on which step i takes ms[i], times a load.
struct machine {
    const float *ms;
    struct hf_budget b;
    struct hf_params ladder[HF_BUDGET_STEPS];
    int steps, changes;
};

static void frames(struct machine *m, int n, float load, float budget)
{
    for (int i = 0; i < n; i++) {
        const int before = m->b.step;
        const int step = hf_budget_choose(&m->b, m->ladder, m->steps);
        hf_budget_note(&m->b, budget, m->steps, m->ms[step] * load);
        m->changes += m->b.step != before;
    }
}

static void budget(void)
{
    static const float ms[HF_BUDGET_STEPS] = {10, 7, 4, 4, 4, 4, 4, 4};
    struct machine m = {.ms = ms};
    struct hf_params p = hf_default_params;
    p.max_radius = 24;
    m.steps = hf_budget_ladder(&p, 24, m.ladder);
    CHECK_INT(m.steps, 3);  // 6 rings, 4, 2
    CHECK(m.ladder[1].gather.rings == 4 && m.ladder[2].gather.rings == 2);

    frames(&m, 50, 1, 12);
    CHECK_INT(m.b.step, 0);  // fits
    frames(&m, 50, 1, 8);
    CHECK_INT(m.b.step, 1);
    frames(&m, 50, 1, 5);
    CHECK_INT(m.b.step, 2);
    m.changes = 0;
    frames(&m, 500, 1, 8.5f);  // 7 of 8.5 would fit, but leaves too little room: stays
    CHECK_INT(m.changes, 0);
    frames(&m, 60, 1, 12);  // 7 fits well, 10 with too little room
    CHECK_INT(m.b.step, 1);
    frames(&m, 60, 1, 13);
    CHECK_INT(m.b.step, 0);
    frames(&m, 1, 3, 13);  // one frame that is late changes nothing
    CHECK_INT(m.b.step, 0);
    frames(&m, 3, 3, 1);  // nothing fits: the cheapest
    frames(&m, 20, 3, 1);
    CHECK_INT(m.b.step, 2);
}

// A scene whose better setting looks affordable from below and is not: tries get rarer, and rarer.
static void no_flicker(void)
{
    static const float cheap[HF_BUDGET_STEPS] = {10, 5, 5};
    struct machine m = {.ms = cheap};
    struct hf_params p = hf_default_params;
    p.max_radius = 24;
    m.steps = hf_budget_ladder(&p, 24, m.ladder);
    frames(&m, 20, 1, 9);
    CHECK_INT(m.b.step, 1);
    for (int i = 0; i < 1000; i++)  // light frames while the cheap one runs, heavy ones for the other
        frames(&m, 1, m.b.step == 0 ? 1 : 0.5f, 9);
    CHECK_MSG(m.changes <= 20, "%d changes in 1000 frames", m.changes);
}

static void ladders(void)
{
    struct hf_params ladder[HF_BUDGET_STEPS], p = hf_default_params;
    p.engine = HF_ENGINE_SCATTER;
    p.max_radius = 20;
    const int n = hf_budget_ladder(&p, 20, ladder);
    CHECK(n == 5 && ladder[1].scatter.resolution == HF_RESOLUTION_HALF && ladder[2].engine == HF_ENGINE_GATHER);
    CHECK(ladder[0].engine == HF_ENGINE_SCATTER && ladder[4].gather.rings == 2);
    p.engine = HF_ENGINE_GAUSSIAN;
    CHECK_INT(hf_budget_ladder(&p, 20, ladder), 3);
    CHECK_INT(ladder[2].gaussian.resolution, HF_RESOLUTION_QUARTER);
    p.engine = HF_ENGINE_GATHER;
    p.gather.storage = HF_STORAGE_PACKED;
    p.gather.fill = HF_FILL_NONE;
    CHECK_INT(hf_budget_ladder(&p, 20, ladder), 2);
    CHECK_INT(ladder[1].gather.storage, HF_STORAGE_FLOAT);
}

// No frame fits into a microsecond: after a few, the cheapest setting; the report says so.
static void budget_of_frames(void)
{
    struct hf_context *c = context();
    struct scene s = sharp(200, 100);
    struct hf_params p = scene_params();
    struct hf_report r = {.budget_step = -1};
    put(&s, 0, 0, 200, 100, 40);
    p.max_radius = 24;
    p.run.budget_ms = 1e-3f;
    for (int i = 0; i < 12; i++)
        r = render(c, &s, &p);
    CHECK_INT(r.budget_step, 2);
    CHECK_INT(r.used.params.gather.rings, 2);
    p.run.budget_ms = 0;
    r = render(c, &s, &p);
    CHECK_INT(r.budget_step, 0);
    CHECK_INT(r.used.params.gather.rings, 6);
    scene_free(&s);
    hf_close(&c);
}

// Looked at where it is blurred, and only there.
static void colour(void)
{
    struct hf_context *c = context();
    struct scene s = sharp(640, 448);
    struct hf_params p = scene_params();
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 640 * 448; k++)
            s.colour.plane[i][k] = 0.5f;
    put(&s, 330, 210, 340, 220, 40);
    s.colour.plane[1][5] = 100;              // far from the blur
    s.colour.plane[2][215 * 640 + 335] = 7;  // in it
    s.colour.plane[0][215 * 640 + 333] = NAN;
    struct hf_report r = plan(c, &s, &p);
    CHECK(!r.colour_known);
    p.run.colour_stats = 1;
    r = plan(c, &s, &p);
    CHECK(r.colour_known && r.brightest == 7 && r.opaque);
    CHECK_INT(r.not_finite, 1);
    r = render(c, &s, &p);
    CHECK(r.colour_known && r.brightest == 7 && r.opaque);
    scene_free(&s);
    hf_close(&c);
}

int main(void)
{
    colour();
    planned_and_done();
    only_what_is_called_for();
    budget();
    no_flicker();
    ladders();
    budget_of_frames();
    return check_report();
}
