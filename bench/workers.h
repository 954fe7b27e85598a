// SPDX-License-Identifier: BSD-3-Clause
// Threads for the yardsticks, which start together. The library's own threads cannot run copies for the benchmark.
// Between runs they sleep, so they take no time from a frame.
#ifndef HF_BENCH_WORKERS_H
#define HF_BENCH_WORKERS_H

struct bench_workers;

// threads counts the caller. Returns 0, or -1 without memory or threads.
int bench_workers_open(struct bench_workers **out, int threads);

// Calls fn(arg, i, threads) once for each i in [0, threads), each on a thread of its own, 0 on the caller. Returns the
// seconds from the moment when all threads are awake and waiting to the moment when the last is done: waking and
// falling asleep do not count.
double bench_workers_run(struct bench_workers *w, void (*fn)(void *arg, int i, int threads), void *arg);

int bench_workers_threads(const struct bench_workers *w);
void bench_workers_close(struct bench_workers **w);

#endif
