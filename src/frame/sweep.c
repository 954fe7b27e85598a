// SPDX-License-Identifier: BSD-3-Clause
#include "frame/sweep.h"

#include <math.h>
#include <string.h>

#include "base/system.h"
#include "frame/buffers.h"
#include "pixel/pass_c.h"

static struct hf_rect grown_in_frame(const struct hf_plan *p, struct hf_rect r, struct hf_reach by)
{
    return (struct hf_rect){hf_max(r.x0 - by.x, 0), hf_max(r.y0 - by.y, 0), hf_min(r.x1 + by.x, p->width),
                            hf_min(r.y1 + by.y, p->height)};
}

static hf_kernel *kernel_of(const struct hf_frame *f, int pass)
{
    return ((const struct hf_passes *)f->kernels)->pass[pass];
}

// Run one pass on a cell, and measure it.
static void run_pass(struct hf_render *r, struct hf_worker *w, int pass, struct hf_rect cell, int64_t *clock)
{
    const struct hf_plan *p = &r->c->plan;
    if (hf_stopped(r->s->stop))
        return;
    const struct hf_rect area = grown_in_frame(p, cell, p->cells.pass[pass]);
    kernel_of(&w->frame, pass)(&w->frame, area);
    for (int b = 0; b < p->engine->buf_count; b++)
        if (p->engine->passes[pass].writes >> b & 1)
            hf_buffers_extend(r->c, r->s, &w->frame, b, area, cell);
    w->tiles[pass]++;
    const int64_t now = hf_now_ns();
    w->ns[pass] += now - *clock;
    *clock = now;
    hf_progress_add(&r->progress, (int)(w - r->c->workers), r->progress.pass[pass]);
}

static void set_fields(struct hf_frame *f, unsigned fields)
{
    f->near = (fields & HF_NEAR) != 0;
    f->far = (fields & HF_FAR) != 0;
}

// Make the first sweep's buffers of a chunk.
static void make_chunk(struct hf_render *r, struct hf_worker *w, struct hf_rect cell, unsigned fields, int64_t *clock)
{
    const struct hf_engine_def *e = r->c->plan.engine;
    set_fields(&w->frame, fields);
    for (int i = 1; i < e->pass_count && e->passes[i].sweep == 1; i++)
        run_pass(r, w, i, cell, clock);
}

void hf_sweep_look(void *arg, int i, int worker)
{
    struct hf_render *r = arg;
    struct hf_plan *p = &r->c->plan;
    struct hf_worker *w = &r->c->workers[worker];
    const struct hf_rect cell = hf_plan_cell(p, 1, i);
    // The fields that will certainly be read here, given what the chunks above have.
    const unsigned wanted = p->part ? 0 : p->no_skip ? HF_FIELDS : hf_plan_foreseen(p, r->s, i);
    int64_t clock = hf_now_ns();
    w->counts.near = w->counts.far = (struct hf_found){0};
    if (!hf_rect_meets(cell, p->looked)) {
        hf_plan_found(p, i, &w->counts);
        return;
    }
    hf_buffers_place(r->c, r->s, &w->frame, 1, cell);
    set_fields(&w->frame, HF_FIELDS);
    w->frame.looking = !wanted;
    run_pass(r, w, 0, cell, &clock);
    w->frame.looking = 0;
    const unsigned found = hf_plan_found(p, i, &w->counts), fields = p->part ? 0 : (wanted | found) & r->have;
    if (fields)
        make_chunk(r, w, cell, fields, &clock);
    p->chunk_made[i] = (uint8_t)fields;
    hf_progress_add(&r->progress, worker, 1);
}

void hf_sweep_rest(void *arg, int i, int worker)
{
    struct hf_render *r = arg;
    const struct hf_plan *p = &r->c->plan;
    struct hf_worker *w = &r->c->workers[worker];
    const int chunk = p->rest[i];
    const struct hf_rect cell = hf_plan_cell(p, 1, chunk);
    const unsigned missing = p->chunk_reads[chunk] & ~p->chunk_made[chunk];
    int64_t clock = hf_now_ns();
    if (!missing || !hf_plan_makes_chunks(p)) {
        hf_copy_scan(w, cell);
        return;
    }
    hf_buffers_place(r->c, r->s, &w->frame, 1, cell);
    if (p->engine->passes[0].writes) {  // they were in scratch that another chunk has used since
        struct hf_counts twice = {0};
        w->frame.counts = &twice;
        kernel_of(&w->frame, 0)(&w->frame, cell);
        w->frame.counts = &w->counts;
    }
    make_chunk(r, w, cell, missing, &clock);
    // If the chunk's other field was made before, the chunk has been counted.
    for (int pass = 1; p->chunk_made[chunk] && pass < p->engine->pass_count && p->engine->passes[pass].sweep == 1;
         pass++)
        w->tiles[pass]--;
}

void hf_sweep_classify(void *arg, int row, int worker)
{
    const struct hf_render *r = arg;
    struct hf_plan *p = &r->c->plan;
    (void)worker;
    for (int x = 0; x < p->columns[2] && !hf_stopped(r->s->stop); x++)
        hf_plan_classify(p, r->s, row * p->columns[2] + x);
}

// Copy the sharp part of a tile, around its active part.
static void copy_around(const struct hf_render *r, struct hf_worker *w, struct hf_rect tile, struct hf_rect active)
{
    const int64_t start = hf_now_ns();
    hf_copy_sharp(&r->copy, w, (struct hf_rect){tile.x0, tile.y0, tile.x1, active.y0});
    hf_copy_sharp(&r->copy, w, (struct hf_rect){tile.x0, active.y1, tile.x1, tile.y1});
    hf_copy_sharp(&r->copy, w, (struct hf_rect){tile.x0, active.y0, active.x0, active.y1});
    hf_copy_sharp(&r->copy, w, (struct hf_rect){active.x1, active.y0, tile.x1, active.y1});
    w->ns[r->c->plan.engine->pass_count - 1] += hf_now_ns() - start;
}

void hf_sweep_check(void *arg, int tile, int worker)
{
    const struct hf_render *r = arg;
    hf_copy_scan(&r->c->workers[worker], hf_plan_cell(&r->c->plan, 2, tile));
}

void hf_sweep_copy(void *arg, int tile, int worker)
{
    struct hf_render *r = arg;
    struct hf_worker *w = &r->c->workers[worker];
    const int64_t start = hf_now_ns();
    hf_copy_sharp(&r->copy, w, hf_plan_cell(&r->c->plan, 2, tile));
    w->ns[r->c->plan.engine->pass_count - 1] += hf_now_ns() - start;
    hf_progress_add(&r->progress, worker, 1);
}

static void run_cell(struct hf_render *r, int sweep, int i, int worker)
{
    const struct hf_plan *p = &r->c->plan;
    struct hf_worker *w = &r->c->workers[worker];
    struct hf_rect cell = hf_plan_cell(p, sweep, i);
    const int is_tile = hf_plan_is_tiled(p, sweep), last = sweep == p->engine->sweeps;
    const unsigned needs = is_tile ? p->tile_needs[i] : p->needs;
    if (!needs) {
        if (last)
            hf_sweep_copy(r, i, worker);
        return;
    }
    if (is_tile) {
        const struct hf_rect active = hf_plan_active(p, i);
        if (last)
            copy_around(r, w, cell, active);
        cell = active;
    } else {
        cell = hf_rect_both(cell, p->area[sweep]);
        if (cell.x0 >= cell.x1 || cell.y0 >= cell.y1)
            return;
    }
    hf_buffers_place(r->c, r->s, &w->frame, sweep, cell);
    set_fields(&w->frame, needs);
    int64_t clock = hf_now_ns();
    for (int pass = 0; pass < p->engine->pass_count; pass++) {
        const struct hf_pass *def = &p->engine->passes[pass];
        if (def->sweep == sweep && (!def->field || (def->field & needs)) && hf_plan_pass_runs(p, r->s, pass))
            run_pass(r, w, pass, cell, &clock);
    }
}

void hf_sweep_cell(void *arg, int cell, int worker)
{
    struct hf_render *r = arg;
    run_cell(r, r->sweep, cell, worker);
}

void hf_sweep_next(void *arg, int i, int worker)
{
    struct hf_render *r = arg;
    int sweep;
    const int cell = hf_queue_take(&r->c->queue, &r->c->plan, hf_queue_first, &sweep);
    const int64_t start = hf_now_ns();
    (void)i;
    run_cell(r, sweep, cell, worker);
    hf_queue_finish(&r->c->queue, sweep, cell, hf_now_ns() - start);
}

void hf_sweep_colour(void *arg, int i, int worker)
{
    const struct hf_render *r = arg;
    const struct hf_plan *p = &r->c->plan;
    struct hf_worker *w = &r->c->workers[worker];
    const struct hf_rect cell = hf_plan_cell(p, 1, i);
    const int alpha = hf_image_channels(w->frame.src) == 4, n = cell.x1 - cell.x0;
    float *even[4], *odd[4];
    if (!p->chunk_reads[i])
        return;
    for (int c = 0; c < 4; c++) {
        even[c] = hf_line(&w->frame, c);
        odd[c] = hf_line(&w->frame, 4 + c);
    }
    for (int y = 2 * cell.y0; y < hf_min(2 * cell.y1, r->s->height) && !hf_stopped(r->s->stop); y++) {
        hf_read_given(&w->frame, cell.x0, y, n, even, odd, &w->looked);
        for (int x = 0; x < n; x++) {
            for (int c = 0; c < 3; c++)
                w->looked.brightest = fmaxf(w->looked.brightest, fmaxf(even[c][x], odd[c][x]));
            if (alpha)
                w->looked.alpha_min = fminf(w->looked.alpha_min, fminf(even[3][x], odd[3][x]));
        }
    }
}

// A kilobyte at a time, because memset writes longer runs past the caches.
void hf_sweep_touch(void *arg, int piece, int worker)
{
    const struct hf_block *block = ((const struct hf_render *)arg)->touched;
    const size_t from = (size_t)piece * HF_TOUCH_BYTES;
    (void)worker;
    for (size_t at = from; at < from + HF_TOUCH_BYTES && at < block->size; at += 1024)
        memset((char *)block->data + at, 0, block->size - at < 1024 ? block->size - at : 1024);
}
