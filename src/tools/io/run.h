// SPDX-License-Identifier: BSD-3-Clause
// How this folder spreads work over threads: it has none of its own, the caller hands in a way to run tasks.
#ifndef HF_IO_RUN_H
#define HF_IO_RUN_H

// Calls fn(arg, i, worker) for i in [0, n), each once, in any order and at the same time; worker, 0 .. workers - 1, is
// never at two of them at once and picks scratch memory. Returns when all are done. It may be called from several
// threads at once if the caller's scheduler allows that (then workers counts those of this call).
struct hf_io_run {
    void (*run)(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg);
    void *cookie;
    int workers;
};

// run NULL: all on this thread, one after the other.
void hf_io_run(const struct hf_io_run *run, int n, void (*fn)(void *arg, int i, int worker), void *arg);
int hf_io_run_workers(const struct hf_io_run *run);

// Threads of its own for a program that has no scheduler: `threads` of them, the caller included. One hf_io_run at a
// time. Returns 0, or -1 when threads or memory are scarce.
int hf_io_threads_open(struct hf_io_run *run, int threads);
void hf_io_threads_close(struct hf_io_run *run);

#endif
