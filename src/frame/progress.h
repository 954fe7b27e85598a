// SPDX-License-Identifier: BSD-3-Clause
// How much of a frame is done, for the host's callback: in hundredths, by what the cost model says of each pass.
#ifndef HF_PROGRESS_H
#define HF_PROGRESS_H

#include <stdatomic.h>
#include <stdint.h>

#include "pass/engine.h"

// What the host has set.
struct hf_progress_call {
    int (*fn)(void *cookie, float done);
    void *cookie;
};

struct hf_progress {
    struct hf_progress_call call;
    atomic_int *stop;
    int any_thread;  // that of worker 0 is not the caller's: whichever comes first calls
    atomic_flag calling;
    int from, to, next;  // hundredths: of the stage at hand, and the next that is told
    atomic_uint_least64_t done;
    uint64_t all, pass[HF_MAX_PASSES];  // units of work: in the stage, and of a pass on a cell
};

void hf_progress_start(struct hf_progress *p, const struct hf_progress_call *call, atomic_int *stop, int any_thread);
// A stage from where the last one ended to so many hundredths: `all` units of work.
void hf_progress_stage(struct hf_progress *p, int to, uint64_t all);
// So much of it is done. Calls the host if that is a hundredth more.
void hf_progress_add(struct hf_progress *p, int worker, uint64_t units);
// The picture is whole.
void hf_progress_end(const struct hf_progress *p);

#endif
