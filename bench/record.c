// SPDX-License-Identifier: BSD-3-Clause
#include "record.h"

#include "hyperfocal/inspect.h"
#include <stdlib.h>
#include <time.h>

// Milliseconds of processor time of this thread: other programs on the machine cost a task nothing.
static double cpu_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static double least(double a, double b)
{
    return a < b ? a : b;
}

// The library's parallel_for. Frame 0 only warms up; frame 1 is the first that is kept.
static void run_tasks(void *cookie, int n, void (*fn)(void *arg, int i, int worker), void *arg)
{
    struct bench_record *r = cookie;
    struct bench_step none = {.count = n}, *s = r->at < BENCH_STEPS ? &r->step[r->at] : &none;
    if (r->frame == 1 && r->at < BENCH_STEPS)
        *s = (struct bench_step){.count = n, .ms = calloc((size_t)n, sizeof(double))};
    const int keep = r->frame > 0 && s->ms && s->count == n;
    r->changed |= r->frame > 0 && !keep;
    double now = cpu_ms();
    if (keep)
        s->before = r->frame == 1 ? now - r->last : least(s->before, now - r->last);
    for (int i = 0; i < n; i++) {
        fn(arg, i, 0);
        const double end = cpu_ms();
        if (keep)
            s->ms[i] = r->frame == 1 ? end - now : least(s->ms[i], end - now);
        now = end;
    }
    r->at++;
    r->last = cpu_ms();
}

static int render(struct bench_record *r, const struct bench_subject *subject, struct hf_context *context,
                  struct tool_error *error)
{
    double ms;
    r->at = 0;
    r->last = cpu_ms();
    if (bench_measure_frame(subject, context, &subject->in, &ms, error))
        return -1;
    const double after = cpu_ms() - r->last;
    r->schedule.after = r->frame < 2 ? after : least(r->schedule.after, after);
    r->changed |= r->frame > 1 && r->at != r->schedule.count;
    if (r->frame == 1)
        r->schedule = (struct bench_schedule){r->at < BENCH_STEPS ? r->at : BENCH_STEPS, r->step, after};
    return r->changed ? tool_fail(error, -1, "a frame does not have the steps of the frame before") : 0;
}

int bench_record(struct bench_record *r, const struct bench_subject *subject, enum hf_isa isa, int threads, int frames,
                 struct tool_error *error)
{
    *r = (struct bench_record){.report = {.size = sizeof r->report}};
    const struct hf_config config = {
        .size = sizeof config, .threads = threads, .isa = isa, .parallel_for = run_tasks, .parallel_cookie = r};
    struct hf_context *context;
    struct hf_inspect_report more = {.size = sizeof more};
    int err = hf_open(&context, &config);
    if (err)
        return tool_fail(error, -1, "%s", hf_error_string(err));
    for (r->frame = 0; !err && r->frame <= frames; r->frame++)
        err = render(r, subject, context, error);
    if (!err && (hf_get_report(context, &r->report) || hf_inspect_get_report(context, &more)))
        err = tool_fail(error, -1, "the frame has no report");
    r->tile_width = more.tile_width;
    r->tile_height = more.tile_height;
    hf_close(&context);
    return err;
}

void bench_record_join(struct bench_record *r, const struct bench_record *other)
{
    int same = r->schedule.count == other->schedule.count;
    for (int i = 0; same && i < r->schedule.count; i++)
        same = r->step[i].count == other->step[i].count;
    for (int i = 0; same && i < r->schedule.count; i++) {
        r->step[i].before = least(r->step[i].before, other->step[i].before);
        for (int k = 0; k < r->step[i].count; k++)
            r->step[i].ms[k] = least(r->step[i].ms[k], other->step[i].ms[k]);
    }
    if (same)
        r->schedule.after = least(r->schedule.after, other->schedule.after);
}

void bench_record_free(struct bench_record *r)
{
    for (int i = 0; i < BENCH_STEPS; i++)
        free(r->step[i].ms);
    *r = (struct bench_record){.frame = 0};
}
