// SPDX-License-Identifier: BSD-3-Clause
// The first sweep and the tiles in one run: a tile follows the chunks that it reads, while they and the picture there
// are in the cache, and no thread waits for the last chunk of the frame.
#ifndef HF_WAVE_H
#define HF_WAVE_H

#include <stdatomic.h>

#include "frame/plan.h"

struct hf_wave {
    int *task;  // in the order in which they are begun: chunk i, or ~i for tile i
    int tasks;
    int *needs;        // rows of chunks that a row of tiles waits for
    atomic_int *done;  // chunks finished in a row
    atomic_int stopped;
};

size_t hf_wave_bytes(const struct hf_plan *p);
// The order of a frame, in memory.
void hf_wave_order(struct hf_wave *w, const struct hf_plan *p, const struct hf_setup *s, void *memory);

void hf_wave_finish_chunk(struct hf_wave *w, const struct hf_plan *p, int chunk);
// Waits until the chunks around a tile are finished. Returns 0 if the run was stopped.
int hf_wave_await(const struct hf_wave *w, const struct hf_plan *p, int tile);
// What has not begun is not worth doing.
void hf_wave_stop(struct hf_wave *w);
int hf_wave_stopped(const struct hf_wave *w);

#endif
