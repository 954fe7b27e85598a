// SPDX-License-Identifier: BSD-3-Clause
// Timing of whole frames, and of two yardsticks on the same machine in the same minute.
#ifndef HF_BENCH_MEASURE_H
#define HF_BENCH_MEASURE_H

#include "tools/common/error.h"
#include "hyperfocal/hyperfocal.h"
#include "pack.h"
#include "workers.h"

// What is rendered, from where to where. Everything is the caller's.
struct bench_subject {
    struct hf_context *context;
    struct hf_params params;
    struct bench_image in, out;     // same size
    struct hf_depth depth;          // rows packed tightly
    float *scratch;                 // a second plane of depth's size
    struct bench_workers *workers;  // as many threads as the context
};

// Milliseconds of one row over the frames measured.
struct bench_row {
    double median_ms;  // in the frame whose All is the median, so that the rows of that frame add up
    double min_ms, max_ms;
    int in;  // pass into which this one is fused, so that its own time is 0; -1: none
};

// How else the library is called: a renderer works in place, and its first frames count too. Measured in turn with frames
// out of place, so that they can be compared. Zero if the formats of input and output differ: that cannot be in place.
struct bench_uses {
    struct bench_row in_place, out_of_place;
    double first_ms;     // in place, in a new context: median
    double prepared_ms;  // the same after hf_prepare
    double later_ms;     // and a later frame of that context
};

struct bench_result {
    struct bench_uses uses;
    int frames;
    struct bench_row pass[HF_MAX_PASSES];  // of stats.engine
    double overhead_ms;      // all.median_ms - sum of pass[].median_ms: waiting, dispatch, what belongs to no pass
    double planning_ms;      // part of the overhead: hf_report.plan_ms, median
    struct bench_row all;    // wall time of hf_render, seen from outside
    double memcpy_ms;        // copying colour in to colour out and depth to scratch, same threads: median
    double fma_gflops;       // multiply-adds in registers, same threads, widest instruction set of the machine: best
    struct hf_report stats;  // of the last frame
};

// Does something else keep the machine busy? Then the middle frame takes far longer than the fastest.
int bench_is_busy(const struct bench_row *all);

// Milliseconds of copying colour in to colour out and depth to scratch, same threads: median.
double bench_measure_copy(const struct bench_subject *subject);

// Median, least and most of frames, as many as take about so many seconds, at least `least`, after one that is not
// counted. The passes stay zero. *stats receives those of the last. Returns 0, or -1 with *error filled.
int bench_measure_all(const struct bench_subject *subject, double seconds, int least, struct bench_row *all,
                      struct hf_report *stats, struct tool_error *error);

// One frame of a context, from a picture to subject->out, in milliseconds. Returns 0, or -1 with *error filled.
int bench_measure_frame(const struct bench_subject *subject, struct hf_context *context, const struct bench_image *from,
                        double *ms, struct tool_error *error);

// Returns 0, or -1 with *error filled.
int bench_measure_uses(const struct bench_subject *subject, struct bench_uses *uses, struct tool_error *error);

// frames 0: as many as take about three seconds. Returns 0, or -1 with *error filled.
int bench_measure(const struct bench_subject *subject, int frames, struct bench_result *result,
                  struct tool_error *error);

#endif
