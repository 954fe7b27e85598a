// SPDX-License-Identifier: BSD-3-Clause
// One frame. The first sweep looks at the depth and makes the first buffers, chunk by chunk; with what it has found the
// plan is made; the other sweeps take each cell through its passes while its buffers are in the cache. What the passes
// are is the engine's business.
#include <float.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "frame/buffers.h"
#include "frame/copy.h"
#include "frame/dump.h"
#include "frame/report.h"
#include "pixel/pass_c.h"

struct job {
    struct hf_context *c;
    struct hf_setup *s;
    struct hf_copy copy;
    unsigned have;  // fields whose buffers are allocated
    int sweep;
    int plan_only;  // look at the depth, make nothing
    int known;      // the last frame had the same chunks: what it read is a guess at what this one does
};

static int64_t now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

// fn(arg, i, worker) for i in [0, n), on the pool or on the host's threads.
static void parallel(struct hf_context *c, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    if (n == 1)
        fn(arg, 0, 0);
    else if (c->pool)
        hf_pool_run(c->pool, n, fn, arg);
    else
        c->config.parallel_for(c->config.parallel_cookie, n, fn, arg);
}

static struct hf_rect grown_in_frame(const struct hf_plan *p, struct hf_rect r, struct hf_reach by)
{
    return (struct hf_rect){hf_max(r.x0 - by.x, 0), hf_max(r.y0 - by.y, 0), hf_min(r.x1 + by.x, p->width),
                            hf_min(r.y1 + by.y, p->height)};
}

// One pass on a cell, and what it costs.
static void run_pass(const struct job *j, struct hf_worker *w, int pass, struct hf_rect cell, int64_t *clock)
{
    const struct hf_plan *p = &j->c->plan;
    const struct hf_pass *def = &p->engine->passes[pass];
    const struct hf_rect r = grown_in_frame(p, cell, p->pass[pass]);
    ((const struct hf_passes *)w->frame.kernels)->pass[pass](&w->frame, r);
    for (int b = 0; b < p->engine->buf_count; b++)
        if (def->writes >> b & 1)
            hf_buffers_extend(j->c, j->s, &w->frame, b, r, cell);
    w->tiles[pass]++;
    const int64_t now = now_ns();
    w->ns[pass] += now - *clock;
    *clock = now;
}

static void set_fields(struct hf_frame *f, unsigned fields)
{
    f->near = (fields & HF_NEAR) != 0;
    f->far = (fields & HF_FAR) != 0;
}

// The buffers that the first sweep makes of a chunk.
static void make_chunk(const struct job *j, struct hf_worker *w, struct hf_rect r, unsigned fields, int64_t *clock)
{
    const struct hf_engine_def *e = j->c->plan.engine;
    set_fields(&w->frame, fields);
    for (int i = 1; i < e->pass_count && e->passes[i].sweep == 1; i++)
        run_pass(j, w, i, r, clock);
}

static void first_sweep(void *arg, int i, int worker)
{
    struct job *j = arg;
    struct hf_plan *p = &j->c->plan;
    struct hf_worker *w = &j->c->workers[worker];
    const struct hf_rect r = hf_plan_cell(p, 1, i);
    int64_t clock = now_ns();
    hf_buffers_place(j->c, j->s, &w->frame, 1, r);
    w->counts.near = w->counts.far = (struct hf_found){0};
    set_fields(&w->frame, HF_FIELDS);
    w->frame.looking = !j->s->no_skip && !j->c->dump && !p->chunk_reads[i];
    run_pass(j, w, 0, r, &clock);
    w->frame.looking = 0;
    p->near[i] = w->counts.near;
    p->far[i] = w->counts.far;
    const unsigned found = (p->near[i].groups ? HF_NEAR : 0u) | (p->far[i].groups ? HF_FAR : 0u);
    // What the last frame read there will be read again, most likely; what is not is made later.
    const unsigned fields = (j->s->no_skip ? HF_FIELDS : found ? found | p->chunk_reads[i] : 0) & j->have;
    p->chunk_made[i] = (uint8_t)fields;
    if (fields)
        make_chunk(j, w, r, fields, &clock);
    else if (j->copy.in_place && !j->plan_only)
        hf_copy_scan(w, r);
}

// What is read of a chunk and was not made.
static void make_missing(const struct job *j, struct hf_worker *w, int chunk, unsigned fields)
{
    struct hf_plan *p = &j->c->plan;
    const struct hf_rect r = hf_plan_cell(p, 1, chunk);
    int64_t clock = now_ns();
    hf_buffers_place(j->c, j->s, &w->frame, 1, r);
    if (p->engine->passes[0].writes) {  // they have to be made again
        struct hf_counts twice = {0};
        w->frame.counts = &twice;
        ((const struct hf_passes *)w->frame.kernels)->pass[0](&w->frame, r);
        w->frame.counts = &w->counts;
    }
    make_chunk(j, w, r, fields, &clock);
}

static void first_sweep_deferred(void *arg, int i, int worker)
{
    const struct job *j = arg;
    const struct hf_plan *p = &j->c->plan;
    const int chunk = p->deferred[i];
    make_missing(j, &j->c->workers[worker], chunk, p->chunk_reads[chunk] & ~p->chunk_made[chunk]);
}

// What of a tile is sharp: all of it, or what lies around its active part.
static void copy_tile(const struct job *j, struct hf_worker *w, struct hf_rect tile, const struct hf_rect *active)
{
    const int64_t start = now_ns();
    if (!active) {
        hf_copy_sharp(&j->copy, w, tile);
    } else {
        hf_copy_sharp(&j->copy, w, (struct hf_rect){tile.x0, tile.y0, tile.x1, active->y0});
        hf_copy_sharp(&j->copy, w, (struct hf_rect){tile.x0, active->y1, tile.x1, tile.y1});
        hf_copy_sharp(&j->copy, w, (struct hf_rect){tile.x0, active->y0, active->x0, active->y1});
        hf_copy_sharp(&j->copy, w, (struct hf_rect){active->x1, active->y0, tile.x1, active->y1});
    }
    w->ns[j->c->plan.engine->pass_count - 1] += now_ns() - start;
}

static void later_sweep(void *arg, int i, int worker)
{
    struct job *j = arg;
    const struct hf_plan *p = &j->c->plan;
    const int last = j->sweep == p->engine->sweeps;
    struct hf_worker *w = &j->c->workers[worker];
    struct hf_rect cell = hf_plan_cell(p, j->sweep, i);
    const int is_tile = hf_plan_is_tiled(p, j->sweep);
    const unsigned needs = j->s->blend == 0 ? 0 : is_tile ? p->tile_needs[i] : p->needs;
    if (!needs) {
        if (last)
            copy_tile(j, w, cell, NULL);
        return;
    }
    if (is_tile) {
        const struct hf_rect active = hf_plan_active(p, i);
        if (last)
            copy_tile(j, w, cell, &active);
        cell = active;
    }
    hf_buffers_place(j->c, j->s, &w->frame, j->sweep, cell);
    set_fields(&w->frame, needs);
    int64_t clock = now_ns();
    for (int pass = 0; pass < p->engine->pass_count; pass++) {
        const struct hf_pass *def = &p->engine->passes[pass];
        if (def->sweep == j->sweep && (!def->field || (def->field & needs)) && hf_plan_pass_runs(p, j->s, pass))
            run_pass(j, w, pass, cell, &clock);
    }
}

// The same among other tiles that may miss it too.
static void make_missing_shared(const struct job *j, struct hf_worker *w, int chunk, unsigned reads)
{
    struct hf_plan *p = &j->c->plan;
    if (!(reads & ~atomic_load_explicit(&p->chunk_made[chunk], memory_order_acquire)))
        return;
    for (int n = 0; atomic_exchange_explicit(&p->chunk_busy[chunk], 1, memory_order_acquire); n++)
        hf_pool_relax(n);
    const unsigned made = atomic_load_explicit(&p->chunk_made[chunk], memory_order_relaxed);
    if (reads & ~made)
        make_missing(j, w, chunk, reads & ~made);
    atomic_store_explicit(&p->chunk_made[chunk], (uint8_t)(made | reads), memory_order_release);
    atomic_store_explicit(&p->chunk_busy[chunk], 0, memory_order_release);
}

static void wave_tile(struct job *j, int tile, int worker)
{
    struct hf_plan *p = &j->c->plan;
    struct hf_worker *w = &j->c->workers[worker];
    struct hf_rect chunks = {0};
    if (!hf_wave_await(&j->c->wave, p, tile))
        return;
    const int64_t start = now_ns();
    hf_plan_classify(p, j->s, tile);
    const unsigned reads = hf_plan_reads(p, j->s, tile, &chunks);
    w->plan_ns += now_ns() - start;
    if (reads & ~j->have) {
        hf_wave_stop(&j->c->wave);
        return;
    }
    for (int y = chunks.y0; reads && y < chunks.y1; y++)
        for (int x = chunks.x0; x < chunks.x1; x++)
            make_missing_shared(j, w, y * p->columns[1] + x, reads);
    later_sweep(j, tile, worker);
}

static void wave_task(void *arg, int i, int worker)
{
    struct job *j = arg;
    struct hf_wave *w = &j->c->wave;
    const int task = w->task[i];
    if (hf_wave_stopped(w))
        return;
    if (task < 0) {
        wave_tile(j, ~task, worker);
        return;
    }
    first_sweep(j, task, worker);
    hf_wave_finish_chunk(w, &j->c->plan, task);
}

// What the colour is like where it will be read: for the report alone.
static void look_at_colour(void *arg, int i, int worker)
{
    struct job *j = arg;
    const struct hf_plan *p = &j->c->plan;
    struct hf_worker *w = &j->c->workers[worker];
    const struct hf_rect r = hf_plan_cell(p, 1, i);
    const int alpha = hf_image_channels(w->frame.src) == 4, n = r.x1 - r.x0;
    float *even[4], *odd[4];
    if (!p->chunk_reads[i])
        return;
    for (int c = 0; c < 4; c++) {
        even[c] = hf_line(&w->frame, c);
        odd[c] = hf_line(&w->frame, 4 + c);
    }
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, j->s->height); y++) {
        hf_read_colour(&w->frame, r.x0, y, n, even, odd, &w->looked);
        for (int x = 0; x < n; x++) {
            for (int c = 0; c < 3; c++)
                w->looked.brightest = fmaxf(w->looked.brightest, fmaxf(even[c][x], odd[c][x]));
            if (alpha)
                w->looked.alpha_min = fminf(w->looked.alpha_min, fminf(even[3][x], odd[3][x]));
        }
    }
}

static void scan_tile(void *arg, int i, int worker)
{
    struct job *j = arg;
    hf_copy_scan(&j->c->workers[worker], hf_plan_cell(&j->c->plan, 2, i));
}

static void add_counts(struct hf_counts *sum, const struct hf_counts *c)
{
    sum->near_pixels += c->near_pixels;
    sum->far_pixels += c->far_pixels;
    sum->sharp_pixels += c->sharp_pixels;
    sum->colour_repaired += c->colour_repaired;
    sum->depth_repaired += c->depth_repaired;
    sum->no_surface += c->no_surface;
    sum->clamped += c->clamped;
    sum->near_max = c->near_max > sum->near_max ? c->near_max : sum->near_max;
    sum->far_max = c->far_max > sum->far_max ? c->far_max : sum->far_max;
    sum->radius_min = c->radius_min < sum->radius_min ? c->radius_min : sum->radius_min;
    sum->radius_max = c->radius_max > sum->radius_max ? c->radius_max : sum->radius_max;
    sum->largest = c->largest > sum->largest ? c->largest : sum->largest;
    sum->transparent += c->transparent;
}

static struct hf_counts all_counts(const struct hf_context *c)
{
    struct hf_counts sum = {0};
    for (int i = 0; i < c->threads; i++)
        add_counts(&sum, &c->workers[i].counts);
    return sum;
}

static void collect_stats(const struct job *j, int64_t start)
{
    struct hf_context *c = j->c;
    struct hf_stats *t = &c->stats;
    const struct hf_counts n = all_counts(c);
    *t = (struct hf_stats){.engine = j->s->engine,
                           .max_radius = j->s->max_radius,
                           .near_pixels = n.near_pixels,
                           .far_pixels = n.far_pixels,
                           .sharp_pixels = n.sharp_pixels,
                           .colour_repaired = n.colour_repaired,
                           .depth_repaired = n.depth_repaired,
                           .no_surface = n.no_surface,
                           .clamped = n.clamped};
    if (j->s->blend == 0)
        t->sharp_pixels = (uint64_t)j->s->width * (uint64_t)j->s->height;
    t->memory = sizeof *c + c->planes.size + c->chunks.size + c->tiles.size + c->joined.size + c->repairs.size +
                hf_engines_bytes(c) + (c->pool ? hf_pool_bytes(c->threads) : 0);
    for (int i = 0; i < c->threads; i++) {
        const struct hf_worker *w = &c->workers[i];
        for (int p = 0; p < HF_MAX_PASSES; p++) {
            t->pass_ms[p] += (double)w->ns[p] * 1e-6 / c->threads;
            t->tiles_run[p] += w->tiles[p];
        }
        t->memory += w->scratch.size + sizeof *w;
    }
    for (int p = 0; p < c->plan.engine->pass_count; p++)
        t->tiles_all[p] = (uint32_t)hf_plan_count(&c->plan, c->plan.engine->passes[p].sweep);
    t->total_ms = (double)(now_ns() - start) * 1e-6;
}

static void start_workers(const struct job *j, const struct hf_image *dst, const struct hf_image *src,
                          const struct hf_depth *depth, int fused)
{
    struct hf_context *c = j->c;
    for (int i = 0; i < c->threads; i++) {
        struct hf_worker *w = &c->workers[i];
        memset(&w->counts, 0, sizeof w->counts);
        memset(&w->seen, 0, sizeof w->seen);
        w->looked = (struct hf_counts){.brightest = -FLT_MAX, .alpha_min = 1};
        memset(w->ns, 0, sizeof w->ns);
        memset(w->tiles, 0, sizeof w->tiles);
        w->plan_ns = 0;
        w->frame.s = j->s;
        w->frame.k = &c->kernels[fused];
        w->frame.kernels = c->engine[j->s->engine].kernels[fused];
        w->frame.src = src;
        w->frame.dst = dst;
        w->frame.depth = depth;
        w->frame.counts = &w->counts;
        w->frame.seen = &w->seen;
    }
}

// Cells, and memory for them and for the fields' buffers.
static int lay_out(struct job *j, unsigned fields)
{
    struct hf_context *c = j->c;
    hf_plan_cells(&c->plan, j->s, c->config.tile_width, c->config.tile_height, c->threads, c->dump != NULL);
    const int err = hf_block_grow(&c->tiles, hf_plan_tile_bytes(&c->plan) + hf_wave_bytes(&c->plan), &c->mem);
    if (err)
        return err;
    hf_plan_tile_memory(&c->plan, c->tiles.data);
    j->have = fields;
    return hf_buffers_allocate(c, j->s, fields);
}

static int lay_out_chunks(struct job *j)
{
    struct hf_context *c = j->c;
    const struct hf_plan last = c->plan;
    hf_plan_chunks(&c->plan, hf_engine_def(j->s->engine), j->s, c->config.tile_width, c->config.tile_height, c->threads,
                   c->dump != NULL);
    const int same = last.engine == c->plan.engine && last.width == c->plan.width && last.height == c->plan.height &&
                     last.cell_width[1] == c->plan.cell_width[1] && last.cell_height[1] == c->plan.cell_height[1];
    const int err = hf_block_grow(&c->chunks, hf_plan_chunk_bytes(&c->plan), &c->mem);
    if (err) {
        c->plan.width = 0;  // nothing to guess from
        return err;
    }
    hf_plan_chunk_memory(&c->plan, c->chunks.data, same);
    if (!same)
        c->plan.reads = 0;
    j->known = same;
    return HF_OK;
}

// The plan: what the depth shows decides which chunks, buffers and passes there are.
static int plan_frame(struct job *j)
{
    struct hf_context *c = j->c;
    struct hf_plan *p = &c->plan;
    const struct hf_counts found = all_counts(c);
    int err = HF_OK;
    if (p->engine->measured && j->s->blend != 0) {
        p->engine->measure(c->engine[j->s->engine].own, j->s, &found);
        err = lay_out(j, 0);
    }
    if (err)
        return err;
    if (j->s->blend != 0) {
        for (int i = 0; i < hf_plan_count(p, 2); i++)
            hf_plan_classify(p, j->s, i);
        hf_plan_settle(p, j->s);
    }
    hf_report_plan(c, j->s, &found);
    if (j->plan_only || j->s->blend == 0 || !(p->reads & ~j->have))
        return HF_OK;
    // Buffers that the last frame did not read: all are placed anew, and what was made is lost.
    err = lay_out(j, p->reads);
    hf_plan_forget(p);
    return err;
}

// The sweeps over the cells, and before them what the first sweep owes.
static int run_plan(struct job *j)
{
    struct hf_context *c = j->c;
    if (j->s->blend != 0 && c->plan.deferred_count)
        parallel(c, c->plan.deferred_count, first_sweep_deferred, j);
    if (j->s->blend != 0 && c->plan.engine->made) {
        const struct hf_counts found = all_counts(c);
        c->plan.engine->made(c->engine[j->s->engine].own, j->s, &found);
    }
    if (j->s->blend == 0 && j->copy.in_place)
        parallel(c, hf_plan_count(&c->plan, 2), scan_tile, j);
    const int err = j->copy.in_place ? hf_copy_repair(c) : HF_OK;
    if (err)
        return err;
    for (j->sweep = 2; j->sweep <= c->plan.engine->sweeps; j->sweep++)
        if (j->sweep == c->plan.engine->sweeps ||
            (j->s->blend != 0 && c->plan.needs && hf_plan_sweep_runs(&c->plan, j->s, j->sweep)))
            parallel(c, hf_plan_count(&c->plan, j->sweep), later_sweep, j);
    return HF_OK;
}

// Can tiles follow their chunks? Not if all has to be known of the frame first, nor if a tile overwrites what chunks
// have yet to read, nor on the host's threads, which need not begin tasks in order.
static int can_wave(const struct job *j)
{
    const struct hf_context *c = j->c;
    const struct hf_engine_def *e = c->plan.engine;
    return j->known && e->sweeps == 2 && !e->measured && !e->made && j->s->blend != 0 && !j->s->colour_stats &&
           !j->plan_only && !j->copy.in_place && !c->dump && c->pool;
}

// Chunks and tiles in one run. Returns 0 if a tile reads buffers that there are not: nothing has been made then.
static int render_wave(struct job *j, int64_t planning)
{
    struct hf_context *c = j->c;
    planning -= now_ns();
    hf_wave_order(&c->wave, &c->plan, j->s, (char *)c->tiles.data + hf_plan_tile_bytes(&c->plan));
    planning += now_ns();
    j->sweep = 2;
    parallel(c, c->wave.tasks, wave_task, j);
    if (hf_wave_stopped(&c->wave))
        return 0;
    planning -= now_ns();
    hf_plan_settle(&c->plan, j->s);
    const struct hf_counts found = all_counts(c);
    hf_report_plan(c, j->s, &found);
    planning += now_ns();
    for (int i = 0; i < c->threads; i++)
        planning += c->workers[i].plan_ns / c->threads;
    c->report.plan_ms = (double)planning * 1e-6;
    return 1;
}

// The sweeps one after the other, with the plan between them.
static int render_sweeps(struct job *j, int64_t planning)
{
    struct hf_context *c = j->c;
    if (j->s->blend != 0)
        parallel(c, hf_plan_count(&c->plan, 1), first_sweep, j);
    planning -= now_ns();
    const int err = plan_frame(j);
    planning += now_ns();
    c->report.plan_ms = (double)planning * 1e-6;
    if (!err && j->s->colour_stats && j->s->blend != 0) {
        parallel(c, hf_plan_count(&c->plan, 1), look_at_colour, j);
        hf_report_colour(c);
    }
    return err || j->plan_only ? err : run_plan(j);
}

int hf_render_frame(struct hf_context *c, struct hf_setup *s, const struct hf_image *dst, const struct hf_image *src,
                    const struct hf_depth *depth, int fused, int plan_only)
{
    const int64_t start = now_ns();
    struct job j = {.c = c, .s = s, .copy = hf_copy_plan(s, dst, src), .plan_only = plan_only};
    start_workers(&j, dst, src, depth, fused);
    int err = lay_out_chunks(&j);
    const int all = s->no_skip && !plan_only;
    if (!err)
        err = lay_out(&j, c->plan.engine->measured || s->blend == 0 ? 0 : all ? HF_FIELDS : c->plan.reads);
    if (err)
        return err;
    if (plan_only)
        j.have = 0;
    const int64_t planning = now_ns() - start;
    const int waves = can_wave(&j), done = waves && render_wave(&j, planning);
    if (waves && !done)
        start_workers(&j, dst, src, depth, fused);
    if (!done)
        err = render_sweeps(&j, planning);
    if (err || plan_only)
        return err;
    collect_stats(&j, start);
    hf_report_frame(c, s);
    return c->dump && s->blend != 0 ? hf_dump_buffers(c, s) : HF_OK;
}
