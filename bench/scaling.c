// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench scaling`: how the time of a frame grows with its blurred part, and with its size.
#include "commands.h"
#include "simulate.h"
#include "subject.h"
#include "write.h"
#include "tools/common/report.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

static const int sizes[][2] = {{480, 270}, {960, 540}, {1920, 1080}, {3840, 2160}, {7680, 4320}};
static const int shares[] = {0, 10, 25, 50, 75, 100};
static const char *const kinds[] = {"near", "far", "both"};
enum {
    SIZES = sizeof sizes / sizeof *sizes,
    SHARES = sizeof shares / sizeof *shares,
    KINDS = sizeof kinds / sizeof *kinds,
    HD = 2,  // index of 1920x1080
    // All points of a size are measured together in each of that many rounds, because other work on the machine comes
    // and goes: so ratios compare measurements a few seconds apart. A point's time is the median over the rounds of
    // their medians.
    ROUNDS = 5,
    LEAST = 2,  // least frames of a point in a round
};
static const double seconds = 0.06;  // per point and round

struct point {
    struct bench_row all;
    size_t memory;  // held by the context
};

struct size_result {
    int width, height;
    double memcpy_ms;
    struct point point[KINDS][SHARES];
};

struct scaling {
    const struct bench_args *args;
    int threads, count;
    enum hf_isa isa;
    float max_radius;
    struct size_result size[SIZES];
};

static double megapixels(const struct size_result *s)
{
    return (double)s->width * s->height * 1e-6;
}

// The time with 10 % of the frame blurred, relative to that of the frame fully blurred.
static double tenth(const struct size_result *s, int kind)
{
    return s->point[kind][1].all.median_ms / s->point[kind][SHARES - 1].all.median_ms;
}

// Milliseconds per megapixel with near and far everywhere, relative to those at 1920x1080; 0: not measured.
static double growth(const struct scaling *r, int i)
{
    const struct size_result *s = &r->size[i], *hd = &r->size[HD];
    if (r->count <= HD)
        return 0;
    return s->point[KINDS - 1][SHARES - 1].all.median_ms / megapixels(s) /
           (hd->point[KINDS - 1][SHARES - 1].all.median_ms / megapixels(hd));
}

// The most memory that the process has held, bytes.
static double peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : (double)usage.ru_maxrss * 1024;
}

// How many points have a median far above their least time.
static int busy_points(const struct scaling *r)
{
    int n = 0;
    for (int i = 0; i < r->count; i++)
        for (int k = 0; k < KINDS; k++)
            for (int j = 0; j < SHARES; j++)
                n += bench_is_busy(&r->size[i].point[k][j].all);
    return n;
}

static void table(FILE *out, const void *what)
{
    const struct scaling *r = what;
    fprintf(out, "%-11s %-5s %9s", "size", "band", "memcpy");
    for (int i = 0; i < SHARES; i++)
        fprintf(out, " %7d %%", shares[i]);
    fprintf(out, " %9s %10s %9s\n", "10/100", "ms/Mpixel", "MB held");
    for (int i = 0; i < r->count; i++)
        for (int k = 0; k < KINDS; k++) {
            const struct size_result *s = &r->size[i];
            fprintf(out, "%4d x %-4d %-5s %9.3f", s->width, s->height, kinds[k], s->memcpy_ms);
            for (int j = 0; j < SHARES; j++)
                fprintf(out, " %9.3f", s->point[k][j].all.median_ms);
            fprintf(out, " %9.2f %10.3f %9.1f\n", tenth(s, k), s->point[k][SHARES - 1].all.median_ms / megapixels(s),
                    (double)s->point[k][SHARES - 1].memory * 1e-6);
        }
    fprintf(out, "\n%s, %d threads, engine %s, radius %g; the process had at most %.0f MB\n", hf_isa_name(r->isa),
            r->threads, hf_engine_name(r->args->params.engine), r->max_radius, peak_memory() * 1e-6);
    if (busy_points(r))
        fprintf(out, "The machine is busy: %d of %d medians are far above the least.\n", busy_points(r),
                r->count * KINDS * SHARES);
}

static void json_point(struct tool_json *j, const struct scaling *r, int i, int k, int n)
{
    const struct size_result *s = &r->size[i];
    const struct point *p = &s->point[k][n];
    tool_json_row(j, NULL, '{');
    tool_json_count(j, "width", s->width);
    tool_json_count(j, "height", s->height);
    tool_json_text(j, "kind", kinds[k]);
    tool_json_count(j, "share", shares[n]);
    tool_json_ms(j, "median_ms", p->all.median_ms);
    tool_json_ms(j, "min_ms", p->all.min_ms);
    tool_json_ms(j, "max_ms", p->all.max_ms);
    tool_json_ms(j, "ms_per_megapixel", p->all.median_ms / megapixels(s));
    tool_json_ms(j, "memcpy_ms", s->memcpy_ms);
    tool_json_count(j, "memory", (long long)p->memory);
    tool_json_close(j);
}

static void json_size(struct tool_json *j, const struct scaling *r, int i)
{
    const struct size_result *s = &r->size[i];
    tool_json_row(j, NULL, '{');
    tool_json_count(j, "width", s->width);
    tool_json_count(j, "height", s->height);
    tool_json_ms(j, "memcpy_ms", s->memcpy_ms);
    tool_json_open(j, "ten_over_all", '{');
    for (int k = 0; k < KINDS; k++)
        tool_json_number(j, kinds[k], tenth(s, k));
    tool_json_close(j);
    tool_json_number(j, "per_megapixel_over_1080p", growth(r, i));
    tool_json_close(j);
}

static void json(FILE *out, const void *what)
{
    const struct scaling *r = what;
    struct tool_json j;
    bench_json_begin(&j, out, "scaling", r->args);
    tool_json_text(&j, "engine", hf_engine_name(r->args->params.engine));
    tool_json_count(&j, "threads", r->threads);
    tool_json_text(&j, "isa", hf_isa_name(r->isa));
    tool_json_number(&j, "max_radius", r->max_radius);
    tool_json_count(&j, "busy", busy_points(r));
    tool_json_count(&j, "peak_memory", (long long)peak_memory());
    tool_json_open(&j, "points", '[');
    for (int i = 0; i < r->count; i++)
        for (int k = 0; k < KINDS; k++)
            for (int n = 0; n < SHARES; n++)
                json_point(&j, r, i, k, n);
    tool_json_close(&j);
    tool_json_open(&j, "sizes", '[');
    for (int i = 0; i < r->count; i++)
        json_size(&j, r, i);
    tool_json_end(&j);
}

static int by_median(const void *a, const void *b)
{
    const double x = ((const struct bench_row *)a)->median_ms, y = ((const struct bench_row *)b)->median_ms;
    return (x > y) - (x < y);
}

// Sorts the rounds.
static struct bench_row summary(struct bench_row rounds[ROUNDS])
{
    struct bench_row all = rounds[0];
    qsort(rounds, ROUNDS, sizeof *rounds, by_median);
    all.median_ms = rounds[ROUNDS / 2].median_ms;
    for (int i = 1; i < ROUNDS; i++) {
        all.min_ms = rounds[i].min_ms < all.min_ms ? rounds[i].min_ms : all.min_ms;
        all.max_ms = rounds[i].max_ms > all.max_ms ? rounds[i].max_ms : all.max_ms;
    }
    return all;
}

// Measure all points of a size once. depth is the subject's; the scenes' depths are painted into it.
static int measure_round(struct size_result *s, struct scaling *r, const struct bench_scene *scene,
                         const struct bench_subject *subject, float *depth, int round,
                         struct bench_row rows[KINDS][SHARES][ROUNDS], struct tool_error *error)
{
    const struct bench_optics optics = {r->args->params.focus, r->args->params.range.distance,
                                        r->args->params.max_radius};
    for (int k = 0; k < KINDS; k++)
        for (int j = 0; j < SHARES; j++) {
            char name[32];
            struct tool_report stats;
            snprintf(name, sizeof name, "band-%s:%d", kinds[k], shares[j]);
            if (bench_scene_depth(scene, name, &optics, depth, error) ||
                bench_measure_all(subject, seconds, LEAST, &rows[k][j][round], &stats, error))
                return -1;
            s->point[k][j].memory = stats.all.memory_held;
            r->max_radius = stats.params.max_radius;
        }
    return 0;
}

static int measure_size(struct size_result *s, struct scaling *r, struct tool_error *log, struct tool_error *error)
{
    const struct bench_args *a = r->args;
    const struct bench_optics optics = {a->params.focus, a->params.range.distance, a->params.max_radius};
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    float *depth = malloc((size_t)s->width * (size_t)s->height * sizeof(float));
    int err = depth ? bench_scene_paint(&scene, "mixed", s->width, s->height, &optics, error)
                    : tool_fail(error, -1, "there is not enough memory for %dx%d", s->width, s->height);
    if (!err)
        err = bench_subject_open(&subject, a, &scene, log, error);
    if (!err) {
        subject.depth.data = depth;
        memcpy(depth, scene.depth, (size_t)s->width * (size_t)s->height * sizeof(float));
        s->memcpy_ms = bench_measure_copy(&subject);
        r->threads = hf_context_threads(subject.context);
        r->isa = hf_context_isa(subject.context);
    }
    struct bench_row rows[KINDS][SHARES][ROUNDS];
    for (int round = 0; round < ROUNDS && !err; round++)
        err = measure_round(s, r, &scene, &subject, depth, round, rows, error);
    for (int k = 0; k < KINDS && !err; k++)
        for (int j = 0; j < SHARES; j++)
            s->point[k][j].all = summary(rows[k][j]);
    bench_subject_close(&subject);
    bench_scene_free(&scene);
    free(depth);
    return err;
}

int bench_scaling(struct bench_args *args, struct tool_error *error)
{
    struct scaling r = {.args = args};
    struct tool_error log = {""};
    if (args->simulate)
        return bench_simulate(args, error);
    if (args->frames)
        return tool_fail(error, -1, "--frames %d is of use only with --simulate", args->frames);
    // With --size, sizes up to that one.
    for (int i = 0; i < SIZES && (!args->size_given || sizes[i][0] <= args->width); i++) {
        r.size[i] = (struct size_result){.width = sizes[i][0], .height = sizes[i][1]};
        if (measure_size(&r.size[i], &r, &log, error))
            return -1;
        r.count++;
    }
    if (!r.count)
        return tool_fail(error, -1, "--size %dx%d is less than the smallest, %dx%d", args->width, args->height,
                         sizes[0][0], sizes[0][1]);
    return bench_write_report(args, table, json, &r, error);
}
