// SPDX-License-Identifier: BSD-3-Clause
// Frames are measured in rounds, with the yardsticks between them, so that both meet the machine in the same state: on
// a shared one, speed drifts within seconds. Frames and copies count by their median, because other programs often add
// time. The peak is the best of many short bursts, because it stands for what the machine can do.
#include "measure.h"

#include "peak.h"
#include "statistics.h"
#include "tools/common/machine.h"
#include "tools/common/report.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROUNDS = 7,
    COPIES = 5,  // timed copies per round
    BURSTS = 4,  // per round; short ones, because an interrupted one is lost
    MIN_FRAMES = 11,
    MAX_FRAMES = 1001,
    MIN_WARM_UP = 3,
};
// On an otherwise idle machine the median is 2 to 10 % above the least.
static const double BUSY = 1.3;
static const double warm_up_s = 0.3, run_s = 3.0, burst_s = 0.003;

struct frame {
    double all_ms, planning_ms;
    double pass_ms[TOOL_PASSES];
};

struct yardsticks {
    double copy_s[ROUNDS * COPIES];
    int copies;
    double gflops;
    long burst;  // iterations of a burst
};

static int by_all(const void *a, const void *b)
{
    const struct frame *x = a, *y = b;
    return (x->all_ms > y->all_ms) - (x->all_ms < y->all_ms);
}

// Round to whole nanoseconds, so that the printed rows and the overhead add up exactly.
static double round_ms(double ms)
{
    return rint(ms * 1e6) * 1e-6;
}

// What a frame is made of: the picture, or it and its peels.
static int render_all(const struct bench_subject *s, struct hf_context *c, const struct bench_image *from)
{
    struct hf_layer layers[BENCH_SURFACES];
    layers[0] = (struct hf_layer){.size = sizeof *layers, .image = &from->image, .depth = &s->depth};
    for (int i = 1; i < s->surfaces; i++)
        layers[i] = (struct hf_layer){.size = sizeof *layers,
                                      .kind = HF_LAYER_PEEL,
                                      .image = &s->peel_images[i - 1],
                                      .depth = &s->peel_depths[i - 1]};
    return s->surfaces > 1 ? hf_render_layers(c, &s->out.image, layers, s->surfaces, &s->params, NULL)
                           : hf_render(c, &s->out.image, &from->image, &s->depth, &s->params);
}

static int render_with(const struct bench_subject *s, struct hf_context *c, const struct bench_image *from,
                       struct frame *frame, struct tool_error *error)
{
    const double start = tool_now_ms();
    const int err = render_all(s, c, from);
    const double end = tool_now_ms();
    if (err)
        return tool_fail(error, -1, "rendering failed: %s", hf_error_string(err));
    struct tool_report report;
    tool_report_get(c, &report);
    frame->planning_ms = report.inner.plan_ms;
    frame->all_ms = round_ms(end - start);
    for (int p = 0; p < TOOL_PASSES; p++)
        frame->pass_ms[p] = round_ms(report.pass[p].ms);
    return 0;
}

static int render(const struct bench_subject *s, struct frame *frame, struct tool_error *error)
{
    return render_with(s, s->context, &s->in, frame, error);
}

int bench_measure_frame(const struct bench_subject *s, struct hf_context *c, const struct bench_image *from, double *ms,
                        struct tool_error *error)
{
    struct frame frame;
    const int err = render_with(s, c, from, &frame, error);
    *ms = err ? 0 : frame.all_ms;
    return err;
}

// Copy part i of n of a block, in whole cache lines.
static void copy_part(void *to, const void *from, size_t bytes, int i, int n)
{
    const size_t lines = (bytes + 63) / 64;
    const size_t begin = lines * (size_t)i / (size_t)n * 64, end = lines * ((size_t)i + 1) / (size_t)n * 64;
    if (begin < bytes)
        memcpy((char *)to + begin, (const char *)from + begin, (end < bytes ? end : bytes) - begin);
}

static void copy(void *arg, int i, int n)
{
    const struct bench_subject *s = arg;
    const size_t plane = (size_t)s->in.image.width * (size_t)s->in.image.height * sizeof(float);
    // If the formats differ in size, copy as much as fits.
    copy_part(s->out.memory, s->in.memory, s->in.bytes < s->out.bytes ? s->in.bytes : s->out.bytes, i, n);
    copy_part(s->scratch, s->depth.data, plane, i, n);
}

struct burst {
    const struct bench_peak *peak;
    long iterations;
};

static void peak_part(void *arg, int i, int n)
{
    const struct burst *b = arg;
    (void)i;
    (void)n;
    volatile float sink = b->peak->run(b->iterations);
    (void)sink;
}

static void measure_yardsticks(const struct bench_subject *s, struct yardsticks *y)
{
    for (int i = 0; i <= COPIES; i++) {
        const double seconds = bench_workers_run(s->workers, copy, (void *)s);
        if (i > 0)  // the first copy finds other data in the caches
            y->copy_s[y->copies++] = seconds;
    }
    struct burst b = {bench_peak_widest(), y->burst ? y->burst : 10000};
    if (!y->burst) {
        bench_workers_run(s->workers, peak_part, &b);
        const double seconds = bench_workers_run(s->workers, peak_part, &b);
        y->burst = (long)(burst_s / fmax(seconds, 1e-7) * (double)b.iterations) + 1;
        b.iterations = y->burst;
    }
    const double flops = (double)b.iterations * b.peak->flops * bench_workers_threads(s->workers);
    for (int i = 0; i < BURSTS; i++)
        y->gflops = fmax(y->gflops, flops / bench_workers_run(s->workers, peak_part, &b) * 1e-9);
}

// Render until memory is paged in and clock speeds have risen. *frame_s receives the seconds of a frame.
static int warm_up(const struct bench_subject *s, double *frame_s, struct tool_error *error)
{
    *frame_s = INFINITY;
    const double start = tool_now_ms();
    for (int i = 0; i < MIN_WARM_UP || tool_now_ms() - start < 1e3 * warm_up_s; i++) {
        struct frame frame;
        if (render(s, &frame, error))
            return -1;
        *frame_s = fmin(*frame_s, frame.all_ms * 1e-3);
    }
    return 0;
}

static int by_planning(const void *a, const void *b)
{
    const struct frame *x = a, *y = b;
    return (x->planning_ms > y->planning_ms) - (x->planning_ms < y->planning_ms);
}

// The number of frames is odd, so one of them is the median.
static int choose_frames(double frame_s)
{
    const double n = run_s / frame_s;
    return (int)fmin(fmax(n, MIN_FRAMES), MAX_FRAMES) | 1;
}

static int measure_frames(const struct bench_subject *s, struct frame *frames, int n, struct yardsticks *y,
                          struct tool_error *error)
{
    for (int round = 0; round < ROUNDS; round++) {
        measure_yardsticks(s, y);
        struct frame settle;
        if (render(s, &settle, error))
            return -1;
        const int end = (int)((int64_t)n * (round + 1) / ROUNDS);
        for (int i = (int)((int64_t)n * round / ROUNDS); i < end; i++)
            if (render(s, &frames[i], error))
                return -1;
    }
    return 0;
}

// The pass whose time includes that of pass p, which ran but has no time of its own: the nearest one before it in the
// table that has some, else the nearest after it.
static int fused_into(const struct bench_result *r, int p)
{
    if (r->pass[p].max_ms > 0 || r->stats.pass[p].ran == 0)
        return -1;
    for (int q = p - 1; q >= 0; q--)
        if (r->pass[q].max_ms > 0)
            return q;
    for (int q = p + 1; q < TOOL_PASSES; q++)
        if (r->pass[q].max_ms > 0)
            return q;
    return -1;
}

// Sorts frames.
static void summarise(struct frame *frames, int n, struct bench_result *r)
{
    qsort(frames, (size_t)n, sizeof *frames, by_all);
    const struct frame *middle = &frames[(n - 1) / 2];
    r->frames = n;
    r->all = (struct bench_row){middle->all_ms, frames[0].all_ms, frames[n - 1].all_ms, -1};
    r->overhead_ms = middle->all_ms;
    for (int p = 0; p < TOOL_PASSES; p++) {
        struct bench_row *row = &r->pass[p];
        *row = (struct bench_row){middle->pass_ms[p], INFINITY, 0, -1};
        for (int i = 0; i < n; i++) {
            row->min_ms = fmin(row->min_ms, frames[i].pass_ms[p]);
            row->max_ms = fmax(row->max_ms, frames[i].pass_ms[p]);
        }
        r->overhead_ms -= row->median_ms;
    }
    r->overhead_ms = round_ms(r->overhead_ms);
    qsort(frames, (size_t)n, sizeof *frames, by_planning);
    r->planning_ms = round_ms(frames[(n - 1) / 2].planning_ms);
    for (int p = 0; p < TOOL_PASSES; p++)
        r->pass[p].in = fused_into(r, p);
}

int bench_is_busy(const struct bench_row *all)
{
    return all->median_ms > BUSY * all->min_ms;
}

double bench_measure_copy(const struct bench_subject *s)
{
    double seconds[COPIES];
    bench_workers_run(s->workers, copy, (void *)s);
    for (int i = 0; i < COPIES; i++)
        seconds[i] = bench_workers_run(s->workers, copy, (void *)s);
    return round_ms(bench_median(seconds, COPIES) * 1e3);
}

int bench_measure_all(const struct bench_subject *s, double seconds, int least, struct bench_row *all,
                      struct tool_report *stats, struct tool_error *error)
{
    enum { MOST = 401 };
    struct frame frames[MOST];
    for (int i = 0; i < 2; i++)  // the first frame knows nothing of the scene, and pays for memory
        if (render(s, &frames[0], error))
            return -1;
    int n = 0;
    for (const double start = tool_now_ms(); n < MOST && (n < least || tool_now_ms() - start < 1e3 * seconds); n++)
        if (render(s, &frames[n], error))
            return -1;
    qsort(frames, (size_t)n, sizeof *frames, by_all);
    *all = (struct bench_row){frames[(n - 1) / 2].all_ms, frames[0].all_ms, frames[n - 1].all_ms, -1};
    tool_report_get(s->context, stats);
    return 0;
}

int bench_measure(const struct bench_subject *subject, int frames, struct bench_result *result,
                  struct tool_error *error)
{
    *result = (struct bench_result){0};
    double frame_s;
    if (warm_up(subject, &frame_s, error))
        return -1;
    const int n = frames ? frames : choose_frames(frame_s);
    struct frame *list = calloc((size_t)n, sizeof *list);
    if (!list)
        return tool_fail(error, -1, "there is not enough memory to measure %d frames", n);
    struct yardsticks y = {0};
    const int err = measure_frames(subject, list, n, &y, error);
    if (!err) {
        tool_report_get(subject->context, &result->stats);
        summarise(list, n, result);
        result->memcpy_ms = round_ms(bench_median(y.copy_s, y.copies) * 1e3);
        result->fma_gflops = y.gflops;
    }
    free(list);
    return err;
}
