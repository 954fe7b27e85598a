// SPDX-License-Identifier: BSD-3-Clause
// What passes cost, learned from frames: nanoseconds per unit of work, for each set of options that was rendered.
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

// Work of a pass: half-resolution pixels of the cells on which it runs, counted once for each field that it makes there.
struct hf_work {
    uint32_t run[HF_MAX_PASSES], all[HF_MAX_PASSES];  // cells
    double units[HF_MAX_PASSES];
    double ns[HF_MAX_PASSES];  // what these take by the engine's table
};

// Of the plan as it stands after classification; radius: the largest near and far ones, pixels.
void hf_cost_work(struct hf_work *w, const struct hf_plan *p, const struct hf_setup *s, const float radius[2]);

// Milliseconds of each pass, over the number of threads.
void hf_cost_predict(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                     double ms[HF_MAX_PASSES]);
// Learn from a frame: milliseconds likewise.
void hf_cost_learn(struct hf_cost *c, const struct hf_setup *s, enum hf_isa isa, int threads, const struct hf_work *w,
                   const double ms[HF_MAX_PASSES]);

#endif
