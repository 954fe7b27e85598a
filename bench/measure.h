// SPDX-License-Identifier: BSD-3-Clause
// Timing of whole frames, and of two yardsticks on the same machine in the same minute.
#ifndef HF_BENCH_MEASURE_H
#define HF_BENCH_MEASURE_H

#include "tools/common/error.h"
#include "hyperfocal/layers.h"
#include "pack.h"
#include "workers.h"
#include "tools/common/report.h"

enum { BENCH_SURFACES = 3 };  // of a pixel that may be known

// What is rendered, and its memory; all of it belongs to the caller.
struct bench_subject {
    struct hf_context *context;
    struct hf_params params;
    struct bench_image in, out;  // same size
    struct hf_depth depth;       // rows packed tightly
    int surfaces;                // known ones; more than 1: with the peels
    struct hf_image peel_images[BENCH_SURFACES - 1];
    struct hf_depth peel_depths[BENCH_SURFACES - 1];
    float *scratch;                 // a second plane of depth's size
    struct bench_workers *workers;  // as many threads as the context has
};

// Milliseconds of one row of the table, over all measured frames.
struct bench_row {
    double median_ms;  // in the frame whose All is the median, so that the rows of that frame add up
    double min_ms, max_ms;
    int in;  // the pass that includes this one, whose own time is then 0; -1: none
};

// Other ways to call the library: a renderer works in place, and its first frames count too. These are measured
// alternately with frames out of place, so that the two can be compared. All are zero if input and output formats
// differ, which rules out in place.
struct bench_uses {
    struct bench_row in_place, out_of_place;
    double first_ms;     // in place, in a new context: median
    double prepared_ms;  // the same after hf_prepare
    double later_ms;     // a later frame of that context
};

struct bench_result {
    struct bench_uses uses;
    int frames;
    struct bench_row pass[TOOL_PASSES];  // of stats.engine
    double overhead_ms;        // all.median_ms - sum of pass[].median_ms: waiting, dispatch, work outside the passes
    double planning_ms;        // part of the overhead: hf_report.plan_ms, median
    struct bench_row all;      // wall time of hf_render, measured by the caller
    double memcpy_ms;          // copying colour in to colour out and depth to scratch, same threads: median
    double fma_gflops;         // multiply-adds in registers, same threads, widest instruction set of the machine: best
    struct tool_report stats;  // of the last frame
};

// Whether other programs keep the machine busy: then the median frame takes far longer than the fastest.
int bench_is_busy(const struct bench_row *all);

// The median time, in milliseconds, of copying colour in to colour out and depth to scratch, with the same threads.
double bench_measure_copy(const struct bench_subject *subject);

// Median, least and most time of frames after a warm-up: as many as take about that many seconds, at least `least`. The
// passes' rows stay zero. *stats receives the report of the last frame. Returns 0, or -1 with *error filled.
int bench_measure_all(const struct bench_subject *subject, double seconds, int least, struct bench_row *all,
                      struct tool_report *stats, struct tool_error *error);

// One frame of a context, from a picture to subject->out, in milliseconds. Returns 0, or -1 with *error filled.
int bench_measure_frame(const struct bench_subject *subject, struct hf_context *context, const struct bench_image *from,
                        double *ms, struct tool_error *error);

// Returns 0, or -1 with *error filled.
int bench_measure_uses(const struct bench_subject *subject, struct bench_uses *uses, struct tool_error *error);

// All of the result but its uses. frames 0: as many as take about three seconds. Returns 0, or -1 with *error filled.
int bench_measure(const struct bench_subject *subject, int frames, struct bench_result *result,
                  struct tool_error *error);

#endif
