// SPDX-License-Identifier: BSD-3-Clause
// What a context holds between frames.
#ifndef HF_CONTEXT_H
#define HF_CONTEXT_H

#include "frame/budget.h"
#include "frame/cost.h"
#include "pass/engine.h"
#include "frame/plan.h"
#include "frame/progress.h"
#include "frame/queue.h"
#include "base/pool.h"
#include "frame/resolve.h"
#include "pass/check.h"
#include "pixel/kernels.h"

struct hf_worker {
    _Alignas(HF_ALIGN) struct hf_frame frame;
    struct hf_counts counts;
    struct hf_counts seen, looked;
    int64_t ns[HF_MAX_PASSES];
    uint32_t tiles[HF_MAX_PASSES];
    struct hf_block scratch;
};

// What an engine keeps between frames.
struct hf_engine_state {
    void *own;
    void *kernels[2];  // exact, fused
};

struct hf_context {
    struct hf_config config;  // the caller's, pointers checked
    struct hf_mem mem;
    enum hf_isa isa;
    int threads;
    struct hf_pixel_kernels kernels[2];  // exact, fused
    struct hf_engine_state engine[HF_ENGINE_COUNT];
    struct hf_block engines;  // owns their memory
    int pid;                  // of the process that has its threads
    struct hf_pool *pool;     // NULL: the host's parallel_for
    struct hf_worker *workers;

    struct hf_plan plan;
    struct hf_queue queue;
    struct hf_block planes;         // buffers of the whole frame
    struct hf_block chunks, tiles;  // the plan's
    struct hf_block joined;         // CoC for a dump: of full resolution, or of narrow buffers
    struct hf_block surfaces;       // planes of known surfaces
    struct hf_block samples;        // of a deep picture: a row's and a pixel's, of each worker
    struct hf_block repairs;        // in place: what has to be written before a tile overwrites its neighbours
    struct hf_frame_report report;
    struct hf_work work;  // of the plan
    struct hf_cost cost;
    struct hf_budget budget;
    struct hf_rect reads[2];  // of the last plan: pixels of colour and of depth
    atomic_int stop;          // the call that runs is cancelled
    int depth_told;           // the depth format for which a warning said that it is no distance; 0: none

    int colour_stats;           // look at the colour, for the report
    struct hf_message problem;  // of the last call that failed
    void (*dump)(void *cookie, const struct hf_inspect_buffer *buffer);
    void *dump_cookie;
    struct hf_progress_call progress;
};

// Allocate and free what engines keep. May return HF_ERR_MEMORY.
int hf_engines_open(struct hf_context *c);
void hf_engines_close(struct hf_context *c);
// The bytes of all that.
size_t hf_engines_bytes(const struct hf_context *c);
// How much of a frame is done: all of it; only its plan; or its plan, and its memory allocated.
enum hf_task { HF_TASK_RENDER, HF_TASK_PLAN, HF_TASK_PREPARE };

// The input and output of a frame.
struct hf_job {
    const struct hf_image *dst, *src;
    const struct hf_depth *depth;
    int fused;
    enum hf_task task;
};

// Run a frame whose arguments have been checked (render.c).
int hf_render_frame(struct hf_context *c, struct hf_setup *s, const struct hf_job *job);

#endif
