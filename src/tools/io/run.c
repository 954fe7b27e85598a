// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/run.h"

#include "base/pool.h"
#include "hyperfocal/hyperfocal.h"

void hf_io_run(const struct hf_io_run *run, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    if (run && run->workers > 1 && n > 1) {
        run->run(run->cookie, n, fn, arg);
        return;
    }
    for (int i = 0; i < n; i++)
        fn(arg, i, 0);
}

int hf_io_run_workers(const struct hf_io_run *run)
{
    return run && run->workers > 1 ? run->workers : 1;
}

static void on_pool(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    hf_pool_run(cookie, n, fn, arg);
}

int hf_io_threads_open(struct hf_io_run *run, int threads)
{
    struct hf_pool *pool = NULL;
    *run = (struct hf_io_run){0};
    if (threads > 1 && hf_pool_open(&pool, threads, &hf_mem_default))
        return -1;
    if (pool)
        *run = (struct hf_io_run){on_pool, pool, threads};
    return 0;
}

void hf_io_threads_close(struct hf_io_run *run)
{
    struct hf_pool *pool = run->cookie;
    hf_pool_close(&pool);
    *run = (struct hf_io_run){0};
}
