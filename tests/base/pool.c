// SPDX-License-Identifier: BSD-3-Clause
// The pool alone: each index once, in order, and on one worker number at a time; no tasks, one, many; more threads than
// cores; a failing task; threads that cannot be made. Linked with --wrap=hf_thread_start, so that any of them can fail.
#include "base/pool.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/system.h"
#include "base/thread.h"
#include "hyperfocal/hyperfocal.h"
#include "support/check.h"

enum { MAX_TASKS = 5000, MAX_THREADS = 64 };

// ---- the pool's memory and threads: counted, and refused on demand ----

static int live_blocks, refuse_memory;

static void *take(void *cookie, size_t size, size_t align)
{
    (void)cookie;
    void *p = refuse_memory ? NULL : hf_system_alloc(size, align);
    if (!p)
        return NULL;
    memset(p, 0xff, size);  // nothing may rely on zeros
    live_blocks++;
    return p;
}

static void give(void *cookie, void *p)
{
    (void)cookie;
    live_blocks--;
    hf_system_free(p);
}

static const struct hf_mem memory = {take, give, NULL};

static int create_calls, create_fails_at = -1;  // this call fails, counted from 0
static atomic_int running;                      // threads made that have not returned

struct start {
    void (*run)(void *arg);
    void *arg;
};

static void counted_start(void *arg)
{
    const struct start s = *(struct start *)arg;
    free(arg);
    s.run(s.arg);
    atomic_fetch_sub(&running, 1);
}

int __real_hf_thread_start(struct hf_thread *thread, void (*run)(void *arg), void *arg);
int __wrap_hf_thread_start(struct hf_thread *thread, void (*run)(void *arg), void *arg);

int __wrap_hf_thread_start(struct hf_thread *thread, void (*run)(void *arg), void *arg)
{
    if (create_calls++ == create_fails_at)
        return -1;
    struct start *s = malloc(sizeof *s);
    *s = (struct start){run, arg};
    atomic_fetch_add(&running, 1);
    return __real_hf_thread_start(thread, counted_start, s);
}

// ---- runs ----

struct run {
    int threads, n;
    int fails;  // this task stops early and reports it, as a task without memory does
    atomic_int error;
    atomic_int done[MAX_TASKS];       // times that an index was called
    atomic_int inside[MAX_THREADS];   // calls that a worker is in
    atomic_int last[MAX_THREADS];     // the index that a worker had before
    atomic_int bad_worker, disorder;  // worker numbers out of range or used twice at once; indices that decreased
    atomic_int started;
    unsigned plain[MAX_TASKS];  // written without atomics: after the run all of it must be visible
};

static void task(void *arg, int i, int worker)
{
    struct run *r = arg;
    if (worker < 0 || worker >= r->threads || i < 0 || i >= r->n) {
        atomic_fetch_add(&r->bad_worker, 1);
        return;
    }
    if (atomic_fetch_add(&r->inside[worker], 1))
        atomic_fetch_add(&r->bad_worker, 1);
    if (atomic_exchange(&r->last[worker], i) >= i)
        atomic_fetch_add(&r->disorder, 1);
    atomic_fetch_add(&r->done[i], 1);
    if (i == r->fails)
        atomic_store(&r->error, HF_ERR_MEMORY);
    else
        r->plain[i] = 0x5eed0000u + (unsigned)i;
    atomic_fetch_sub(&r->inside[worker], 1);
}

static void check_run(struct hf_pool *p, int threads, int n, int fails)
{
    static struct run r;
    memset((void *)&r, 0, sizeof r);
    r.threads = threads;
    r.n = n;
    r.fails = fails;
    for (int i = 0; i < MAX_THREADS; i++)
        atomic_store(&r.last[i], -1);
    hf_pool_run(p, n, task, &r);
    int wrong = 0, unseen = 0;
    for (int i = 0; i < MAX_TASKS; i++) {
        wrong += atomic_load(&r.done[i]) != (i < n);
        unseen += i < n && i != fails && r.plain[i] != 0x5eed0000u + (unsigned)i;
    }
    CHECK_MSG(wrong == 0, "%d threads, %d tasks: %d indices not called once", threads, n, wrong);
    CHECK_MSG(unseen == 0, "%d threads, %d tasks: %d writes not seen after the run", threads, n, unseen);
    CHECK_INT(atomic_load(&r.bad_worker), 0);
    CHECK_INT(atomic_load(&r.disorder), 0);
    CHECK_INT(atomic_load(&r.error), fails >= 0 && fails < n ? HF_ERR_MEMORY : HF_OK);
}

static void runs(int threads)
{
    static const int counts[] = {0, 1, 2, 3, 7, 64, 65, 1000, 0, 5000, 1};
    struct hf_pool *p = NULL;
    if (!CHECK_INT(hf_pool_open(&p, threads, &memory), HF_OK))
        return;
    CHECK_INT(atomic_load(&running), threads - 1);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_run(p, threads, counts[i], -1);
    // A failing task prevents neither the others nor the next run.
    check_run(p, threads, 100, 0);
    check_run(p, threads, 100, 99);
    check_run(p, threads, 100, -1);
    for (int i = 0; i < 100; i++)  // in quick succession, so that workers are caught between two runs
        check_run(p, threads, i % 5, -1);
    const int64_t later = hf_now_ns() + 3000000;
    while (hf_now_ns() < later)  // longer than idle workers spin: they sleep now and have to be woken
        hf_thread_yield();
    check_run(p, threads, 1000, -1);
    hf_pool_close(&p);
    CHECK(p == NULL);
    CHECK_INT(atomic_load(&running), 0);
    CHECK_INT(live_blocks, 0);
}

// Tasks that wait for each other end only if all promised workers run at the same time.
static void meet(void *arg, int i, int worker)
{
    struct run *r = arg;
    (void)i;
    (void)worker;
    atomic_fetch_add(&r->started, 1);
    for (int k = 0; atomic_load(&r->started) < r->threads; k++)
        hf_pool_relax(k);
}

static void all_at_once(int threads)
{
    static struct run r;
    struct hf_pool *p = NULL;
    if (!CHECK_INT(hf_pool_open(&p, threads, &memory), HF_OK))
        return;
    for (int i = 0; i < 20; i++) {
        r.threads = threads;
        atomic_store(&r.started, 0);
        hf_pool_run(p, threads, meet, &r);
        CHECK_INT(atomic_load(&r.started), threads);
    }
    hf_pool_close(&p);
}

// Closed before any run, while its threads are still starting.
static void closed_at_once(void)
{
    for (int i = 0; i < 100; i++) {
        struct hf_pool *p = NULL;
        CHECK_INT(hf_pool_open(&p, 1 + i % 8, &memory), HF_OK);
        hf_pool_close(&p);
        hf_pool_close(&p);  // of NULL: nothing
    }
    CHECK_INT(atomic_load(&running), 0);
    CHECK_INT(live_blocks, 0);
}

// Thread k fails after threads 0 .. k - 1 were made: they are ended, nothing leaks, and the next pool works.
static void threads_refused(void)
{
    enum { THREADS = 9 };
    for (int k = 0; k < THREADS - 1; k++) {
        struct hf_pool *p = (struct hf_pool *)&p;
        create_calls = 0;
        create_fails_at = k;
        CHECK_INT(hf_pool_open(&p, THREADS, &memory), HF_ERR_THREAD);
        CHECK(p == NULL);
        CHECK_INT(create_calls, k + 1);
        CHECK_INT(atomic_load(&running), 0);
        CHECK_INT(live_blocks, 0);
        create_fails_at = -1;
    }
    runs(THREADS);
}

// The same through the API: hf_open reports it and leaves nothing behind.
static void context_refused(void)
{
    for (int k = 0; k < 4; k++) {
        const struct hf_config config = {.size = sizeof config, .threads = 5, .alloc = take, .free = give};
        struct hf_context *c = (struct hf_context *)&c;
        create_calls = 0;
        create_fails_at = k;
        CHECK_INT(hf_open(&c, &config), HF_ERR_THREAD);
        CHECK(c == NULL);
        CHECK_INT(atomic_load(&running), 0);
        CHECK_INT(live_blocks, 0);
    }
    create_fails_at = -1;
}

static void memory_refused(void)
{
    struct hf_pool *p = (struct hf_pool *)&p;
    create_calls = 0;
    refuse_memory = 1;
    CHECK_INT(hf_pool_open(&p, 4, &memory), HF_ERR_MEMORY);
    CHECK(p == NULL);
    CHECK_INT(create_calls, 0);
    refuse_memory = 0;
}

int main(void)
{
    const int cores = hf_system_processors();
    for (int threads = 1; threads <= 8; threads++)
        runs(threads);
    runs(4 * cores < MAX_THREADS ? 4 * cores + 1 : MAX_THREADS);
    for (int threads = 1; threads <= 17; threads += 4)
        all_at_once(threads);
    closed_at_once();
    threads_refused();
    context_refused();
    memory_refused();
    return check_report();
}
