// SPDX-License-Identifier: BSD-3-Clause
// How this folder spreads work over threads. It has none of its own; the caller passes a function that runs tasks.
#ifndef HF_IO_RUN_H
#define HF_IO_RUN_H

// Calls fn(arg, i, worker) for i in [0, n), each once, in any order and concurrently. worker, 0 .. workers - 1, is
// never the same in two concurrent calls, and selects scratch memory. Returns when all are done. Several threads may
// call it at once if the caller's scheduler allows that; workers then counts those of one call.
struct hf_io_run {
    void (*run)(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg);
    void *cookie;
    int workers;
};

// run NULL: call all on this thread, one after the other.
void hf_io_run(const struct hf_io_run *run, int n, void (*fn)(void *arg, int i, int worker), void *arg);
int hf_io_run_workers(const struct hf_io_run *run);

// Make threads for a program without a scheduler: `threads` of them, including the caller. Only one hf_io_run may run
// at a time. Returns 0, or -1 if threads or memory are scarce.
int hf_io_threads_open(struct hf_io_run *run, int threads);
void hf_io_threads_close(struct hf_io_run *run);

#endif
