// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench truth`: how close each engine comes to the picture of a ray-traced thin lens, and its time.
#include "commands.h"
#include "metrics.h"
#include "others.h"
#include "peels.h"
#include "subject.h"
#include "truth.h"
#include "write.h"
#include "tools/common/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct bench_other *const scenes = bench_others;
enum { SCENES = BENCH_OTHERS, LEAST = 3 };

// Whether an engine is measured; with --engine only that one is.
static int wanted(const struct bench_truth *t, int engine)
{
    return !t->args->engine_given || (int)t->args->params.engine == engine;
}

void bench_truth_distance(const float *a, const float *b, size_t n, double *psnr, double *rmse)
{
    double shown = 0, linear = 0;
    for (size_t i = 0; i < n; i++) {
        const double d = (double)bench_display(a[i]) - bench_display(b[i]), l = (double)a[i] - b[i];
        shown += d * d;
        linear += l * l;
    }
    *psnr = -10 * log10(shown / (double)n);
    *rmse = sqrt(linear / (double)n);
}

static int measure_engine(struct bench_truth *t, int scene, int engine, struct bench_subject *s, const float *want,
                          struct tool_error *error)
{
    struct bench_row all;
    struct tool_report stats;
    const size_t samples = 3 * (size_t)s->in.image.width * (size_t)s->in.image.height;
    s->params.engine = (enum hf_engine)engine;
    s->params.max_radius = t->args->max_radius_given ? t->args->params.max_radius : HF_DERIVE;
    if (bench_measure_all(s, 0.5, LEAST, &all, &stats, error))
        return -1;
    t->busy += bench_is_busy(&all);
    t->at[scene][engine].ms = all.median_ms;
    bench_truth_distance(s->out.image.data[0], want, samples, &t->at[scene][engine].psnr, &t->at[scene][engine].rmse);
    return 0;
}

static int measure_scene(struct bench_truth *t, int i, struct tool_error *log, struct tool_error *error)
{
    char path[4096];
    struct bench_args args = *t->args;
    struct bench_scene scene = {0}, want = {0};
    struct bench_subject subject = {0};
    struct bench_camera camera;
    args.in = args.out = HF_FORMAT_RGB32F;
    snprintf(path, sizeof path, "%s/%s.exr", args.images, scenes[i].scene);
    int err = bench_scene_read(&scene, path, 1, &camera, error);
    snprintf(path, sizeof path, "%s/%s.truth.exr", args.images, scenes[i].scene);
    if (!err)
        err = bench_scene_read(&want, path, 0, NULL, error);
    if (!err && (want.width != scene.width || want.height != scene.height))
        err = tool_fail(error, -1, "%s is %dx%d, its scene %dx%d", path, want.width, want.height, scene.width,
                        scene.height);
    if (!err)
        err = bench_subject_open(&subject, &args, &scene, log, error);
    if (!err) {
        bench_subject_lens(&subject, &camera);
        t->threads = hf_context_threads(subject.context);
    }
    for (int e = 0; e < tool_engines() && !err; e++)
        if (wanted(t, e))
            err = measure_engine(t, i, e, &subject, want.rgb, error);
    bench_subject_close(&subject);
    bench_scene_free(&scene);
    bench_scene_free(&want);
    return err;
}

static void table(FILE *out, const void *what)
{
    const struct bench_truth *t = what;
    fprintf(out, "%-16s", "dB (ms)");
    for (int i = 0; i < SCENES; i++)
        fprintf(out, " %20s", scenes[i].scene);
    fputc('\n', out);
    for (int e = 0; e < tool_engines(); e++) {
        if (!wanted(t, e))
            continue;
        fprintf(out, "%-16s", hf_engine_name((enum hf_engine)e));
        for (int i = 0; i < SCENES; i++)
            fprintf(out, " %9.2f %10.1f", t->at[i][e].psnr, t->at[i][e].ms);
        fputc('\n', out);
    }
    fprintf(out, "%-16s", "no blur");
    for (int i = 0; i < SCENES; i++)
        fprintf(out, " %9.2f %10s", scenes[i].none, "");
    fprintf(out, "\n%-16s", "Blender Defocus");
    for (int i = 0; i < SCENES; i++)
        fprintf(out, " %9.2f %10.1f", scenes[i].blender, 1e3 * scenes[i].blender_s);
    fprintf(out, "\n%-16s", "GEGL lens-blur");
    for (int i = 0; i < SCENES; i++)
        fprintf(out, " %9.2f %10s", scenes[i].gegl, "");
    fprintf(
        out,
        "\n\n%d threads; the last three rows were measured elsewhere, on two threads, GEGL in about 300 ms; GEGL on "
        "lights and foliage\nagainst an older truth\n",
        t->threads);
    if (t->busy)
        fprintf(out, "The machine is busy: %d of %d medians are far above the least.\n", t->busy,
                SCENES * (t->args->engine_given ? 1 : tool_engines()));
}

static void json(FILE *out, const void *what)
{
    const struct bench_truth *t = what;
    struct tool_json j;
    bench_json_begin(&j, out, "truth", t->args);
    tool_json_count(&j, "threads", t->threads);
    tool_json_count(&j, "busy", t->busy);
    tool_json_open(&j, "results", '[');
    for (int i = 0; i < SCENES; i++)
        for (int e = 0; e < tool_engines(); e++) {
            if (!wanted(t, e))
                continue;
            tool_json_row(&j, NULL, '{');
            tool_json_text(&j, "scene", scenes[i].scene);
            tool_json_text(&j, "engine", hf_engine_name((enum hf_engine)e));
            tool_json_number(&j, "psnr_db", t->at[i][e].psnr);
            tool_json_number(&j, "linear_rmse", t->at[i][e].rmse);
            tool_json_ms(&j, "median_ms", t->at[i][e].ms);
            tool_json_close(&j);
        }
    tool_json_end(&j);
}

int bench_truth_measure(struct bench_truth *t, const struct bench_args *args, struct tool_error *error)
{
    struct tool_error log = {""};
    *t = (struct bench_truth){.args = args};
    for (int i = 0; i < SCENES; i++)
        if (measure_scene(t, i, &log, error))
            return *log.text ? tool_fail(error, -1, "%s", log.text) : -1;
    return 0;
}

int bench_truth(struct bench_args *args, struct tool_error *error)
{
    struct bench_truth t;
    if (args->image || args->truth)
        return bench_score(args, error);
    if (args->peels)
        return bench_peels(args, error);
    return bench_truth_measure(&t, args, error) ? -1 : bench_write_report(args, table, json, &t, error);
}
