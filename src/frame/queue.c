// SPDX-License-Identifier: BSD-3-Clause
#include "frame/queue.h"

#include <string.h>

#include "pixel/pass_c.h"

// With 3 times as many as threads a frame takes as long.
enum { SHORT_A_THREAD = 2 };

void hf_queue_open(struct hf_queue *q)
{
    hf_lock_open(&q->lock);
    hf_condition_open(&q->done);
}

void hf_queue_close(struct hf_queue *q, const struct hf_mem *mem)
{
    hf_condition_close(&q->done);
    hf_lock_close(&q->lock);
    hf_block_free(&q->memory, mem);
}

// Find the sweeps that run.
static void find_steps(struct hf_queue *q, const struct hf_plan *p, const struct hf_setup *s)
{
    const struct hf_engine_def *e = p->engine;
    q->count = q->steps = 0;
    for (int sweep = 2; sweep <= e->sweeps; sweep++) {
        if (sweep < e->sweeps && !hf_plan_sweep_runs(p, s, sweep))
            continue;
        q->step[q->steps++] = (struct hf_step){.sweep = sweep,
                                               .first = q->count,
                                               .count = hf_plan_count(p, sweep),
                                               .waits = !e->plan.waits || e->plan.waits(s, sweep),
                                               .reach = hf_plan_reach(p, s, sweep)};
        q->count += hf_plan_count(p, sweep);
    }
}

int hf_queue_lay_out(struct hf_queue *q, const struct hf_plan *p, const struct hf_setup *s, const struct hf_mem *mem)
{
    find_steps(q, p, s);
    const size_t last = (size_t)q->step[q->steps - 1].count;
    const size_t bytes = last * (sizeof *q->took + sizeof *q->order) + (size_t)q->count;
    if (q->memory.size >= bytes)
        return HF_OK;
    q->ordered = 0;
    return hf_block_grow(&q->memory, bytes, mem);
}

// Point into the memory, and begin with the cells' own order unless the frame before had as many of them.
static void place(struct hf_queue *q, int last)
{
    q->took = q->memory.data;
    q->order = (int *)(q->took + last);
    q->state = (uint8_t *)(q->order + last);
    for (int i = 0; i < last && q->ordered != last; i++) {
        q->took[i] = 0;
        q->order[i] = i;
    }
    q->ordered = last;
}

// Sort cells: the longest first.
static void sort(int *order, int count, const int64_t *took)
{
    for (int i = 1; i < count; i++) {
        const int cell = order[i];
        int at = i;
        for (; at > 0 && took[order[at - 1]] < took[cell]; at--)
            order[at] = order[at - 1];
        order[at] = cell;
    }
}

// The shortest cells come last, so that threads end together. The others keep their order, in which cells find what they read in
// the cache, because their neighbours have just read it.
static void put_short_last(struct hf_queue *q, int count, int threads)
{
    const int tail = hf_min(SHORT_A_THREAD * threads, count);
    sort(q->order, count, q->took);
    for (int i = count - tail; i < count; i++)
        q->took[q->order[i]] = -q->took[q->order[i]] - 1;  // marks it
    for (int i = 0, at = 0; i < count; i++)
        if (q->took[i] >= 0)
            q->order[at++] = i;
    for (int i = count - tail; i < count; i++)
        q->took[q->order[i]] = -q->took[q->order[i]] - 1;
}

void hf_queue_fill(struct hf_queue *q, int threads)
{
    const int last = q->step[q->steps - 1].count;
    place(q, last);
    memset(q->state, HF_CELL_WAITS, (size_t)q->count);
    for (int i = 0; i < q->steps; i++)
        q->step[i].left = q->step[i].count;
    put_short_last(q, last, threads);
}

// Whether all is done that every cell of a step needs.
static int may_begin(const struct hf_queue *q, int step)
{
    for (int i = 0; i < step - 1; i++)
        if (q->step[i].left)
            return 0;
    return !step || !q->step[step].waits || !q->step[step - 1].left;
}

int hf_queue_may_take(const struct hf_queue *q, const struct hf_plan *p, int step, int cell)
{
    const struct hf_step *of = &q->step[step], *before = &q->step[hf_max(step - 1, 0)];
    if (q->state[of->first + cell] != HF_CELL_WAITS || !may_begin(q, step))
        return 0;
    if (!step || !before->left)
        return 1;
    const struct hf_rect r = hf_plan_cell(p, of->sweep, cell);
    const struct hf_rect read = {r.x0 - of->reach.x, r.y0 - of->reach.y, r.x1 + of->reach.x, r.y1 + of->reach.y};
    for (int i = 0; i < before->count; i++)
        if (q->state[before->first + i] != HF_CELL_DONE && hf_rect_meets(hf_plan_cell(p, before->sweep, i), read))
            return 0;
    return 1;
}

int hf_queue_first(const struct hf_queue *q, const struct hf_plan *p, int *step)
{
    for (*step = 0; *step < q->steps && may_begin(q, *step); ++*step)
        for (int i = 0; q->step[*step].left && i < q->step[*step].count; i++) {
            const int cell = *step == q->steps - 1 ? q->order[i] : i;
            if (hf_queue_may_take(q, p, *step, cell))
                return cell;
        }
    return -1;
}

int hf_queue_take(struct hf_queue *q, const struct hf_plan *p, hf_queue_find *find, int *sweep)
{
    int step, cell;
    hf_lock_take(&q->lock);
    // If none may begin, others run on other threads: the first of those that wait needs only cells that were taken.
    while ((cell = find(q, p, &step)) < 0)
        hf_condition_wait(&q->done, &q->lock);
    q->state[q->step[step].first + cell] = HF_CELL_TAKEN;
    hf_lock_release(&q->lock);
    *sweep = q->step[step].sweep;
    return cell;
}

void hf_queue_finish(struct hf_queue *q, int sweep, int cell, int64_t ns)
{
    int step = 0;
    while (q->step[step].sweep != sweep)
        step++;
    hf_lock_take(&q->lock);
    q->state[q->step[step].first + cell] = HF_CELL_DONE;
    q->step[step].left--;
    if (step == q->steps - 1)
        q->took[cell] = ns;
    hf_condition_wake_all(&q->done);
    hf_lock_release(&q->lock);
}
