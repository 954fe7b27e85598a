// SPDX-License-Identifier: BSD-3-Clause
// A frame is two short runs. Waking a worker takes tens of microseconds, so idle workers spin for a moment before they
// sleep, and so does the caller before it waits for the last of them.
#include "base/pool.h"

#include <stdatomic.h>
#include <stdint.h>

#include "base/system.h"
#include "base/thread.h"
#include "hyperfocal/hyperfocal.h"

enum { SPIN_NS = 200000 };

struct worker {
    struct hf_pool *pool;
    struct hf_thread thread;
    int index;
};

struct hf_pool {
    const struct hf_mem *mem;
    int threads, started;

    struct hf_lock lock;
    struct hf_condition wake, done;
    atomic_uint generation;  // counts runs; a change is the signal to work
    atomic_int busy;         // started workers that have not finished this run
    int quit, sleepers;      // guarded by the lock

    atomic_int next;  // the queue: the index of the next call
    int n;
    void (*fn)(void *arg, int i, int worker);
    void *arg;

    struct worker workers[];
};

static void cpu_pause(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static void work(struct hf_pool *p, int worker)
{
    for (int i; (i = atomic_fetch_add_explicit(&p->next, 1, memory_order_relaxed)) < p->n;)
        p->fn(p->arg, i, worker);
}

// Wait until the generation is no longer `seen`; returns the new one.
static unsigned await_generation(struct hf_pool *p, unsigned seen)
{
    for (int64_t end = hf_now_ns() + SPIN_NS; hf_now_ns() < end;) {
        for (int i = 0; i < 64; i++) {
            const unsigned g = atomic_load_explicit(&p->generation, memory_order_acquire);
            if (g != seen)
                return g;
            cpu_pause();
        }
    }
    hf_lock_take(&p->lock);
    p->sleepers++;
    while (atomic_load_explicit(&p->generation, memory_order_acquire) == seen)
        hf_condition_wait(&p->wake, &p->lock);
    p->sleepers--;
    const unsigned g = atomic_load_explicit(&p->generation, memory_order_acquire);
    hf_lock_release(&p->lock);
    return g;
}

static void worker_main(void *arg)
{
    struct worker *w = arg;
    struct hf_pool *p = w->pool;
    unsigned seen = 0;
    for (;;) {
        seen = await_generation(p, seen);
        if (p->quit)  // quit is written before the generation
            return;
        work(p, w->index);
        if (atomic_fetch_sub_explicit(&p->busy, 1, memory_order_acq_rel) == 1) {
            hf_lock_take(&p->lock);
            hf_condition_wake(&p->done);
            hf_lock_release(&p->lock);
        }
    }
}

// Tell the workers to start a run, or to quit.
static void release_workers(struct hf_pool *p)
{
    hf_lock_take(&p->lock);
    atomic_fetch_add_explicit(&p->generation, 1, memory_order_release);
    const int sleepers = p->sleepers;
    hf_lock_release(&p->lock);
    if (sleepers)
        hf_condition_wake_all(&p->wake);
}

void hf_pool_run(struct hf_pool *p, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    p->fn = fn;
    p->arg = arg;
    p->n = n;
    atomic_store_explicit(&p->next, 0, memory_order_relaxed);
    atomic_store_explicit(&p->busy, p->started, memory_order_relaxed);
    if (p->started)
        release_workers(p);
    work(p, 0);
    if (!p->started)
        return;
    for (int64_t end = hf_now_ns() + SPIN_NS; hf_now_ns() < end;) {
        for (int i = 0; i < 64; i++) {
            if (!atomic_load_explicit(&p->busy, memory_order_acquire))
                return;
            cpu_pause();
        }
    }
    hf_lock_take(&p->lock);
    while (atomic_load_explicit(&p->busy, memory_order_acquire))
        hf_condition_wait(&p->done, &p->lock);
    hf_lock_release(&p->lock);
}

void hf_pool_relax(int n)
{
    if (n % 256 == 255)
        hf_thread_yield();
    else
        cpu_pause();
}

size_t hf_pool_bytes(int threads)
{
    return sizeof(struct hf_pool) + (size_t)threads * sizeof(struct worker);
}

int hf_pool_open(struct hf_pool **out, int threads, const struct hf_mem *mem)
{
    struct hf_pool *p = mem->alloc(mem->cookie, hf_pool_bytes(threads), HF_ALIGN);
    *out = NULL;
    if (!p)
        return HF_ERR_MEMORY;
    *p = (struct hf_pool){.mem = mem, .threads = threads};
    hf_lock_open(&p->lock);
    hf_condition_open(&p->wake);
    hf_condition_open(&p->done);
    for (int i = 1; i < threads; i++) {
        struct worker *w = &p->workers[i];
        *w = (struct worker){.pool = p, .index = i};
        if (hf_thread_start(&w->thread, worker_main, w)) {
            hf_pool_close(&p);
            return HF_ERR_THREAD;
        }
        p->started++;
    }
    *out = p;
    return HF_OK;
}

void hf_pool_close(struct hf_pool **pool)
{
    struct hf_pool *p = *pool;
    if (!p)
        return;
    *pool = NULL;
    p->quit = 1;
    release_workers(p);
    for (int i = 1; i <= p->started; i++)
        hf_thread_join(&p->workers[i].thread);
    hf_condition_close(&p->done);
    hf_condition_close(&p->wake);
    hf_lock_close(&p->lock);
    p->mem->free(p->mem->cookie, p);
}

void hf_pool_abandon(struct hf_pool **pool)
{
    struct hf_pool *p = *pool;
    *pool = NULL;
    if (p)
        p->mem->free(p->mem->cookie, p);
}
