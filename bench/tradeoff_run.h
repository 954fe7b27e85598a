// SPDX-License-Identifier: BSD-3-Clause
// Renders settings on scenes, to measure them.
#ifndef HF_BENCH_TRADEOFF_RUN_H
#define HF_BENCH_TRADEOFF_RUN_H

#include "pack.h"
#include "tradeoff.h"
#include "tradeoff_scene.h"
#include "workers.h"

enum { TRADE_CONTEXTS = 8 };

// The parsed options of a setting.
struct trade_job {
    struct bench_args args;
    struct hf_context *context;  // made for args.threads and args.isa
    int available;               // 0: this machine lacks the instruction set
};

struct trade_run {
    struct trade *t;
    struct trade_scene scene[TRADE_SCENES];
    struct bench_image in[TRADE_SCENES], out[TRADE_SCENES];
    struct bench_scene both;
    struct bench_image both_in, both_out;
    struct trade_job *job;  // one for each result
    struct {
        int threads;
        enum hf_isa isa;
        struct hf_context *context;
    } context[TRADE_CONTEXTS];
    struct bench_workers *workers;
    struct tool_error log;  // the library's last sentence
    float *pull[5];         // display-encoded frames of a focus pull
    size_t pull_samples;
};

// Read the scenes and allocate memory. Close the run even after an error.
int trade_run_open(struct trade_run *run, struct trade *t, struct tool_error *error);
void trade_run_close(struct trade_run *run);

// Parse the options of all of t->result. Settings that this machine cannot run are removed.
int trade_run_parse(struct trade_run *run, struct tool_error *error);

// Render one setting on one scene (-1: `both`). Returns 0, or -1 with *error filled.
int trade_run_render(struct trade_run *run, int result, int scene, struct tool_error *error);
// Measure the missing distances of one setting on all scenes.
int trade_run_distances(struct trade_run *run, int result, int with_flicker, struct tool_error *error);
// Take one more sample of the time on a scene (-1: `both`).
int trade_run_time(struct trade_run *run, int result, int scene, struct tool_error *error);
// Measure rounding and faithfulness.
int trade_run_axes(struct trade_run *run, int result, struct tool_error *error);

// The picture that was rendered last on a scene.
static inline const float *trade_run_picture(const struct trade_run *run, int scene)
{
    return run->out[scene].image.data[0];
}

#endif
