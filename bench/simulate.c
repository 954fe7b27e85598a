// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench scaling --simulate`: the speedup expected on machines with many threads.
#include "commands.h"
#include "record.h"
#include "simulate.h"
#include "write.h"

#include <stdlib.h>

static const int sizes[][2] = {{1920, 1080}, {3840, 2160}};
static const int threads[] = {1, 2, 4, 8, 16, 32, 64, 128};
enum {
    SIZES = sizeof sizes / sizeof *sizes,
    COUNTS = sizeof threads / sizeof *threads,
    ENGINES = 16,
    REAL = 2,  // the first of them, which are measured on this machine
    FRAMES = 7,
    SOCKET = 64,
};
// Assumed: a wake-up and the last thread's answer take 2 microseconds and each thread's turn at the counters 0.1.
static const double barrier = 2e-3, barrier_thread = 1e-4;

struct row {
    struct bench_expected expected;
    int tile_width, tile_height, steps, tasks;
    double real;  // the least time of a frame on that many threads of this machine; 0: not measured
};

struct engine_rows {
    enum hf_engine engine;
    int width, height;
    struct row row[COUNTS];
};

struct simulation {
    const struct bench_args *args;
    int count;
    struct engine_rows of[SIZES * ENGINES];
};

// With --threads: that number, and one thread to compare it with.
static int is_wanted(const struct bench_args *args, int i)
{
    return !args->threads || i == 0 || threads[i] == args->threads;
}

static double speedup(const struct engine_rows *e, int i)
{
    return e->row[0].expected.ms / e->row[i].expected.ms;
}

static void table(FILE *out, const void *what)
{
    const struct simulation *s = what;
    fprintf(out, "%-8s %-9s %7s %9s %7s %7s", "engine", "size", "threads", "ms", "speedup", "real");
    fprintf(out, "  %-9s %5s %5s %s\n", "tile", "steps", "tasks", "ms lost, the most first");
    for (int n = 0; n < s->count; n++)
        for (int i = 0; i < COUNTS; i++) {
            const struct engine_rows *e = &s->of[n];
            const struct row *r = &e->row[i];
            if (!is_wanted(s->args, i))
                continue;
            char real[16] = "", size[24], tile[24];
            if (r->real > 0)
                snprintf(real, sizeof real, "%.3f", r->real);
            snprintf(size, sizeof size, "%dx%d", e->width, e->height);
            snprintf(tile, sizeof tile, "%dx%d", r->tile_width, r->tile_height);
            fprintf(out, "%-8s %-9s %7d %9.3f %7.2f %7s  %-9s %5d %5d", hf_engine_name(e->engine), size, threads[i],
                    r->expected.ms, speedup(e, i), real, tile, r->steps, r->tasks);
            fprintf(out, " %s %.3f", bench_limit_names[r->expected.most], r->expected.lost[r->expected.most]);
            for (int k = 0; k < BENCH_LIMITS; k++)
                if (k != (int)r->expected.most && r->expected.lost[k] > 0.02 * r->expected.ms)
                    fprintf(out, ", %s %.3f", bench_limit_names[k], r->expected.lost[k]);
            fprintf(out, "\n");
        }
    fprintf(out,
            "\nEach task was measured alone on this machine, in processor time; %g GB/s for %d threads. real: the "
            "least time of a frame on as "
            "many threads here.\n",
            (double)s->args->bandwidth, SOCKET);
}

static void json(FILE *out, const void *what)
{
    const struct simulation *s = what;
    struct tool_json j;
    bench_json_begin(&j, out, "scaling", s->args);
    tool_json_number(&j, "gigabytes_per_second", (double)s->args->bandwidth);
    tool_json_open(&j, "expected", '[');
    for (int n = 0; n < s->count; n++)
        for (int i = 0; i < COUNTS; i++) {
            const struct row *r = &s->of[n].row[i];
            if (!is_wanted(s->args, i))
                continue;
            tool_json_row(&j, NULL, '{');
            tool_json_text(&j, "engine", hf_engine_name(s->of[n].engine));
            tool_json_count(&j, "width", s->of[n].width);
            tool_json_count(&j, "height", s->of[n].height);
            tool_json_count(&j, "threads", threads[i]);
            tool_json_ms(&j, "ms", r->expected.ms);
            tool_json_number(&j, "speedup", speedup(&s->of[n], i));
            tool_json_ms(&j, "real_ms", r->real);
            tool_json_text(&j, "limit", bench_limit_names[r->expected.most]);
            tool_json_close(&j);
        }
    tool_json_end(&j);
}

// The least time of a frame on threads of the library's own.
static int measure_real(const struct bench_subject *subject, enum hf_isa isa, int count, int frames, double *ms,
                        struct tool_error *error)
{
    const struct hf_config config = {.size = sizeof config, .threads = count, .isa = isa};
    struct hf_context *context;
    double now;
    int err = hf_open(&context, &config);
    if (err)
        return tool_fail(error, -1, "%s", hf_error_string(err));
    for (int i = 0; !err && i <= frames; i++) {
        err = bench_measure_frame(subject, context, &subject->in, &now, error);
        *ms = i < 2 || now < *ms ? now : *ms;
    }
    hf_close(&context);
    return err;
}

// What a frame moves at least: it reads the picture and its depth, writes the result, and writes and reads its buffers
// once. A step is assumed to move as much of it as it takes of the time.
static void share_bytes(struct bench_record *r, const struct bench_subject *subject, double buffers)
{
    const double bytes = (double)subject->in.bytes + (double)subject->out.bytes +
                         (double)subject->depth.stride * subject->in.image.height + 2 * buffers;
    double all = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < r->schedule.count; i++) {
            double sum = 0;
            for (int k = 0; k < r->step[i].count; k++)
                sum += r->step[i].ms[k];
            all += pass ? 0 : sum;
            r->step[i].bytes = pass && all > 0 ? bytes * sum / all : 0;
        }
}

static void expect(struct engine_rows *e, const struct bench_args *args, const struct bench_subject *subject,
                   struct bench_record records[COUNTS])
{
    // Where frames are cut in the same way for several numbers of threads, each task has the least of all its times.
    for (int i = 0; i < COUNTS; i++)
        for (int k = 0; k < COUNTS; k++)
            bench_record_join(&records[i], &records[k]);
    for (int i = 0; i < COUNTS; i++) {
        struct bench_record *r = &records[i];
        struct row *row = &e->row[i];
        const struct bench_node node = {threads[i], SOCKET, (double)args->bandwidth * 1e6, barrier, barrier_thread};
        share_bytes(r, subject, (double)records[0].report.memory);
        row->expected = bench_expect(&r->schedule, &node);
        row->tile_width = r->tile_width;
        row->tile_height = r->tile_height;
        row->steps = r->schedule.count;
        for (int k = 0; k < r->schedule.count; k++)
            row->tasks += r->step[k].count;
    }
}

static int simulate(struct engine_rows *e, const struct bench_args *args, const struct bench_subject *subject,
                    struct tool_error *error)
{
    struct bench_record records[COUNTS] = {{.at = 0}};
    int err = 0;
    for (int i = 0; i < COUNTS && !err; i++)
        if (is_wanted(args, i))
            err = bench_record(&records[i], subject, args->isa, threads[i], args->frames, error);
    for (int i = 0; i < REAL && !err; i++)
        if (is_wanted(args, i))
            err = measure_real(subject, args->isa, threads[i], args->frames, &e->row[i].real, error);
    if (!err)
        expect(e, args, subject, records);
    for (int i = 0; i < COUNTS; i++)
        bench_record_free(&records[i]);
    return err;
}

static int simulate_size(struct simulation *s, int width, int height, struct tool_error *log, struct tool_error *error)
{
    const struct bench_args *a = s->args;
    const struct bench_optics optics = {a->params.focus, a->params.range.distance, a->params.max_radius};
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    int err = bench_scene_paint(&scene, a->scene, width, height, &optics, error);
    if (!err)
        err = bench_subject_open(&subject, a, &scene, log, error);
    for (int engine = 0; engine < ENGINES && hf_engine_name((enum hf_engine)engine) && !err; engine++) {
        if (a->engine_given && engine != (int)a->params.engine)
            continue;
        s->of[s->count] = (struct engine_rows){.engine = (enum hf_engine)engine, .width = width, .height = height};
        subject.params.engine = (enum hf_engine)engine;
        err = simulate(&s->of[s->count++], a, &subject, error);
    }
    bench_subject_close(&subject);
    bench_scene_free(&scene);
    return err;
}

int bench_simulate(const struct bench_args *args, struct tool_error *error)
{
    struct bench_args own = *args;
    struct simulation s = {.args = &own};
    struct tool_error log = {""};
    int err = 0;
    for (int i = 1; i < COUNTS && args->threads > 1; i++)
        err |= threads[i] == args->threads;
    if (args->threads > 1 && !err)
        return tool_fail(error, -1, "--threads %d: --simulate knows 1, 2, 4 and so on to 128", args->threads);
    err = 0;
    own.frames = args->frames ? args->frames : FRAMES;
    for (int i = 0; i < (args->size_given ? 1 : SIZES) && !err; i++)
        err = simulate_size(&s, args->size_given ? args->width : sizes[i][0],
                            args->size_given ? args->height : sizes[i][1], &log, error);
    return err ? err : bench_write_report(&own, table, json, &s, error);
}
