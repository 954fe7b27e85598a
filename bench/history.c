// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench history`: how frames, memory and distances changed from commit to commit.
#include "commands.h"
#include "history.h"
#include "machine.h"
#include "report.h"
#include "tools/common/machine.h"
#include "tools/common/report.h"
#include "truth.h"
#include "write.h"

#include <errno.h>
#include <math.h>
#include <string.h>

static const char default_file[] = "bench/history/history.jsonl", default_svg[] = "bench/history/history.svg";

// ---- a new point ----

// Round to five digits: people read the file too.
static double rounded(double x)
{
    char digits[32];
    double y = 0;
    snprintf(digits, sizeof digits, "%.5g", x);
    sscanf(digits, "%lf", &y);
    return y;
}

static int hash_file(const char *path, uint32_t *hash, struct tool_error *error)
{
    FILE *f = fopen(path, "rb");
    if (!f)
        return tool_fail(error, -1, "cannot read %s: %s", path, strerror(errno));
    unsigned char part[4096];
    for (size_t n; (n = fread(part, 1, sizeof part, f)) > 0;)
        for (size_t i = 0; i < n; i++)
            *hash = (*hash ^ part[i]) * 16777619u;  // FNV-1a
    const int failed = ferror(f);
    fclose(f);
    return failed ? tool_fail(error, -1, "cannot read all of %s", path) : 0;
}

// Hash the pictures that errors are measured on: two points compare only if these are the same.
static int hash_truth(char *text, size_t size, const char *images, struct tool_error *error)
{
    uint32_t hash = 2166136261u;
    char path[4096];
    for (int i = 0; i < 2 * BENCH_OTHERS; i++) {
        snprintf(path, sizeof path, "%s/%s%s.exr", images, bench_others[i / 2].scene, i % 2 ? ".truth" : "");
        if (hash_file(path, &hash, error))
            return -1;
    }
    snprintf(text, size, "%08x", hash);
    return 0;
}

// Whether an engine is measured; with --engine only that one is.
static int is_wanted(const struct bench_args *args, int engine)
{
    return !args->engine_given || (int)args->params.engine == engine;
}

static int measure_engine(struct history_point *p, const struct bench_args *args, enum hf_engine engine, int *busy,
                          struct tool_error *error)
{
    struct bench_args a = *args;
    struct bench_result r;
    struct bench_run run;
    const char *name = hf_engine_name(engine);
    a.params.engine = engine;
    if (bench_passes_measure(&a, 0, &run, &r, error))
        return -1;
    *busy += bench_is_busy(&r.all);
    if (!*p->isa) {
        snprintf(p->isa, sizeof p->isa, "%s", hf_isa_name(run.isa));
        history_set(p, run.threads, "threads");
        history_set(p, rounded(r.memcpy_ms), "memcpy_ms");
        history_set(p, rounded(r.fma_gflops), "fma_gflops");
    }
    history_set(p, rounded(r.all.median_ms), "ms %s", name);
    history_set(p, rounded((double)r.stats.all.memory_held * 1e-6), "MB %s", name);
    for (int i = 0; i < tool_passes(engine); i++)
        history_set(p, rounded(r.pass[i].median_ms), "pass %s/%s", name, hf_inspect_pass_name(engine, i));
    return 0;
}

static int measure(struct history_point *p, const struct bench_args *args, struct tool_error *error)
{
    struct bench_truth truth;
    int busy = 0;
    *p = (struct history_point){.source = "measured"};
    snprintf(p->commit, sizeof p->commit, "%s", bench_machine_commit());
    bench_machine_date(p->date, sizeof p->date);
    tool_cpu(p->cpu, sizeof p->cpu);
    if (hash_truth(p->truth, sizeof p->truth, args->images, error))
        return -1;
    if (strstr(p->commit, "dirty"))
        fprintf(stderr, "the files differ from the commit: the point's commit is %s\n", p->commit);
    for (int e = 0; e < tool_engines(); e++)
        if (is_wanted(args, e) && measure_engine(p, args, (enum hf_engine)e, &busy, error))
            return -1;
    if (bench_truth_measure(&truth, args, error))
        return -1;
    for (int s = 0; s < BENCH_OTHERS; s++)
        for (int e = 0; e < tool_engines(); e++) {
            const char *engine = hf_engine_name((enum hf_engine)e), *scene = bench_others[s].scene;
            if (!is_wanted(args, e))
                continue;
            history_set(p, rounded(truth.at[s][e].psnr), "dB %s/%s", engine, scene);
            history_set(p, rounded(truth.at[s][e].ms), "ms %s/%s", engine, scene);
        }
    // Set last, so that only this result needs a check: a full point takes no more numbers.
    return history_set(p, busy + truth.busy, "busy")
               ? tool_fail(error, -1, "a point of the history has more than %d numbers", HISTORY_VALUES)
               : 0;
}

// ---- the list of points ----

static void cell(FILE *out, int decimals, double value)
{
    if (isnan(value))
        fprintf(out, " %8s", "");
    else
        fprintf(out, " %8.*f", decimals, value);
}

static char machine_of(const struct history *h, int point)
{
    char letter = 'A';
    for (int i = 0; i < point; i++) {
        if (history_same_machine(&h->point[i], &h->point[point]))
            return machine_of(h, i);
        int first = 1;
        for (int k = 0; k < i; k++)
            first &= !history_same_machine(&h->point[k], &h->point[i]);
        letter = (char)(letter + first);
    }
    return letter;
}

// Print for each engine the mean of one kind of number over the ray-traced scenes.
static void mean_cells(FILE *out, const struct history_point *p, const char *kind, int decimals)
{
    for (int e = 0; e < tool_engines(); e++) {
        double sum = 0;
        for (int s = 0; s < BENCH_OTHERS; s++)
            sum += history_get(p, "%s %s/%s", kind, hf_engine_name((enum hf_engine)e), bench_others[s].scene);
        cell(out, decimals, sum / BENCH_OTHERS);
    }
}

static void table(FILE *out, const void *what)
{
    const struct history *h = what;
    fprintf(out, "%-10s %-10s on %8s", "commit", "date", "memcpy");
    for (int k = 0; k < 2; k++)
        for (int e = 0; e < tool_engines(); e++)
            fprintf(out, " %8s", hf_engine_name((enum hf_engine)e));
    fputc('\n', out);
    for (int i = 0; i < h->points; i++) {
        const struct history_point *p = &h->point[i];
        fprintf(out, "%-10.10s %-10.10s %c ", p->commit, p->date, machine_of(h, i));
        cell(out, 3, history_get(p, "memcpy_ms"));
        mean_cells(out, p, "ms", 1);
        mean_cells(out, p, "dB", 2);
        if (i > 0 && strcmp(p->truth, h->point[i - 1].truth))
            fputs("  other truth", out);
        if (history_get(p, "busy") > 0)
            fprintf(out, "  busy: %g", history_get(p, "busy"));
        fputc('\n', out);
    }
    fputs("\nms, then dB, of frames of 1280 x 720: mean of the ray-traced scenes. busy: how many medians "
          "were far above the least. Machines:\n",
          out);
    for (int i = 0; i < h->points; i++) {
        int first = 1;
        for (int k = 0; k < i; k++)
            first &= !history_same_machine(&h->point[k], &h->point[i]);
        if (first)
            fprintf(out, "%c  %s, %s, %g threads\n", machine_of(h, i), h->point[i].cpu, h->point[i].isa,
                    history_get(&h->point[i], "threads"));
    }
}

struct report {
    const struct bench_args *args;
    const struct history *h;
};

static void report_table(FILE *out, const void *what)
{
    table(out, ((const struct report *)what)->h);
}

static void report_json(FILE *out, const void *what)
{
    const struct report *r = what;
    struct tool_json j;
    bench_json_begin(&j, out, "history", r->args);
    tool_json_open(&j, "points", '[');
    for (int i = 0; i < r->h->points; i++) {
        tool_json_row(&j, NULL, '{');
        history_members(&j, &r->h->point[i]);
        tool_json_close(&j);
    }
    tool_json_end(&j);
}

static int draw(const struct history *h, const char *path, struct tool_error *error)
{
    FILE *f = fopen(path, "w");
    if (!f)
        return tool_fail(error, -1, "--svg: cannot write %s: %s", path, strerror(errno));
    history_draw(f, h);
    const int failed = ferror(f);
    return fclose(f) || failed ? tool_fail(error, -1, "--svg: cannot write %s", path) : 0;
}

int bench_history(struct bench_args *args, struct tool_error *error)
{
    const char *file = args->history ? args->history : default_file;
    const char *svg = args->svg ? args->svg : default_svg;
    struct history h = {0};
    struct history_point p;
    int err = 0;
    if (args->add) {
        err = measure(&p, args, error);
        if (!err)
            err = history_append(&p, file, error);
    }
    if (!err)
        err = history_read(&h, file, error);
    if (!err)
        err = draw(&h, svg, error);
    if (!err)
        err = bench_write_report(args, report_table, report_json, &(struct report){args, &h}, error);
    history_free(&h);
    return err;
}
