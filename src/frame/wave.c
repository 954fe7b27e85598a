// SPDX-License-Identifier: BSD-3-Clause
// Tasks are handed out in order, so what a tile waits for has begun before it: waiting ends.
#include "frame/wave.h"

#include "base/pool.h"

size_t hf_wave_bytes(const struct hf_plan *p)
{
    return sizeof(int) * (size_t)(hf_plan_count(p, 1) + hf_plan_count(p, 2) + p->rows[2]) +
           sizeof(atomic_int) * (size_t)p->rows[1];
}

void hf_wave_order(struct hf_wave *w, const struct hf_plan *p, const struct hf_setup *s, void *memory)
{
    w->done = memory;
    w->needs = (int *)(w->done + p->rows[1]);
    w->task = w->needs + p->rows[2];
    w->tasks = 0;
    atomic_init(&w->stopped, 0);
    for (int y = 0; y < p->rows[1]; y++)
        atomic_init(&w->done[y], 0);
    for (int y = 0, chunk = 0; y < p->rows[2]; y++) {
        w->needs[y] = hf_plan_chunk_rows(p, s, y);
        for (; chunk < w->needs[y] * p->columns[1]; chunk++)
            w->task[w->tasks++] = chunk;
        for (int x = 0; x < p->columns[2]; x++)
            w->task[w->tasks++] = ~(y * p->columns[2] + x);
    }
}

void hf_wave_finish_chunk(struct hf_wave *w, const struct hf_plan *p, int chunk)
{
    atomic_fetch_add_explicit(&w->done[chunk / p->columns[1]], 1, memory_order_release);
}

void hf_wave_stop(struct hf_wave *w)
{
    atomic_store_explicit(&w->stopped, 1, memory_order_relaxed);
}

int hf_wave_stopped(const struct hf_wave *w)
{
    return atomic_load_explicit(&w->stopped, memory_order_relaxed);
}

int hf_wave_await(const struct hf_wave *w, const struct hf_plan *p, int tile)
{
    int waits = 0;
    for (int y = 0; y < w->needs[tile / p->columns[2]]; y++)
        while (atomic_load_explicit(&w->done[y], memory_order_acquire) < p->columns[1]) {
            if (hf_wave_stopped(w))
                return 0;
            hf_pool_relax(waits++);
        }
    return !hf_wave_stopped(w);
}
