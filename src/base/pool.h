// SPDX-License-Identifier: BSD-3-Clause
// Worker threads. One atomic counter is the queue; hf_pool_run is a barrier.
#ifndef HF_POOL_H
#define HF_POOL_H

#include "base/mem.h"

struct hf_pool;

// threads counts the caller: threads - 1 are started. Returns HF_OK or HF_ERR_MEMORY, HF_ERR_THREAD.
int hf_pool_open(struct hf_pool **out, int threads, const struct hf_mem *mem);
// The bytes that it takes from the allocator.
size_t hf_pool_bytes(int threads);
void hf_pool_close(struct hf_pool **pool);
// Close in a child process after fork(), where the threads do not exist: only free the memory.
void hf_pool_abandon(struct hf_pool **pool);

// Calls fn(arg, i, worker) once for each i in [0, n), in this order, on all workers including the caller (worker 0).
// Returns when all calls have. worker, below threads, is an index for scratch memory.
void hf_pool_run(struct hf_pool *pool, int n, void (*fn)(void *arg, int i, int worker), void *arg);

// Call between two looks at a value that another worker will write; n counts the looks. Yields the processor now and
// then, as there may be fewer processors than workers.
void hf_pool_relax(int n);

#endif
