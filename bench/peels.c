// SPDX-License-Identifier: BSD-3-Clause
#include "peels.h"

#include "statistics.h"
#include "subject.h"
#include "truth.h"
#include "write.h"
#include "tools/common/machine.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { ROUNDS = 7, WARM = 2 };
static const char ending[] = ".peel1.exr";

// What is rendered of a scene.
struct work {
    struct bench_scene picture, truth;
    struct bench_peel peels[BENCH_SURFACES - 1];
    struct bench_subject subjects[BENCH_SURFACES];  // with one surface known, two, three
    char path[4096];
};

static void close_work(struct work *w)
{
    for (int k = 0; k < BENCH_SURFACES; k++)
        bench_subject_close(&w->subjects[k]);
    for (int k = 0; k < BENCH_SURFACES - 1; k++)
        bench_peel_free(&w->peels[k]);
    bench_scene_free(&w->picture);
    bench_scene_free(&w->truth);
}

static int read_scene(struct work *w, struct bench_peel_scene *s, const char *folder, struct bench_camera *camera,
                      struct tool_error *error)
{
    char path[4096], third[4200];
    snprintf(path, sizeof path, "%s/%s.truth.exr", folder, s->name);
    snprintf(w->path, sizeof w->path, "%s/%s.exr", folder, s->name);
    snprintf(third, sizeof third, "%s/%s.peel2.exr", folder, s->name);
    if (bench_scene_read(&w->truth, path, 0, NULL, error) || bench_scene_read(&w->picture, w->path, 1, camera, error))
        return -1;
    s->known = access(third, R_OK) ? 2 : 3;
    for (int k = 1; k < s->known; k++) {
        const struct bench_peel *p = &w->peels[k - 1];
        if (bench_peel_read(&w->peels[k - 1], w->path, k, error))
            return -1;
        if (p->width != w->picture.width || p->height != w->picture.height)
            return tool_fail(error, -1, "%s: peel %d is %dx%d, the picture %dx%d", w->path, k, p->width, p->height,
                             w->picture.width, w->picture.height);
    }
    if (w->truth.width == w->picture.width && w->truth.height == w->picture.height)
        return 0;
    return tool_fail(error, -1, "%s is %dx%d, its scene %dx%d", path, w->truth.width, w->truth.height, w->picture.width,
                     w->picture.height);
}

static enum hf_engine engine_of(const struct bench_args *args)
{
    return args->engine_given ? args->params.engine : HF_ENGINE_LAYERS;
}

static int open_subjects(struct work *w, const struct bench_peel_scene *s, const struct bench_peels *t,
                         const struct bench_camera *camera, struct tool_error *log, struct tool_error *error)
{
    struct bench_args args = *t->args;
    args.in = args.out = HF_FORMAT_RGB32F;
    for (int k = 0; k < s->known; k++) {
        struct bench_subject *subject = &w->subjects[k];
        if (bench_subject_open(subject, &args, &w->picture, log, error))
            return -1;
        bench_subject_lens(subject, camera);
        subject->params.engine = engine_of(t->args);
        subject->params.max_radius = args.max_radius_given ? args.params.max_radius : HF_DERIVE;
        bench_subject_peels(subject, w->peels, k);
    }
    return 0;
}

// Frames with one, two and three surfaces in turn, so that all meet the machine in the same state. Medians.
static int time_frames(struct work *w, struct bench_peel_scene *s, struct tool_error *error)
{
    double wall[BENCH_SURFACES][ROUNDS], cpu[BENCH_SURFACES][ROUNDS];
    for (int round = -WARM; round < ROUNDS; round++)
        for (int k = 0; k < s->known; k++) {
            const clock_t start = clock();
            double ms;
            if (bench_measure_frame(&w->subjects[k], w->subjects[k].context, &w->subjects[k].in, &ms, error))
                return -1;
            if (round < 0)
                continue;
            wall[k][round] = ms;
            cpu[k][round] = 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC;
        }
    double samples = 0;
    for (int k = 0; k < s->known; k++) {
        s->at[k].ms = bench_median(wall[k], ROUNDS);
        s->at[k].cpu_ms = bench_median(cpu[k], ROUNDS);
        samples += k ? (double)w->peels[k - 1].samples : 0;
        s->at[k].ns = samples > 0 ? 1e6 * (s->at[k].cpu_ms - s->at[0].cpu_ms) / samples : 0;
    }
    return 0;
}

static int measure_scene(struct bench_peels *t, struct bench_peel_scene *s, struct tool_error *error)
{
    struct work w = {.path = ""};
    struct bench_camera camera;
    struct tool_error log = {""};
    int err = read_scene(&w, s, t->args->images, &camera, error);
    if (!err)
        err = open_subjects(&w, s, t, &camera, &log, error);
    if (!err)
        err = time_frames(&w, s, error);
    if (err && *log.text)
        tool_fail(error, -1, "%s", log.text);
    const size_t n = 3 * (size_t)w.picture.width * (size_t)w.picture.height;
    for (int k = 0; k < s->known && !err; k++) {
        t->threads = hf_context_threads(w.subjects[k].context);
        bench_truth_distance(w.subjects[k].out.image.data[0], w.truth.rgb, n, &s->at[k].psnr, &s->at[k].rmse);
    }
    close_work(&w);
    return err;
}

static int has_peel(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name), e = sizeof ending - 1;
    return n > e && n - e < sizeof((struct bench_peel_scene *)0)->name && !strcmp(entry->d_name + n - e, ending);
}

int bench_peels_measure(struct bench_peels *t, const struct bench_args *args, struct tool_error *error)
{
    struct dirent **entries;
    const int found = scandir(args->images, &entries, has_peel, alphasort);
    int err = 0;
    *t = (struct bench_peels){.args = args};
    if (found < 0)
        return tool_fail(error, -1, "cannot read the folder %s: %s", args->images, strerror(errno));
    for (int i = 0; i < found; i++) {
        if (t->count < PEEL_SCENES && !err) {
            struct bench_peel_scene *s = &t->scenes[t->count++];
            snprintf(s->name, sizeof s->name, "%.*s", (int)(strlen(entries[i]->d_name) - (sizeof ending - 1)),
                     entries[i]->d_name);
            err = measure_scene(t, s, error);
        }
        free(entries[i]);
    }
    free(entries);
    return err;
}

static void table(FILE *out, const void *what)
{
    const struct bench_peels *t = what;
    fprintf(out, "%-12s %8s %8s %9s %9s %9s %12s\n", "scene", "surfaces", "dB", "ms", "CPU ms", "of one",
            "ns a sample");
    for (int i = 0; i < t->count; i++)
        for (int k = 0; k < t->scenes[i].known; k++) {
            const struct bench_peel_scene *s = &t->scenes[i];
            fprintf(out, "%-12s %8d %8.2f %9.1f %9.1f %9.2f", k ? "" : s->name, k + 1, s->at[k].psnr, s->at[k].ms,
                    s->at[k].cpu_ms, s->at[k].cpu_ms / s->at[0].cpu_ms);
            fprintf(out, k ? " %12.1f\n" : "\n", s->at[k].ns);
        }
    const enum hf_engine engine = engine_of(t->args);
    fprintf(
        out,
        "\n%d threads, engine %s%s%s; medians of %d frames, those of a scene in turn; CPU: of all threads; a sample: "
        "one behind the first of its pixel\n",
        t->threads, hf_engine_name(engine), engine == HF_ENGINE_LAYERS ? ", " : "",
        engine == HF_ENGINE_LAYERS ? hf_name(HF_NAMES_LAYERS, (int)t->args->params.layers.quality) : "", ROUNDS);
}

static void json(FILE *out, const void *what)
{
    const struct bench_peels *t = what;
    struct tool_json j;
    bench_json_begin(&j, out, "truth", t->args);
    tool_json_text(&j, "engine", hf_engine_name(engine_of(t->args)));
    tool_json_count(&j, "threads", t->threads);
    tool_json_open(&j, "results", '[');
    for (int i = 0; i < t->count; i++)
        for (int k = 0; k < t->scenes[i].known; k++) {
            const struct bench_peel_scene *s = &t->scenes[i];
            tool_json_row(&j, NULL, '{');
            tool_json_text(&j, "scene", s->name);
            tool_json_count(&j, "surfaces", k + 1);
            tool_json_number(&j, "psnr_db", s->at[k].psnr);
            tool_json_number(&j, "linear_rmse", s->at[k].rmse);
            tool_json_ms(&j, "median_ms", s->at[k].ms);
            tool_json_ms(&j, "cpu_ms", s->at[k].cpu_ms);
            tool_json_number(&j, "of_one", s->at[k].cpu_ms / s->at[0].cpu_ms);
            tool_json_number(&j, "ns_a_sample", s->at[k].ns);
            tool_json_close(&j);
        }
    tool_json_end(&j);
}

int bench_peels(const struct bench_args *args, struct tool_error *error)
{
    struct bench_peels t;
    if (bench_peels_measure(&t, args, error))
        return -1;
    if (!t.count)
        return tool_fail(error, -1, "there is no NAME%s in the folder %s", ending, args->images);
    return bench_write_report(args, table, json, &t, error);
}
