// SPDX-License-Identifier: BSD-3-Clause
// `hyperfocal-bench passes`: the chapter's table 3.1 on this machine.
#include "commands.h"
#include "report.h"
#include "subject.h"
#include "surfaces.h"
#include "write.h"

#include <math.h>

static int make_scene(struct bench_args *args, struct bench_scene *scene, struct tool_error *error)
{
    struct hf_params *p = &args->params;
    if (bench_scene_builtin(args->scene, NULL)) {
        const struct bench_optics optics = {p->focus, p->range.distance, p->max_radius};
        return bench_scene_paint(scene, args->scene, args->width, args->height, &optics, error);
    }
    struct bench_camera camera;
    if (bench_scene_read(scene, args->scene, 1, &camera, error))
        return -1;
    const float focus = camera.focus;
    if (!args->focus_given && focus > 0 && isfinite(focus)) {
        p->focus = focus;
        if (!args->range_given)
            p->range.distance = focus / 2;
    }
    return 0;
}

static void table(FILE *out, const void *run)
{
    bench_report_table(out, run);
}

static void json(FILE *out, const void *run)
{
    bench_report_json(out, run);
}

int bench_passes_measure(struct bench_args *args, int with_uses, struct bench_run *run, struct bench_result *result,
                         struct tool_error *error)
{
    struct bench_scene scene = {0};
    struct bench_subject subject = {0};
    struct bench_peel peels[BENCH_SURFACES - 1] = {{0}};
    struct tool_error log = {""};
    int err = make_scene(args, &scene, error);
    if (!err)
        err = bench_subject_open(&subject, args, &scene, &log, error);
    for (int k = 1; k < args->surfaces && !err; k++)
        err = bench_scene_builtin(args->scene, NULL) ? bench_peel_make(&peels[k - 1], &scene, k, error)
                                                     : bench_peel_read(&peels[k - 1], args->scene, k, error);
    bench_subject_peels(&subject, peels, args->surfaces - 1);
    if (!err) {
        err = bench_measure(&subject, args->frames, result, error);
        // Several pictures are not rendered in place.
        if (!err && with_uses && args->surfaces == 1)
            err = bench_measure_uses(&subject, &result->uses, error);
        if (err && *log.text)
            tool_fail(error, -1, "%s", log.text);
    }
    if (!err)
        *run = (struct bench_run){"passes",
                                  args,
                                  scene.width,
                                  scene.height,
                                  hf_context_threads(subject.context),
                                  hf_context_isa(subject.context),
                                  result};
    bench_subject_close(&subject);
    for (int k = 0; k < BENCH_SURFACES - 1; k++)
        bench_peel_free(&peels[k]);
    bench_scene_free(&scene);
    return err;
}

int bench_passes(struct bench_args *args, struct tool_error *error)
{
    struct bench_result result;
    struct bench_run run;
    return bench_passes_measure(args, 1, &run, &result, error) ? -1
                                                               : bench_write_report(args, table, json, &run, error);
}
