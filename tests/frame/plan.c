// SPDX-License-Identifier: BSD-3-Clause
// The plan: hf_render does what hf_plan predicts, and skips what a scene does not need. The budget: settings follow it,
// without flicker.
#include <stdlib.h>
#include <string.h>

#include "frame/budget.h"
#include "frame/ladder.h"
#include "support/check.h"
#include "support/render.h"
#include "tools/common/report.h"

// Everything in focus, except what `paint` puts into the depth.
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

static struct tool_report plan(struct hf_context *c, const struct scene *s, const struct hf_params *p)
{
    struct tool_report r;
    const struct hf_image image = picture_image(&s->colour);
    const struct hf_depth depth = picture_depth(&s->depth);
    CHECK_INT(hf_plan(c, &image, &image, &depth, p, NULL), HF_OK);
    tool_report_get(c, &r);
    return r;
}

static struct tool_report report_of(struct hf_context *c, const struct scene *s, const struct hf_params *p)
{
    struct picture out = render_scene(c, s, p);
    struct tool_report r;
    tool_report_get(c, &r);
    picture_free(&out);
    return r;
}

static uint32_t run_of(const struct tool_report *r, const char *pass)
{
    for (int i = 0; i < r->inner.passes; i++)
        if (!strcmp(r->pass[i].name, pass))
            return r->pass[i].run;
    CHECK_MSG(0, "no pass %s", pass);
    return 0;
}

// Two reports are the same, except for times.
static void check_same(const struct tool_report *a, const struct tool_report *b)
{
    CHECK_INT(a->inner.columns, b->inner.columns);
    CHECK_INT(a->inner.rows, b->inner.rows);
    CHECK(!memcmp(a->inner.tile_count, b->inner.tile_count, sizeof a->inner.tile_count));
    CHECK_INT(a->all.memory, b->all.memory);
    CHECK_INT(a->inner.memory_saved, b->inner.memory_saved);
    CHECK(a->all.near_radius == b->all.near_radius && a->all.far_radius == b->all.far_radius);
    for (int i = 0; i < a->inner.passes; i++) {
        CHECK_INT(a->pass[i].run, b->pass[i].run);
        CHECK_INT(a->pass[i].all, b->pass[i].all);
    }
    CHECK(a->all.total_ms == 0 && b->all.total_ms > 0);
}

static void planned_and_done(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
    for (int kind = 0; kind < SCENE_KINDS; kind++) {
        struct rng rng = rng_seed((unsigned)kind + 1);
        struct scene s = scene_new(&rng, (enum scene_kind)kind, 300, 200, 3);
        struct hf_params p = scene_params();
        for (int engine = 0; engine < tool_engines(); engine++) {
            if (!hf_engine_name((enum hf_engine)engine))
                continue;
            p.engine = (enum hf_engine)engine;
            const struct tool_report before = plan(c, &s, &p), after = report_of(c, &s, &p);
            check_same(&before, &after);
            // The measured part is predicted.
            report_of(c, &s, &p);
            const struct tool_report again = plan(c, &s, &p);
            CHECK(again.inner.tile_count[HF_TILE_SHARP] == (uint32_t)(again.inner.columns * again.inner.rows) ||
                  again.all.predicted_ms > 0);
            // Learned costs: times differ from frame to frame, and so do predictions made from them, in some bit.
            CHECK(again.inner.tile_count[HF_TILE_SHARP] == (uint32_t)(again.inner.columns * again.inner.rows) ||
                  again.all.predicted_ms != before.all.predicted_ms);
        }
        scene_free(&s);
    }
    hf_close(&c);
}

// For a frame from which nothing was learned: the wider the lens is open, the longer an engine that follows it takes,
// because of its radii, and in the gather also because of their levels.
static void wider_is_dearer(void)
{
    static const enum hf_engine engines[] = {HF_ENGINE_GATHER, HF_ENGINE_HEXAGON, HF_ENGINE_SCATTER, HF_ENGINE_LAYERS};
    struct rng rng = rng_seed(1);
    struct scene s = scene_new(&rng, (enum scene_kind)0, 300, 200, 3);
    struct hf_params p = scene_params();
    p.model = HF_MODEL_LENS;
    p.max_radius = HF_DERIVE;
    p.lens.focal_length_mm = 400;
    for (size_t e = 0; e < sizeof engines / sizeof *engines; e++) {
        double before = 0;
        float radius = 0;
        p.engine = engines[e];
        for (float f_number = 16; f_number >= 2; f_number /= 2) {
            struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
            p.lens.f_number = f_number;
            const struct tool_report r = plan(c, &s, &p);
            const float most = r.all.near_radius > r.all.far_radius ? r.all.near_radius : r.all.far_radius;
            CHECK_MSG(most > radius && r.all.predicted_ms > before, "%s, f/%g: radius %g, %g ms; before %g, %g ms",
                      hf_engine_name(p.engine), f_number, most, r.all.predicted_ms, radius, before);
            before = r.all.predicted_ms;
            radius = most;
            hf_close(&c);
        }
    }
    scene_free(&s);
}

// 10 columns, 7 rows of tiles of 64 pixels.
static void only_what_is_called_for(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
    struct scene s = sharp(640, 448);
    struct hf_params p = scene_params();
    struct tool_report r = plan(c, &s, &p);
    CHECK_INT(r.inner.tile_count[HF_TILE_SHARP], 70);
    CHECK_INT(run_of(&r, "Downsample"), 0);
    CHECK_INT(run_of(&r, "Composite"), 0);
    CHECK(r.all.near_radius == 0 && r.all.far_radius == 0);

    // Far CoC stays in its tile; near CoC spreads by its reach of 6 and the upsampling's 1, to both sides.
    put(&s, 330, 210, 340, 220, 40);
    r = plan(c, &s, &p);
    CHECK_INT(r.inner.tile_count[HF_TILE_FAR], 1);
    CHECK_INT(r.inner.tile_count[HF_TILE_NEAR], 0);
    CHECK_INT(run_of(&r, "Near CoC Max X"), 0);
    CHECK_INT(run_of(&r, "Computation"), 1);
    uint8_t tiles[10 * 8] = {0};
    CHECK_INT(hf_inspect_tiles(c, tiles, sizeof tiles), r.inner.columns * r.inner.rows);
    CHECK_INT(tiles[3 * 10 + 5], HF_TILE_FAR);
    CHECK(r.all.near_radius == 0 && r.all.far_radius == 12);
    const size_t far_memory = r.all.memory;
    CHECK(r.inner.memory_saved > 0);
    put(&s, 330, 210, 340, 220, 5);
    r = plan(c, &s, &p);
    // Known by chunks of 64 x 16 pixels: (320..384) x (208..224), and everything up to 14 pixels away from that.
    CHECK_INT(r.inner.tile_count[HF_TILE_NEAR], 3);
    CHECK_INT(r.inner.tile_count[HF_TILE_FAR], 0);
    CHECK_INT(run_of(&r, "Near CoC Max X"), 3);
    put(&s, 100, 100, 110, 110, 40);
    r = plan(c, &s, &p);
    CHECK_INT(r.inner.tile_count[HF_TILE_FAR], 1);
    CHECK(r.all.memory > far_memory && r.inner.memory_saved == 0);

    p.run.no_skip = 1;
    r = plan(c, &s, &p);
    CHECK_INT(r.inner.tile_count[HF_TILE_BOTH], 70);
    p.run.no_skip = 0;
    p.range.strength = 0;
    r = plan(c, &s, &p);
    CHECK_INT(r.inner.tile_count[HF_TILE_SHARP], 70);
    CHECK(r.all.memory == 0 || r.all.memory < far_memory);
    scene_free(&s);
    hf_close(&c);
}

// Engines that must find the largest near and far radius find those of the depth.
static void radii_found(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
    struct scene s = sharp(200, 120);
    struct hf_params p = hf_default_params();
    struct hf_depth depth = picture_radii(&s.depth);
    const struct hf_image image = picture_image(&s.colour);
    picture_fill(&s.depth, 0, 0);
    put(&s, 20, 20, 60, 60, -5);
    put(&s, 110, 30, 150, 90, 11);
    p.max_radius = 16;  // a power of two: what is divided by it and multiplied again is as it was
    for (int engine = 0; engine < tool_engines(); engine++) {
        struct tool_report r;
        if (!hf_engine_name((enum hf_engine)engine))
            continue;
        p.engine = (enum hf_engine)engine;
        CHECK_INT(hf_plan(c, &image, &image, &depth, &p, NULL), HF_OK);
        tool_report_get(c, &r);
        CHECK_MSG(r.all.near_radius == 5 && r.all.far_radius == 11, "%s: radii %g and %g", hf_engine_name(p.engine),
                  r.all.near_radius, r.all.far_radius);
    }
    scene_free(&s);
    hf_close(&c);
}

// A machine on which step i takes ms[i] times a load.
struct machine {
    float ms[HF_BUDGET_STEPS];
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

// The steps below an engine for a lens, each of which takes `times` as long as the library knows.
static struct machine machine_of(enum hf_engine engine, float times)
{
    struct machine m = {.steps = 0};
    struct hf_params p = hf_default_params();
    p.engine = engine;
    p.model = HF_MODEL_LENS;
    m.steps = hf_budget_ladder(&p, INFINITY, m.ladder);
    hf_budget_choose(&m.b, m.ladder, m.steps);
    for (int i = 0; i < m.steps; i++)
        m.ms[i] = times * m.b.cost[i];
    return m;
}

// From any engine, with any budget that some step keeps: the fourth frame is of the first step that keeps it, on a fast
// machine as on a slow one, and stays there. So is every engine's below the gather with a lens.
static void at_once(void)
{
    for (int e = 0; e < tool_engines(); e++) {
        struct machine first = machine_of((enum hf_engine)e, 1);
        CHECK_MSG(first.steps > 1 || hf_ladder_farthest(&first.ladder[0]) < INFINITY || first.ms[0] < 20,
                  "nothing is below %s with a lens", hf_engine_name((enum hf_engine)e));
        for (int k = 0; k < first.steps; k++)
            for (float times = 0.125f; times <= 8; times *= 8) {
                struct machine m = machine_of((enum hf_engine)e, times);
                frames(&m, 3, 1, 1.01f * m.ms[k]);
                CHECK_INT(m.b.step, k);
                frames(&m, 100, 1, 1.01f * m.ms[k]);
                CHECK_INT(m.b.step, k);
                CHECK(m.changes <= 1);
            }
    }
}

static void budget(void)
{
    struct machine m = machine_of(HF_ENGINE_SCATTER, 1);
    CHECK(m.steps >= 4);
    const float *ms = m.ms;
    frames(&m, 50, 1, 1.2f * ms[0]);
    CHECK_INT(m.b.step, 0);  // fits
    frames(&m, 3, 1, 1.01f * ms[2]);
    CHECK_INT(m.b.step, 2);  // at once
    m.changes = 0;
    frames(&m, 500, 1, 1.01f * ms[1]);  // the step above fits, but leaves too little room, so nothing changes
    CHECK_INT(m.changes, 0);
    frames(&m, 60, 1, 1.3f * ms[0]);  // all fit well
    CHECK_INT(m.b.step, 0);
    CHECK_INT(m.changes, 1);
    frames(&m, 1, 3, 1.3f * ms[0]);  // a single late frame changes nothing
    CHECK_INT(m.b.step, 0);
    frames(&m, 20, 3, 1);  // nothing fits: the cheapest setting
    CHECK_INT(m.b.step, m.steps - 1);

    // The first frame also pays for memory; if it counted, two frames would be late. Much later than that is no memory.
    m.b = (struct hf_budget){0};
    frames(&m, 2, 2, 1.2f * ms[0]);
    CHECK_INT(m.b.step, 0);
    frames(&m, 50, 1, 1.2f * ms[0]);
    CHECK_INT(m.b.step, 0);
    frames(&m, 2, 100, 1.2f * ms[0]);
    CHECK(m.b.step > 0);

    // A step that takes twice as long as the table has it is left again, and what it took is remembered.
    // Steps are at least a fifth apart, so in a tenth more than this one's time the one above does not fit.
    m = machine_of(HF_ENGINE_SCATTER, 1);
    m.ms[2] *= 2;
    frames(&m, 3, 1, 1.1f * ms[2] / 2);
    CHECK_INT(m.b.step, 2);
    frames(&m, 200, 1, 1.1f * ms[2] / 2);
    CHECK_INT(m.b.step, 3);
    CHECK_INT(m.changes, 2);
}

// A scene whose better setting looks affordable from the cheaper one but is not: tries become rarer and rarer.
static void no_flicker(void)
{
    struct machine m = machine_of(HF_ENGINE_SCATTER, 1);
    const float budget = 1.01f * m.ms[2];
    frames(&m, 20, 1, budget);
    CHECK_INT(m.b.step, 2);
    m.changes = 0;
    for (int i = 0; i < 1000; i++)  // light frames while the cheap setting runs, heavy ones with the others
        frames(&m, 1, m.b.step < 2 ? 1 : 0.1f, budget);
    CHECK_MSG(m.changes <= 20, "%d changes in 1000 frames", m.changes);
}

// The caller's setting comes first, then the steps of the ladder that cost less, most expensive first.
static void ladders(void)
{
    struct hf_params ladder[HF_BUDGET_STEPS], p = hf_default_params();
    for (int e = 0; e < tool_engines(); e++) {
        p.engine = (enum hf_engine)e;
        p.lens.world_unit_m = 0.125f;
        p.focus = 3;
        const int n = hf_budget_ladder(&p, 0, ladder);
        CHECK(!memcmp(&ladder[0], &p, sizeof p));
        for (int i = 1; i < n; i++) {
            CHECK_MSG(hf_ladder_ms(&ladder[i]) < hf_ladder_ms(&ladder[i - 1]), "%s, step %d", hf_engine_name(p.engine),
                      i);
            CHECK(ladder[i].lens.world_unit_m == 0.125f && ladder[i].focus == 3);  // the ladder does not change these
        }
        if (n > 1)
            CHECK(hf_ladder_ms(&ladder[n - 1]) == hf_ladder[0].ms);
    }
    // From a step, only the steps below it remain that reach as far as asked, or as far as the step itself.
    for (int k = 1; k < hf_ladder_steps; k++)
        for (int far = 0; far <= 2048; far += 2048) {
            hf_ladder_apply(&p, k);
            int want = 1;
            for (int i = 0; i < k; i++) {
                struct hf_params step = p;
                hf_ladder_apply(&step, i);
                want += hf_ladder_farthest(&step) >= fminf((float)far, hf_ladder_farthest(&p));
            }
            // Where no step is as cheap as the one beneath the ladder, that comes last.
            want += want == 1 || far > 0;
            CHECK_INT(hf_budget_ladder(&p, (float)far, ladder), want);
        }
    // Shapes that a cheaper engine cannot draw are replaced by those that it can.
    p = hf_default_params();
    p.engine = HF_ENGINE_SCATTER;
    p.aperture.ring = 0.5f;
    p.aperture.blades = 7;
    p.aperture.chromatic = 0.125f;
    for (int i = hf_budget_ladder(&p, 0, ladder) - 1; i >= 0; i--)
        CHECK(hf_ladder_can_draw(&ladder[i]));
}

// Whether a step is the first that reaches any radius. On scenes beyond the reach of the steps before, those do not
// count.
static int starts_to_reach(int i)
{
    struct hf_params before = hf_default_params(), p = before;
    hf_ladder_apply(&before, i - 1);
    hf_ladder_apply(&p, i);
    return hf_ladder_farthest(&before) < INFINITY && hf_ladder_farthest(&p) == INFINITY;
}

// The ladder rises, and qualities choose from it.
static void choices(void)
{
    struct hf_params p = hf_default_params();
    struct tool_choice last = {.inner = {.step = -1}}, c;
    p.max_radius = 0;                   // every step reaches as far
    static const float same = 1.0116f;  // 0.1 dB, by which a step may be worse on a scene
    // 0.2 dB, by which a step errs less at least; the table's errors are rounded to 5e-7, a relative 2e-5.
    static const float step = 1.0233f * (1 - 4e-5f);
    for (int i = 1; i < hf_ladder_steps; i++)
        CHECK_MSG(hf_ladder[i].ms > hf_ladder[i - 1].ms && step * hf_ladder[i].error <= hf_ladder[i - 1].error &&
                      (starts_to_reach(i) || hf_ladder[i].worst <= same * hf_ladder[i - 1].worst),
                  "step %d", i);
    for (int i = 0; i < hf_ladder_steps; i++) {
        const char *name = hf_engine_name(hf_ladder[i].params.engine),
                   *words = hf_ladder[i].options + strlen("--engine ");
        CHECK_MSG(!strncmp(words, name, strlen(name)), "%s has parameters of the %s engine", hf_ladder[i].options,
                  name);
        hf_ladder_apply(&p, i);
        CHECK_MSG(hf_ladder_hash(&p) == hf_ladder_hash(&hf_ladder[i].params), "%s", hf_ladder[i].options);
        CHECK_MSG(hf_ladder_ms(&p) == hf_ladder[i].ms, "%s is another step", hf_ladder[i].options);
    }
    p = hf_default_params();
    p.max_radius = 0;
    for (int q = 0; hf_name(HF_NAMES_QUALITY, q); q++) {
        CHECK_INT(tool_choose(720, NULL, &p, (enum hf_quality)q, 0, &c), HF_OK);
        CHECK(c.inner.step >= last.inner.step && c.inner.steps == hf_ladder_steps &&
              c.inner.options == hf_ladder[c.inner.step].options);
        CHECK(c.all.error == hf_ladder[c.inner.step].error && hf_ladder_ms(&p) == c.all.ms);
        last = c;
    }
    CHECK_INT(last.inner.step, hf_ladder_steps - 1);
    CHECK_INT(hf_choose_quality(720, NULL, &p, HF_QUALITY_DRAFT, NULL, NULL), HF_OK);
    CHECK(hf_ladder_farthest(&p) == INFINITY);
    for (int i = 0; i < hf_ladder_steps; i++) {
        CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, hf_ladder[i].error, &c), HF_OK);
        CHECK_INT(c.inner.step, i);
        CHECK(hf_ladder_ms(&p) == hf_ladder[i].ms);
    }
    CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, 1e-6f, &c),
              HF_OK);  // nothing errs so little: the best there is
    CHECK_INT(c.inner.step, hf_ladder_steps - 1);
    CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, 1, &c), HF_OK);
    CHECK_INT(c.inner.step, 0);
    // The last step can draw everything.
    static const struct hf_image any = {.size = sizeof any};
    p.aperture = (struct hf_aperture_params){
        .blades = 7, .ring = 0.5f, .squeeze = 2, .cat_eye = 1, .roundness = 0.5f, .chromatic = 0.1f, .picture = &any};
    tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, 0, &c);
    CHECK(hf_ladder_can_draw(&p));
    CHECK(hf_ladder_ms(&p) == hf_ladder[c.inner.step].ms);
    CHECK_INT(hf_choose_error(720, NULL, &p, 0, NULL, NULL), HF_ERR_ARG);
    CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, (float)NAN, &c), HF_ERR_ARG);
    CHECK_INT(hf_choose_quality(720, NULL, NULL, HF_QUALITY_BEST, NULL, NULL), HF_ERR_ARG);
    CHECK_INT(tool_choose(720, NULL, &p, (enum hf_quality)4, 0, &c), HF_ERR_ARG);
    CHECK_INT(tool_choose(720, NULL, &p, (enum hf_quality) - 1, 0, &c), HF_ERR_ARG);
}

// The radius that a chosen step has to reach for a picture of this height.
static float farthest_of(struct hf_params p, int height, const struct hf_depth *depth, int *passed)
{
    struct tool_choice c;
    CHECK_INT(tool_choose(height, depth, &p, HF_QUALITY_DRAFT, 1, &c), HF_OK);
    CHECK_INT(!c.all.why, !c.inner.passed);
    *passed = c.inner.passed;
    return hf_ladder_farthest(&p);
}

// A step that does not reach the blur asked for is skipped; a higher quality never chooses a lower step.
static void reaches(void)
{
    static const struct hf_depth radii = {.size = sizeof radii, .type = HF_DEPTH_COC};
    struct hf_params p = hf_default_params(), lens = p, cut = p;
    lens.model = cut.model = HF_MODEL_LENS;
    cut.max_radius = 4;
    int passed;
    struct tool_choice c, all;
    // The cheapest step is a blur of one width, which is enough for the chapter's radii but not for a lens.
    CHECK(farthest_of(p, 540, NULL, &passed) < INFINITY);
    CHECK(farthest_of(p, 1080, NULL, &passed) >= 12);
    CHECK(farthest_of(p, 16384, NULL, &passed) >= 12.f * 16384 / 1080);
    CHECK(passed > 0);
    CHECK(farthest_of(lens, 540, NULL, &passed) == INFINITY);
    CHECK(passed > 0);
    const int lens_passed = passed;
    CHECK(farthest_of(p, 540, &radii, &passed) == INFINITY);
    CHECK_INT(passed, lens_passed);
    CHECK(farthest_of(cut, 540, NULL, &passed) >= 4);
    CHECK_INT(passed, 0);
    // The display's height counts.
    p.view.display_height = 16384;
    CHECK(farthest_of(p, 540, NULL, &passed) >= 12.f * 16384 / 1080);
    // A draft is the first step that reaches any radius, for any radius asked for.
    p = hf_default_params();
    CHECK_INT(tool_choose(540, NULL, &p, HF_QUALITY_DRAFT, 0, &c), HF_OK);
    CHECK(c.inner.step == lens_passed && c.inner.passed == 0 && p.engine == HF_ENGINE_GATHER);
    for (float r = 0; r <= 2048; r = r < 64 ? r + 0.5f : 2 * r) {
        int last = -1;
        for (int q = 0; hf_name(HF_NAMES_QUALITY, q); q++) {
            p = lens;
            p.max_radius = r;
            CHECK_INT(tool_choose(720, NULL, &p, (enum hf_quality)q, 0, &c), HF_OK);
            CHECK(hf_ladder_farthest(&p) >= r);
            CHECK(c.inner.step >= last);
            last = c.inner.step;
        }
    }
    // By error too: the first step that reaches the radius and errs no more.
    for (int i = 0; i < hf_ladder_steps; i++) {
        p = lens;
        CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, hf_ladder[i].error, &c), HF_OK);
        CHECK(c.inner.step >= i && c.all.error <= hf_ladder[i].error && hf_ladder_farthest(&p) == INFINITY);
        p = cut;
        CHECK_INT(tool_choose(720, NULL, &p, HF_QUALITY_DRAFT, hf_ladder[i].error, &all), HF_OK);
        CHECK(all.inner.step == i && all.inner.step + c.inner.passed == c.inner.step);
    }
    CHECK_INT(tool_choose(0, NULL, &p, HF_QUALITY_DRAFT, 0, &c), HF_ERR_ARG);
    CHECK_INT(tool_choose(0, NULL, &p, HF_QUALITY_DRAFT, 0.1f, &c), HF_ERR_ARG);
}

// The report does not claim that passes found all sharp if settings leave them out.
static void reasons(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
    struct scene s = sharp(200, 100);
    struct hf_params p = scene_params();
    put(&s, 0, 0, 200, 100, 40);
    for (int e = 0; e < tool_engines(); e++) {
        p.engine = (enum hf_engine)e;
        const struct tool_report r = plan(c, &s, &p);
        int left_out = 0;
        CHECK_INT(r.inner.tile_count[HF_TILE_SHARP], 0);
        for (int i = 0; i < r.inner.passes; i++) {
            if (r.pass[i].run == 0)
                left_out += r.pass[i].skipped && !strcmp(r.pass[i].skipped, "the settings do not call for it");
            CHECK_MSG(!r.pass[i].skipped || strcmp(r.pass[i].skipped, "sharp: copied"), "%s, %s",
                      hf_engine_name(p.engine), r.pass[i].name);
        }
        // The gaussian's passes for sigma, patterns of layers.
        CHECK_INT(left_out > 0, e == HF_ENGINE_GAUSSIAN || e == HF_ENGINE_LAYERS);
    }
    scene_free(&s);
    hf_close(&c);
}

static void count_warnings(void *cookie, const struct hf_message *message)
{
    *(int *)cookie += message->level == HF_LOG_WARNING && !strcmp(message->argument, "run.budget_ms");
}

// No frame fits into a microsecond: after a few frames the cheapest setting is used; the report says so, and the log
// once.
static void budget_of_frames(void)
{
    int warned = 0;
    const struct hf_config config = {.size = sizeof config, .threads = 2, .log = count_warnings, .log_cookie = &warned};
    struct hf_context *c;
    CHECK_INT(hf_open(&c, &config), HF_OK);
    struct scene s = sharp(200, 100);
    struct hf_params p = scene_params();
    struct tool_report r = {.all = {.budget_step = -1}};
    put(&s, 0, 0, 200, 100, 40);
    p.engine = HF_ENGINE_SCATTER;
    p.max_radius = 24;
    p.run.budget_ms = 1e-3f;
    struct hf_params ladder[HF_BUDGET_STEPS];
    const int steps = hf_budget_ladder(&p, p.max_radius, ladder);
    for (int i = 0; i < 4 * HF_BUDGET_STEPS; i++)
        r = report_of(c, &s, &p);
    CHECK_INT(r.all.budget_step, steps - 1);
    CHECK_INT(r.params.engine, ladder[steps - 1].engine);
    CHECK_INT(r.all.budget_steps, steps);
    CHECK(r.inner.budget_options && strstr(r.inner.budget_options, hf_engine_name(r.params.engine)));
    CHECK_INT(warned, 1);
    p.run.budget_ms = 0;
    r = report_of(c, &s, &p);
    CHECK_INT(r.all.budget_step, 0);
    CHECK(r.all.budget_steps == 0 && !r.inner.budget_options);
    p.run.budget_ms = 1e6f;
    r = report_of(c, &s, &p);
    CHECK(r.all.budget_steps == steps && !r.inner.budget_options);
    CHECK_INT(warned, 1);
    CHECK_INT(r.params.engine, HF_ENGINE_SCATTER);
    scene_free(&s);
    hf_close(&c);
}

// Colour is read where it is blurred, and only there.
static void colour(void)
{
    struct hf_context *c = context_new(HF_ISA_AUTO, 2, 32, 32);
    struct scene s = sharp(640, 448);
    struct hf_params p = scene_params();
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 640 * 448; k++)
            s.colour.plane[i][k] = 0.5f;
    put(&s, 330, 210, 340, 220, 40);
    s.colour.plane[1][5] = 100;              // far from the blur
    s.colour.plane[2][215 * 640 + 335] = 7;  // in it
    s.colour.plane[0][215 * 640 + 333] = NAN;
    struct tool_report r = plan(c, &s, &p);
    CHECK(!r.inner.colour_known);
    hf_inspect_colour(c, 1);
    r = plan(c, &s, &p);
    CHECK(r.inner.colour_known && r.inner.brightest == 7 && r.inner.opaque);
    CHECK_INT(r.inner.not_finite, 1);
    r = report_of(c, &s, &p);
    CHECK(r.inner.colour_known && r.inner.brightest == 7 && r.inner.opaque);
    scene_free(&s);
    hf_close(&c);
}

static void one_by_one(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    (void)cookie;
    for (int i = 0; i < n; i++)
        fn(arg, i, 0);
}

// With many threads a frame is cut into more cells, among them the strips in which layers looks for what is hidden, and keeps
// its bits. Two threads have the cells that the engine measured.
static void many_threads(void)
{
    static const int threads[] = {2, 5, 32, 128};
    struct hf_params p = hf_default_params();
    struct scene s = sharp(640, 400);
    struct picture first = {.width = 0};
    int before = 0;
    put(&s, 100, 60, 380, 300, 1);
    put(&s, 400, 0, 640, 400, 90);
    p.engine = HF_ENGINE_LAYERS;
    p.max_radius = 9;
    for (int i = 0; i < 4; i++) {
        struct hf_context *c;
        const struct hf_config config = {.size = sizeof config, .threads = threads[i], .parallel_for = one_by_one};
        CHECK_INT(hf_open(&c, &config), HF_OK);
        struct picture out = render_scene(c, &s, &p);
        struct tool_report r;
        tool_report_get(c, &r);
        const int cells = r.inner.columns * r.inner.rows;
        CHECK_MSG(cells >= before, "%d threads: %d cells, fewer threads %d", threads[i], cells, before);
        if (i == 0) {
            CHECK(r.inner.tile_width == 320 && r.inner.tile_height == 192);
            first = out;
        } else {
            CHECK(picture_same_bits(&first, &out));
            picture_free(&out);
        }
        // 400 rows in tiles of 48 rows or less.
        CHECK_MSG(threads[i] < 32 || cells >= 2 * 9, "%d threads, %d cells of %d rows", threads[i], cells,
                  r.inner.tile_height);
        before = cells;
        hf_close(&c);
    }
    picture_free(&first);
    scene_free(&s);
}

int main(void)
{
    many_threads();
    colour();
    planned_and_done();
    wider_is_dearer();
    only_what_is_called_for();
    radii_found();
    budget();
    at_once();
    no_flicker();
    ladders();
    choices();
    reaches();
    budget_of_frames();
    reasons();
    return check_report();
}
