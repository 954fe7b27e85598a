// SPDX-License-Identifier: BSD-3-Clause
// Measures each task of a frame by itself.
#ifndef HF_BENCH_RECORD_H
#define HF_BENCH_RECORD_H

#include "schedule.h"
#include "subject.h"

enum { BENCH_STEPS = 64 };

// The steps of a frame as it is cut for a number of threads. All tasks run on the calling thread, so each has its time
// without the others; it is the least over the frames.
struct bench_record {
    struct bench_step step[BENCH_STEPS];
    struct bench_schedule schedule;
    struct hf_report report;      // of the last frame
    int tile_width, tile_height;  // full-resolution pixels
    // of the frame that is being rendered
    int frame, at, changed;
    double last;  // when the last step ended
};

// Render that many frames after one to warm up. Returns 0, or -1 with *error filled. bench_record_free always.
int bench_record(struct bench_record *r, const struct bench_subject *subject, enum hf_isa isa, int threads, int frames,
                 struct tool_error *error);
// If both have the same tasks, keep the least times of both in r.
void bench_record_join(struct bench_record *r, const struct bench_record *other);
void bench_record_free(struct bench_record *r);

#endif
