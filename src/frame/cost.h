// SPDX-License-Identifier: BSD-3-Clause
// The cost of passes, learned from frames: nanoseconds per unit of work, for each set of options that was rendered.
#ifndef HF_COST_H
#define HF_COST_H

#include "frame/plan.h"

struct hf_cost_entry {
    uint64_t key;             // of the options; 0: free
    uint32_t frames, used;    // measured; when last asked for
    float ns[HF_MAX_PASSES];  // per unit of work, summed over threads
};

struct hf_cost {
    struct hf_cost_entry entry[12];
    uint32_t clock;
};

// The work of a pass: half-resolution pixels of the cells on which it runs, counted once for each field that it makes
// there.
struct hf_work {
    uint32_t run[HF_MAX_PASSES], all[HF_MAX_PASSES];  // cells
    double units[HF_MAX_PASSES];
    double ns[HF_MAX_PASSES];  // the time for them by the engine's table
};

// Count the work of the plan after classification; radius: the largest near and far ones, pixels.
void hf_cost_work(struct hf_work *w, const struct hf_plan *p, const struct hf_setup *s, const float radius[2]);

// Predict the milliseconds of each pass, divided by the number of threads.
void hf_cost_predict(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                     double ms[HF_MAX_PASSES]);
// Learn from a frame's times, also in milliseconds.
void hf_cost_learn(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                   const double ms[HF_MAX_PASSES]);

#endif
