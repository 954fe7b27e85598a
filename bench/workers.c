// SPDX-License-Identifier: BSD-3-Clause
#include "workers.h"

#include "tools/common/machine.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

struct worker {
    struct bench_workers *set;
    pthread_t thread;
    int index;
};

struct bench_workers {
    int threads, started;
    struct worker *workers;  // [0] is the caller, which has no thread here

    pthread_mutex_t mutex;
    pthread_cond_t wake;
    unsigned run;  // number of the run; a change wakes the workers. Guarded by mutex, as is quit
    int quit;

    void (*fn)(void *arg, int i, int threads);
    void *arg;
    atomic_int ready, done;  // workers that wait for go; workers that have finished
    atomic_int go;
};

// Spins, because a run is shorter than waking a thread. With more threads than processors it yields, because the thread
// that it waits for needs this processor.
static void wait_for(atomic_int *value, int wanted)
{
    for (int spins = 0; atomic_load_explicit(value, memory_order_acquire) != wanted; spins++)
        if (spins > 2000)
            sched_yield();
}

static void *worker_main(void *arg)
{
    const struct worker *me = arg;
    struct bench_workers *w = me->set;
    unsigned seen = 0;
    for (;;) {
        pthread_mutex_lock(&w->mutex);
        while (w->run == seen && !w->quit)
            pthread_cond_wait(&w->wake, &w->mutex);
        seen = w->run;
        const int quit = w->quit;
        pthread_mutex_unlock(&w->mutex);
        if (quit)
            return NULL;
        atomic_fetch_add(&w->ready, 1);
        wait_for(&w->go, 1);
        w->fn(w->arg, me->index, w->threads);
        atomic_fetch_add(&w->done, 1);  // after this the run's data are not touched
    }
}

double bench_workers_run(struct bench_workers *w, void (*fn)(void *arg, int i, int threads), void *arg)
{
    w->fn = fn;
    w->arg = arg;
    atomic_store(&w->ready, 0);
    atomic_store(&w->done, 0);
    atomic_store(&w->go, 0);
    pthread_mutex_lock(&w->mutex);
    w->run++;
    pthread_cond_broadcast(&w->wake);
    pthread_mutex_unlock(&w->mutex);
    wait_for(&w->ready, w->threads - 1);
    const double start = tool_now_ms();
    atomic_store_explicit(&w->go, 1, memory_order_release);
    fn(arg, 0, w->threads);
    wait_for(&w->done, w->threads - 1);
    return 1e-3 * (tool_now_ms() - start);
}

int bench_workers_open(struct bench_workers **out, int threads)
{
    *out = NULL;
    struct bench_workers *w = calloc(1, sizeof *w);
    if (!w)
        return -1;
    w->threads = threads;
    w->started = 1;
    pthread_mutex_init(&w->mutex, NULL);
    pthread_cond_init(&w->wake, NULL);
    w->workers = calloc((size_t)threads, sizeof *w->workers);
    for (int i = 1; w->workers && i < threads; i++) {
        w->workers[i] = (struct worker){.set = w, .index = i};
        if (pthread_create(&w->workers[i].thread, NULL, worker_main, &w->workers[i]))
            break;
        w->started++;
    }
    if (!w->workers || w->started < threads) {
        bench_workers_close(&w);
        return -1;
    }
    *out = w;
    return 0;
}

int bench_workers_threads(const struct bench_workers *w)
{
    return w->threads;
}

void bench_workers_close(struct bench_workers **workers)
{
    struct bench_workers *w = *workers;
    if (!w)
        return;
    pthread_mutex_lock(&w->mutex);
    w->quit = 1;
    pthread_cond_broadcast(&w->wake);
    pthread_mutex_unlock(&w->mutex);
    for (int i = 1; i < w->started; i++)
        pthread_join(w->workers[i].thread, NULL);
    pthread_cond_destroy(&w->wake);
    pthread_mutex_destroy(&w->mutex);
    free(w->workers);
    free(w);
    *workers = NULL;
}
