// SPDX-License-Identifier: BSD-3-Clause
// How much of a frame is done, for the host's callback: in hundredths of the time that the cost model expects.
#ifndef HF_PROGRESS_H
#define HF_PROGRESS_H

#include <stdatomic.h>
#include <stdint.h>

#include "pass/engine.h"

// The callback that the host has set.
struct hf_progress_call {
    int (*fn)(void *cookie, float done);
    void *cookie;
};

struct hf_progress {
    struct hf_progress_call call;
    atomic_int *stop;
    int any_thread;  // worker 0 is not the caller's thread: any worker may call the host
    atomic_flag calling;
    int from, to, next;  // hundredths: bounds of the current stage, and the next to report
    atomic_uint_least64_t done;
    uint64_t all, pass[HF_MAX_PASSES];  // units of work: of the stage, and of each pass on a cell
};

void hf_progress_start(struct hf_progress *p, const struct hf_progress_call *call, atomic_int *stop, int any_thread);
// Begin a stage of `all` units of work, from the last stage's end to that many hundredths.
void hf_progress_stage(struct hf_progress *p, int to, uint64_t all);
// Count work as done. Calls the host whenever another hundredth is complete.
void hf_progress_add(struct hf_progress *p, int worker, uint64_t units);
// Report that the frame is complete.
void hf_progress_end(const struct hf_progress *p);

#endif
