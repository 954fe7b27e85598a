// SPDX-License-Identifier: BSD-3-Clause
// The cells of all sweeps but the first, in one queue. A cell begins when the cells that it reads are done, so no thread waits
// for the last cell of a sweep; and cells of the last sweep that were the shortest in the frame before come last.
#ifndef HF_QUEUE_H
#define HF_QUEUE_H

#include "base/mem.h"
#include "base/thread.h"
#include "frame/plan.h"

enum hf_cell_state { HF_CELL_WAITS, HF_CELL_TAKEN, HF_CELL_DONE };

// Cells are numbered over all sweeps.
struct hf_queue {
    struct hf_lock lock;  // of all that follows, while cells are taken
    struct hf_condition done;
    struct hf_block memory;
    int count;
    int steps;  // the sweeps that run, in their order; each has:
    struct hf_step {
        int sweep;
        int first, count;       // its cells
        int left;               // how many of them are not done
        int waits;              // it begins when all cells of the step before are done
        struct hf_reach reach;  // how far around a cell it reads
    } step[HF_MAX_SWEEPS];
    uint8_t *state;  // of each cell: enum hf_cell_state
    int *order;      // in which cells of the last step are taken
    int64_t *took;   // nanoseconds that each of them took in the frame before
    int ordered;     // how many these two have
};

void hf_queue_open(struct hf_queue *q);
void hf_queue_close(struct hf_queue *q, const struct hf_mem *mem);

// Have memory for the cells of a plan. HF_ERR_MEMORY.
int hf_queue_lay_out(struct hf_queue *q, const struct hf_plan *p, const struct hf_setup *s, const struct hf_mem *mem);
// Put all of them into the queue.
void hf_queue_fill(struct hf_queue *q, int threads);
// Whether a cell of a step is neither taken nor done, and what it reads is done.
int hf_queue_may_take(const struct hf_queue *q, const struct hf_plan *p, int step, int cell);
// Finds a cell that may be taken: returns its number in *step, or -1 if there is none. hf_queue_first finds the first.
typedef int hf_queue_find(const struct hf_queue *q, const struct hf_plan *p, int *step);
hf_queue_find hf_queue_first;
// Take a cell, and wait until one is found. Call it at most as often as there are cells. *sweep: the cell's; returns its number
// in that sweep.
int hf_queue_take(struct hf_queue *q, const struct hf_plan *p, hf_queue_find *find, int *sweep);
// Tell that a cell is done, and how long it took.
void hf_queue_finish(struct hf_queue *q, int sweep, int cell, int64_t ns);

#endif
