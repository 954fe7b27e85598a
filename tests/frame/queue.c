// SPDX-License-Identifier: BSD-3-Clause
// The queue of cells: each is taken once, none before what it reads is done, on any number of threads; cells that were short in
// the frame before come last.
#include "frame/queue.h"

#include <stdatomic.h>
#include <string.h>

#include "base/pool.h"
#include "base/system.h"
#include "support/check.h"
#include "support/image.h"

enum { FIRST = 2, LAST = 5, CELLS = 400, SLOW_NS = 200000 };

// What an engine answers: of each sweep.
static struct hf_reach reaches[HF_MAX_SWEEPS];
static int waiting[HF_MAX_SWEEPS], idle[HF_MAX_SWEEPS];

static struct hf_reach around(const struct hf_setup *s, int sweep)
{
    (void)s;
    return reaches[sweep];
}

static int waits(const struct hf_setup *s, int sweep)
{
    (void)s;
    return waiting[sweep];
}

static int runs(const struct hf_setup *s, int pass)
{
    (void)s;
    return !idle[FIRST + pass];
}

static const struct hf_pass passes[] = {{"a", .sweep = 2}, {"b", .sweep = 3}, {"c", .sweep = 4}, {"d", .sweep = LAST}};
static const struct hf_engine_def engine = {
    .passes = passes, .pass_count = 4, .sweeps = LAST, .plan = {.around = around, .waits = waits, .runs = runs}};

struct frame {
    struct hf_plan plan;
    struct hf_queue queue;
    atomic_int taken[HF_MAX_SWEEPS][CELLS], done[HF_MAX_SWEEPS][CELLS];
    int slow;  // every eighth cell, counted from this one, takes long
};

static void random_frame(struct frame *f, struct rng *rng)
{
    f->plan = (struct hf_plan){.engine = &engine, .width = 1 + rng_below(rng, 300), .height = 1 + rng_below(rng, 200)};
    for (int sweep = FIRST; sweep <= LAST; sweep++) {
        const int width = 16 + rng_below(rng, 300), height = 16 + rng_below(rng, 200);
        f->plan.cells.width[sweep] = width;
        f->plan.cells.height[sweep] = height;
        f->plan.columns[sweep] = (f->plan.width + width - 1) / width;
        f->plan.rows[sweep] = (f->plan.height + height - 1) / height;
        reaches[sweep] =
            (struct hf_reach){rng_below(rng, 3) * rng_below(rng, 100), rng_below(rng, 3) * rng_below(rng, 100)};
        waiting[sweep] = !rng_below(rng, 4);
        idle[sweep] = sweep < LAST && !rng_below(rng, 4);
    }
    f->slow = rng_below(rng, 8);
}

static int all_done(const struct frame *f, int sweep)
{
    int done = 1;
    for (int i = 0; i < hf_plan_count(&f->plan, sweep); i++)
        done &= idle[sweep] || atomic_load(&f->done[sweep][i]);
    return done;
}

// Is every pixel that a cell reads of the sweep before it made? Pixel by pixel.
static int is_made(const struct frame *f, int sweep, struct hf_rect cell, int before)
{
    const struct hf_plan *p = &f->plan;
    int made = 1;
    for (int y = cell.y0 - reaches[sweep].y; y < cell.y1 + reaches[sweep].y; y++)
        for (int x = cell.x0 - reaches[sweep].x; x < cell.x1 + reaches[sweep].x; x++)
            if (x >= 0 && x < p->width && y >= 0 && y < p->height)
                made &= atomic_load(
                    &f->done[before][y / p->cells.height[before] * p->columns[before] + x / p->cells.width[before]]);
    return made;
}

static void check_order(const struct frame *f, int sweep, int cell)
{
    int before = sweep - 1;
    while (before >= FIRST && idle[before])
        before--;
    for (int i = FIRST; i < before; i++)
        CHECK_MSG(all_done(f, i), "sweep %d begins before %d is done", sweep, i);
    if (before >= FIRST && waiting[sweep])
        CHECK_MSG(all_done(f, before), "sweep %d does not wait for %d", sweep, before);
    if (before >= FIRST)
        CHECK_MSG(is_made(f, sweep, hf_plan_cell(&f->plan, sweep, cell), before),
                  "cell %d of sweep %d begins before what it reads is done", cell, sweep);
}

static void task(void *arg, int i, int worker)
{
    struct frame *f = arg;
    int sweep;
    (void)i;
    (void)worker;
    const int cell = hf_queue_take(&f->queue, &f->plan, hf_queue_first, &sweep);
    atomic_fetch_add(&f->taken[sweep][cell], 1);
    check_order(f, sweep, cell);
    for (const int64_t end = hf_now_ns() + SLOW_NS; (cell + f->slow) % 8 == 0 && hf_now_ns() < end;)
        hf_thread_yield();
    atomic_store(&f->done[sweep][cell], 1);
    hf_queue_finish(&f->queue, sweep, cell, cell * 7919 % 101);
}

static void random_frames(int threads, struct rng *rng)
{
    static struct frame f;
    struct hf_pool *pool;
    if (!CHECK_INT(hf_pool_open(&pool, threads, &hf_mem_default), HF_OK))
        return;
    hf_queue_open(&f.queue);
    for (int n = 0; n < 60; n++) {
        memset((void *)f.taken, 0, sizeof f.taken);
        memset((void *)f.done, 0, sizeof f.done);
        random_frame(&f, rng);
        CHECK_INT(hf_queue_lay_out(&f.queue, &f.plan, NULL, &hf_mem_default), HF_OK);
        hf_queue_fill(&f.queue, threads);
        hf_pool_run(pool, f.queue.count, task, &f);
        for (int sweep = FIRST; sweep <= LAST; sweep++)
            for (int i = 0; i < CELLS; i++)
                CHECK_INT(atomic_load(&f.taken[sweep][i]), !idle[sweep] && i < hf_plan_count(&f.plan, sweep));
    }
    hf_queue_close(&f.queue, &hf_mem_default);
    hf_pool_close(&pool);
}

// Ten cells of one sweep, twice: with two threads the four short ones come last, the longest of them first.
static void short_cells_last(void)
{
    static const int took[] = {5, 40, 9, 30, 8, 20, 50, 7, 60, 70}, order[] = {1, 3, 5, 6, 8, 9, 2, 4, 7, 0};
    struct hf_plan plan = {.engine = &engine, .width = 160, .height = 8};
    struct hf_queue queue = {0};
    for (int sweep = FIRST; sweep <= LAST; sweep++) {
        plan.cells.width[sweep] = 16;
        plan.cells.height[sweep] = 8;
        plan.columns[sweep] = 10;
        plan.rows[sweep] = 1;
        idle[sweep] = sweep < LAST;
    }
    hf_queue_open(&queue);
    CHECK_INT(hf_queue_lay_out(&queue, &plan, NULL, &hf_mem_default), HF_OK);
    for (int frame = 0; frame < 3; frame++) {
        hf_queue_fill(&queue, 2);
        for (int i = 0; i < 10; i++) {
            int sweep;
            const int cell = hf_queue_take(&queue, &plan, hf_queue_first, &sweep);
            CHECK_INT(sweep, LAST);
            CHECK_INT(cell, frame ? order[i] : i);
            hf_queue_finish(&queue, sweep, cell, took[cell]);
        }
    }
    hf_queue_close(&queue, &hf_mem_default);
}

int main(void)
{
    struct rng rng = rng_seed(11);
    for (int threads = 1; threads <= 8; threads *= 2)
        random_frames(threads, &rng);
    short_cells_last();
    return check_report();
}
