// SPDX-License-Identifier: BSD-3-Clause
// One frame, step by step. The first sweep reads the depth, chunk by chunk, and makes the first buffers where they will
// certainly be read. Its findings make the plan. Chunks that the plan reads and that are missing are made. The other
// sweeps take each cell through its passes while its buffers are in the cache. A step begins when the last one has
// ended, so a frame takes the same path the first time and later, in place and out of place, on any number of threads. Only
// cells of the later sweeps begin when what they read is done, on the context's own threads: a host's may not wait.
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/system.h"
#include "frame/buffers.h"
#include "frame/dump.h"
#include "frame/report.h"
#include "frame/sweep.h"

static int cancelled(const struct hf_render *r)
{
    return hf_stopped(r->s->stop) ? HF_ERR_CANCELLED : HF_OK;
}

static void run_task(void *arg, int i, int worker)
{
    struct hf_render *r = arg;
    if (!hf_stopped(r->s->stop))
        r->task(r, i, worker);
}

// fn(r, i, worker) for i in [0, n), on the pool or on the host's threads. HF_ERR_CANCELLED.
static int parallel(struct hf_render *r, int n, void (*fn)(void *arg, int i, int worker))
{
    struct hf_context *c = r->c;
    r->task = fn;
    if (n == 1)
        run_task(r, 0, 0);
    else if (n > 0 && c->pool)
        hf_pool_run(c->pool, n, run_task, r);
    else if (n > 0)
        c->config.parallel_for(c->config.parallel_cookie, n, run_task, r);
    hf_progress_add(&r->progress, 0, 0);  // other threads may have had all of the work
    return cancelled(r);
}

static void start_workers(const struct hf_render *r, const struct hf_job *job)
{
    struct hf_context *c = r->c;
    for (int i = 0; i < c->threads; i++) {
        struct hf_worker *w = &c->workers[i];
        w->counts = (struct hf_counts){.radius_min = HUGE_VALF, .radius_max = -HUGE_VALF};
        memset(&w->seen, 0, sizeof w->seen);
        w->looked = (struct hf_counts){.brightest = -FLT_MAX, .alpha_min = 1};
        memset(w->ns, 0, sizeof w->ns);
        memset(w->tiles, 0, sizeof w->tiles);
        w->frame.s = r->s;
        w->frame.k = &c->kernels[job->fused];
        w->frame.kernels = c->engine[r->s->engine].kernels[job->fused];
        w->frame.src = job->src;
        w->frame.dst = job->dst;
        w->frame.depth = job->depth;
        w->frame.repaired = 0;
        w->frame.counts = &w->counts;
        w->frame.seen = &w->seen;
    }
}

static int lay_out_chunks(struct hf_render *r)
{
    struct hf_context *c = r->c;
    hf_plan_chunks(&c->plan, hf_engine_def(r->s->engine), r->s, c->config.tile_width, c->config.tile_height, c->threads,
                   c->dump != NULL);
    const int err = hf_block_grow(&c->chunks, hf_plan_chunk_bytes(&c->plan), &c->mem);
    if (!err)
        hf_plan_chunk_memory(&c->plan, c->chunks.data);
    return err;
}

// Lay out the cells, and memory for them and for the fields' buffers. Pages that no field touches cost nothing.
static int lay_out_cells(struct hf_render *r, unsigned fields)
{
    struct hf_context *c = r->c;
    hf_plan_cells(&c->plan, r->s, c->config.tile_width, c->config.tile_height, c->threads, c->dump != NULL);
    const int err = hf_block_grow(&c->tiles, hf_plan_tile_bytes(&c->plan), &c->mem);
    if (err)
        return err;
    hf_plan_tile_memory(&c->plan, c->tiles.data);
    r->have = fields;
    const int queue = hf_queue_lay_out(&c->queue, &c->plan, r->s, &c->mem);
    return queue ? queue : hf_buffers_allocate(c, r->s, fields);
}

// Lay out chunks, cells and buffers, as far as they are known before the depth is.
static int lay_out(struct hf_render *r, unsigned fields)
{
    const int err = lay_out_chunks(r);
    return err ? err : lay_out_cells(r, fields);
}

// The depth decides which chunks, tiles and passes there are.
static int make_plan(struct hf_render *r, struct hf_setup *s, enum hf_task task)
{
    struct hf_context *c = r->c;
    struct hf_plan *p = &c->plan;
    if (s->measured) {
        const struct hf_counts found = hf_report_counts(c);
        int err = p->engine->own.measure(c->engine[s->engine].own, s, &found, &c->mem);
        if (!err)
            err = lay_out_cells(r, 0);
        if (err)
            return err;
    }
    const int err = parallel(r, p->rows[2], hf_sweep_classify);
    if (err)
        return err;
    hf_plan_settle(p, r->s, r->copy.in_place);
    hf_plan_reads(p, r->s, &c->reads[0], &c->reads[1]);
    return task != HF_TASK_RENDER || !s->measured ? HF_OK : lay_out_cells(r, p->reads);
}

static int look_at_colour(struct hf_render *r)
{
    const int err = parallel(r, hf_plan_count(&r->c->plan, 1), hf_sweep_colour);
    hf_report_colour(r->c);
    return err;
}

static int finish_chunks(struct hf_render *r)
{
    struct hf_context *c = r->c;
    const int err = parallel(r, c->plan.rest_count, hf_sweep_rest);
    if (!err && c->plan.engine->own.made) {
        const struct hf_counts found = hf_report_counts(c);
        c->plan.engine->own.made(c->engine[r->s->engine].own, r->s, &found);
    }
    return err;
}

static int make_tiles(struct hf_render *r)
{
    const struct hf_plan *p = &r->c->plan;
    struct hf_queue *q = &r->c->queue;
    int err = HF_OK;
    // Sweeps of one cell each run on the caller's thread, whose buffers a dump shows.
    if (p->needs && r->c->pool && r->c->threads > 1 && p->engine->plan.waits && q->count > q->steps) {
        hf_queue_fill(q, r->c->threads);
        return parallel(r, q->count, hf_sweep_next);
    }
    for (r->sweep = 2; !err && r->sweep <= p->engine->sweeps; r->sweep++)
        if (r->sweep == p->engine->sweeps || (p->needs && hf_plan_sweep_runs(p, r->s, r->sweep)))
            err = parallel(r, hf_plan_count(p, r->sweep), hf_sweep_cell);
    return err;
}

static void report_plan(struct hf_render *r, int64_t planning)
{
    const struct hf_counts found = hf_report_counts(r->c);
    hf_report_plan(r->c, r->s, &found);
    r->c->report.plan_ms = (double)planning * 1e-6;
}

// After the first sweep: the units of work of each pass on a cell, and of all that is left. A unit is predicted to take a
// nanosecond; the copy of a tile counts as one.
static void begin_progress(struct hf_render *r)
{
    const struct hf_context *c = r->c;
    uint64_t all = (uint64_t)hf_plan_count(&c->plan, 2);
    for (int i = 0; i < c->report.passes; i++) {
        const struct hf_frame_pass *pass = &c->report.pass[i];
        uint32_t left = pass->run;
        for (int k = 0; k < c->threads; k++)
            left -= left > c->workers[k].tiles[i] ? c->workers[k].tiles[i] : left;
        if (!pass->run)
            continue;
        r->progress.pass[i] = (uint64_t)(pass->predicted_ms * 1e6 / pass->run) + 1;
        all += left * r->progress.pass[i];
    }
    hf_progress_stage(&r->progress, 100, all);
}

static int touch(struct hf_render *r, const struct hf_block *block)
{
    r->touched = block;
    return parallel(r, (int)((block->size + HF_TOUCH_BYTES - 1) / HF_TOUCH_BYTES), hf_sweep_touch);
}

// Allocate memory for all that the frame may need, and write to it: its pages then exist. All threads write, so it is
// in their caches, as in any later frame.
static int take_memory(struct hf_render *r)
{
    struct hf_context *c = r->c;
    int err = hf_buffers_allocate(c, r->s, HF_FIELDS);
    if (!err)
        err = touch(r, &c->planes);
    for (int i = 0; i < c->threads && !err; i++)
        err = touch(r, &c->workers[i].scratch);
    return err;
}

static double ms_since(int64_t start)
{
    return (double)(hf_now_ns() - start) * 1e-6;
}

// A frame without blur: its depth is not read.
static int copy(struct hf_render *r, enum hf_task task)
{
    struct hf_context *c = r->c;
    const int64_t start = hf_now_ns();
    int err = lay_out(r, 0);
    if (err)
        return err;
    hf_report_copy(c, r->s);
    if (task != HF_TASK_RENDER)
        return HF_OK;
    const int tiles = hf_plan_count(&c->plan, 2);
    r->copy.raw = r->copy.alike;
    hf_progress_stage(&r->progress, 100, (uint64_t)tiles);
    if (r->copy.in_place) {
        err = parallel(r, tiles, hf_sweep_check);
        err = err ? err : hf_copy_repair(c);
    }
    if (!err)
        err = parallel(r, tiles, hf_sweep_copy);
    if (err)
        return err;
    c->workers[0].counts.sharp_pixels = (uint64_t)r->s->width * (uint64_t)r->s->height;
    hf_report_frame(c, ms_since(start));
    return HF_OK;
}

enum { LOOK = 10 };  // hundredths of a frame that the first sweep counts for

static int blur(struct hf_render *r, struct hf_setup *s, enum hf_task task)
{
    struct hf_context *c = r->c;
    const struct hf_engine_def *engine = hf_engine_def(s->engine);
    int err =
        engine->own.prepare ? engine->own.prepare(c->engine[s->engine].own, s, &s->resolved->params, &c->mem) : HF_OK;
    const int64_t start = hf_now_ns();
    if (!err)
        err = lay_out(r, s->measured || task != HF_TASK_RENDER ? 0 : HF_FIELDS);
    if (err)
        return err;
    hf_progress_stage(&r->progress, LOOK, (uint64_t)hf_plan_count(&c->plan, 1));
    err = parallel(r, hf_plan_count(&c->plan, 1), hf_sweep_look);
    if (err)
        return err;
    const int64_t looked = hf_now_ns();
    err = make_plan(r, s, task);
    if (err)
        return err;
    report_plan(r, hf_now_ns() - looked);
    err = c->colour_stats ? look_at_colour(r) : HF_OK;
    if (err)
        return err;
    if (task != HF_TASK_RENDER)
        return task == HF_TASK_PREPARE ? take_memory(r) : HF_OK;
    begin_progress(r);
    err = finish_chunks(r);
    // A tile overwrites pixels from which its neighbours' repairs are made.
    if (!err && r->copy.in_place)
        err = hf_copy_repair(c);
    if (!err)
        err = make_tiles(r);
    if (err)
        return err;
    hf_report_frame(c, ms_since(start));
    hf_report_learn(c, s);
    return c->dump ? hf_dump_buffers(c, s) : HF_OK;
}

int hf_render_frame(struct hf_context *c, struct hf_setup *s, const struct hf_job *job)
{
    struct hf_render r = {.c = c, .s = s, .copy = hf_copy_plan(s, job->dst, job->src)};
    const struct hf_progress_call nobody = {0};
    s->stop = &c->stop;
    // A plain copy reads the region, and one pixel around it to repair samples that are not finite.
    c->reads[0] = c->reads[1] =
        (struct hf_rect){hf_max(s->region.x0 - 1, 0), hf_max(s->region.y0 - 1, 0), hf_min(s->region.x1 + 1, s->width),
                         hf_min(s->region.y1 + 1, s->height)};
    hf_progress_start(&r.progress, job->task == HF_TASK_RENDER ? &c->progress : &nobody, s->stop, !c->pool);
    start_workers(&r, job);
    const int err = s->resolved->sharp ? copy(&r, job->task) : blur(&r, s, job->task);
    if (!err && job->task == HF_TASK_RENDER)
        hf_progress_end(&r.progress);
    return err;
}
