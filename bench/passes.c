// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench passes`: the chapter's table 3.1 on this machine.
#include "commands.h"
#include "measure.h"
#include "report.h"
#include "scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int make_scene(struct bench_args *args, struct bench_scene *scene, struct bench_error *error)
{
    struct hf_params *p = &args->params;
    if (bench_scene_builtin(args->scene, NULL)) {
        const struct bench_optics optics = {p->focus_distance, p->range, p->max_radius};
        return bench_scene_paint(scene, args->scene, args->width, args->height, &optics, error);
    }
    float focus = NAN;
    if (bench_scene_read(scene, args->scene, &focus, error))
        return -1;
    if (!args->focus_given && focus > 0 && isfinite(focus)) {
        p->focus_distance = focus;
        if (!args->range_given)
            p->range = focus / 2;
    }
    return 0;
}

// Keeps the sentence of the last error, which names the argument; hf_error_string only names the kind.
static void keep_message(void *cookie, enum hf_log_level level, const char *message)
{
    if (level == HF_LOG_ERROR)
        snprintf(((struct bench_error *)cookie)->text, sizeof ((struct bench_error *)cookie)->text, "%s", message);
}

static int open_subject(struct bench_subject *s, const struct bench_args *args, const struct bench_scene *scene,
                        struct bench_error *log, struct bench_error *error)
{
    const struct hf_config config = {.threads = args->threads, .isa = args->isa, .log = keep_message,
                                     .log_cookie = log};
    const int err = hf_open(&s->context, &config);
    if (err)
        return bench_fail(error, "%s", *log->text ? log->text : hf_error_string(err));
    s->params = args->params;
    s->depth = (struct hf_depth){.data = scene->depth, .stride = scene->width * (ptrdiff_t)sizeof(float)};
    s->scratch = calloc((size_t)scene->width * (size_t)scene->height, sizeof(float));
    if (!s->scratch || bench_image_alloc(&s->in, scene->width, scene->height, args->in) ||
        bench_image_alloc(&s->out, scene->width, scene->height, args->out))
        return bench_fail(error, "there is not enough memory for pictures of %dx%d", scene->width, scene->height);
    if (bench_workers_open(&s->workers, hf_context_threads(s->context)))
        return bench_fail(error, "%d threads could not be started", hf_context_threads(s->context));
    bench_image_pack(&s->in, scene->rgb);
    return 0;
}

static void close_subject(struct bench_subject *s)
{
    bench_workers_close(&s->workers);
    bench_image_free(&s->out);
    bench_image_free(&s->in);
    free(s->scratch);
    hf_close(&s->context);
}

static int report(const struct bench_run *run, struct bench_error *error)
{
    const char *path = run->args->json;
    const int to_stdout = path && !strcmp(path, "-");
    if (to_stdout)
        bench_report_json(stdout, run);
    else
        bench_report_table(stdout, run);
    if (fflush(stdout))
        return bench_fail(error, "cannot write to stdout: %s", strerror(errno));
    if (!path || to_stdout)
        return 0;
    FILE *f = fopen(path, "w");
    if (!f)
        return bench_fail(error, "cannot write %s: %s", path, strerror(errno));
    bench_report_json(f, run);
    const int failed = ferror(f);
    if (fclose(f) || failed)
        return bench_fail(error, "cannot write %s: %s", path, strerror(errno));
    return 0;
}

int bench_passes(struct bench_args *args, struct bench_error *error)
{
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    struct bench_result result;
    struct bench_error log = {""};
    int err = make_scene(args, &scene, error);
    if (!err)
        err = open_subject(&subject, args, &scene, &log, error);
    if (!err) {
        err = bench_measure(&subject, args->frames, &result, error);
        if (err && *log.text)
            bench_fail(error, "%s", log.text);
    }
    if (!err) {
        const struct bench_run run = {"passes", args, scene.width, scene.height, hf_context_threads(subject.context),
                                      hf_context_isa(subject.context), &result};
        err = report(&run, error);
    }
    close_subject(&subject);
    bench_scene_free(&scene);
    return err;
}
