// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench cancel`: how long a frame that is cancelled still takes, from hf_cancel until hf_render returns. Each
// setting is cancelled at places spread over its whole frame, in a context that has rendered one and, in every fourth round,
// in a new one. A new context still makes its tables, and the system clears the memory that it takes: that can take tens of
// milliseconds, so new contexts have a column of their own. The processor's time counts what the process computed meanwhile, over its
// threads: that is the library's part of the time, whatever else keeps the machine busy.
#include "commands.h"
#include "statistics.h"
#include "subject.h"
#include "write.h"

#include "tools/common/machine.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

static const struct setting {
    const char *name;
    enum hf_engine engine;
    float max_radius;
    enum hf_layers_quality quality;
    float cat_eye, sigma;
} settings[] = {
    {"gather", HF_ENGINE_GATHER, .max_radius = 12},
    {"gather, radius 200", HF_ENGINE_GATHER, .max_radius = 200},
    {"hexagon", HF_ENGINE_HEXAGON, .max_radius = 24},
    {"hexagon, radius 200", HF_ENGINE_HEXAGON, .max_radius = 200},
    {"scatter", HF_ENGINE_SCATTER, .max_radius = 24},
    {"scatter, radius 400", HF_ENGINE_SCATTER, .max_radius = 400},
    {"gaussian", HF_ENGINE_GAUSSIAN, .max_radius = 12},
    {"gaussian, sigma 100", HF_ENGINE_GAUSSIAN, .max_radius = 12, .sigma = 100},
    {"layers", HF_ENGINE_LAYERS, .max_radius = 24},
    {"layers best", HF_ENGINE_LAYERS, .max_radius = 24, .quality = HF_LAYERS_BEST},
    {"layers best, radius 400", HF_ENGINE_LAYERS, .max_radius = 400, .quality = HF_LAYERS_BEST},
    {"layers, cat's eyes", HF_ENGINE_LAYERS, .max_radius = 60, .cat_eye = 0.7f},
};
enum { SETTINGS = sizeof settings / sizeof *settings, ROUNDS = 24, FRESH = 4, LEAST = 8 };
static const double longest_ms = 20000;  // of a setting: then rounds beyond LEAST are left out

struct latency {
    double frame_ms;           // of the whole frame
    double ms[ROUNDS];         // wall time, sorted
    double processor[ROUNDS];  // milliseconds over the threads, sorted
    double median, worst, processor_median, processor_worst;
    double fresh_worst;  // ms, in new contexts, which count nowhere else
    int rounds, count;   // cancels, and those that came before the frame of a used context was done
};

struct cancel {
    const struct bench_args *args;
    int threads;
    enum hf_isa isa;
    struct latency latency[SETTINGS];
};

// One call that is rendered by one thread and cancelled by another.
struct call {
    const struct bench_subject *subject;
    struct hf_context *context;
    double after_ms;
    double cancelled, returned, processor[2];
    int err;
};

static double processor_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void render_or_cancel(void *arg, int i, int threads)
{
    struct call *c = arg;
    const struct bench_subject *s = c->subject;
    (void)threads;
    if (i == 0) {
        c->err = hf_render(c->context, &s->out.image, &s->in.image, &s->depth, &s->params);
        c->returned = tool_now_ms();
        c->processor[1] = processor_ms();
        return;
    }
    const struct timespec t = {(time_t)(c->after_ms / 1e3), (long)(c->after_ms * 1e6) % 1000000000};
    nanosleep(&t, NULL);
    c->processor[0] = processor_ms();
    c->cancelled = tool_now_ms();
    hf_cancel(c->context);
}

static int measure_round(struct latency *l, const struct bench_subject *s, const struct hf_config *config,
                         struct bench_workers *two, int round, struct tool_error *error)
{
    struct call call = {
        .subject = s, .context = s->context, .after_ms = l->frame_ms * (round * 7 % ROUNDS + 0.5) / ROUNDS};
    struct hf_context *fresh = NULL;
    int err = round % FRESH ? HF_OK : hf_open(&fresh, config);
    if (fresh)
        call.context = fresh;
    if (!err) {
        bench_workers_run(two, render_or_cancel, &call);
        err = call.err == HF_ERR_CANCELLED ? HF_OK : call.err;
    }
    if (call.err == HF_ERR_CANCELLED && fresh) {
        l->fresh_worst = fmax(l->fresh_worst, call.returned - call.cancelled);
    } else if (call.err == HF_ERR_CANCELLED) {
        l->ms[l->count] = call.returned - call.cancelled;
        l->processor[l->count++] = (call.processor[1] - call.processor[0]) / hf_context_threads(s->context);
    }
    hf_close(&fresh);
    return err ? tool_fail(error, -1, "rendering failed: %s", hf_error_string(err)) : 0;
}

static int measure(struct cancel *r, int i, struct bench_subject *s, struct bench_workers *two,
                   struct tool_error *error)
{
    const struct setting *set = &settings[i];
    struct latency *l = &r->latency[i];
    const struct hf_config config = {.size = sizeof(config), .threads = r->threads, .isa = r->args->isa};
    s->params = r->args->params;
    s->params.engine = set->engine;
    s->params.max_radius = set->max_radius;
    s->params.layers.quality = set->quality;
    s->params.aperture.cat_eye = set->cat_eye;
    s->params.gaussian.sigma = set->sigma > 0 ? set->sigma : HF_DERIVE;
    for (int frame = 0; frame < 2; frame++)  // the first frame takes memory and makes tables
        if (bench_measure_frame(s, s->context, &s->in, &l->frame_ms, error))
            return -1;
    const double start = tool_now_ms();
    for (; l->rounds < ROUNDS && (l->rounds < LEAST || tool_now_ms() - start < longest_ms); l->rounds++)
        if (measure_round(l, s, &config, two, l->rounds, error))
            return -1;
    if (!l->count)
        return 0;
    l->median = bench_median(l->ms, l->count);
    l->processor_median = bench_median(l->processor, l->count);
    l->worst = l->ms[l->count - 1];
    l->processor_worst = l->processor[l->count - 1];
    return 0;
}

static void table(FILE *out, const void *what)
{
    const struct cancel *r = what;
    fprintf(out, "%-24s %10s %10s %10s %10s %10s %10s %10s\n", "", "frame ms", "cancelled", "median ms", "worst ms",
            "median cpu", "worst cpu", "worst new");
    for (int i = 0; i < SETTINGS; i++) {
        const struct latency *l = &r->latency[i];
        fprintf(out, "%-24s %10.2f %7d/%-2d %10.3f %10.3f %10.3f %10.3f %10.3f\n", settings[i].name, l->frame_ms,
                l->count, l->rounds, l->median, l->worst, l->processor_median, l->processor_worst, l->fresh_worst);
    }
    fprintf(out, "\n%s, %d threads, %d x %d; cpu: of the process, over its threads; new: first frames of contexts\n",
            hf_isa_name(r->isa), r->threads, r->args->width, r->args->height);
}

static void json(FILE *out, const void *what)
{
    const struct cancel *r = what;
    struct tool_json j;
    bench_json_begin(&j, out, "cancel", r->args);
    tool_json_text(&j, "isa", hf_isa_name(r->isa));
    tool_json_number(&j, "threads", r->threads);
    tool_json_open(&j, "settings", '[');
    for (int i = 0; i < SETTINGS; i++) {
        const struct latency *l = &r->latency[i];
        tool_json_row(&j, NULL, '{');
        tool_json_text(&j, "name", settings[i].name);
        tool_json_number(&j, "frame_ms", l->frame_ms);
        tool_json_number(&j, "cancelled", l->count);
        tool_json_number(&j, "median_ms", l->median);
        tool_json_number(&j, "worst_ms", l->worst);
        tool_json_number(&j, "median_processor_ms", l->processor_median);
        tool_json_number(&j, "worst_processor_ms", l->processor_worst);
        tool_json_number(&j, "worst_new_ms", l->fresh_worst);
        tool_json_close(&j);
    }
    tool_json_end(&j);
}

int bench_cancel(struct bench_args *args, struct tool_error *error)
{
    static struct cancel r;
    const struct bench_optics optics = {args->params.focus, args->params.range.distance, 12};
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    struct bench_workers *two = NULL;
    struct tool_error log = {""};
    r.args = args;
    int err = bench_scene_paint(&scene, "mixed", args->width, args->height, &optics, error);
    if (!err)
        err = bench_subject_open(&subject, args, &scene, &log, error);
    if (!err && bench_workers_open(&two, 2))
        err = tool_fail(error, -1, "a thread could not be started");
    if (!err) {
        r.threads = hf_context_threads(subject.context);
        r.isa = hf_context_isa(subject.context);
    }
    for (int i = 0; i < SETTINGS && !err; i++)
        err = measure(&r, i, &subject, two, error);
    bench_workers_close(&two);
    bench_subject_close(&subject);
    bench_scene_free(&scene);
    return err ? err : bench_write_report(args, table, json, &r, error);
}
