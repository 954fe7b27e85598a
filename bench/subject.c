// SPDX-License-Identifier: BSD-3-Clause
#include "subject.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

// Keeps the sentence of the last error, which names the argument; hf_error_string only names the kind.
static void keep_message(void *cookie, enum hf_log_level level, const char *message)
{
    if (level == HF_LOG_ERROR)
        snprintf(((struct bench_error *)cookie)->text, sizeof((struct bench_error *)cookie)->text, "%s", message);
}

int bench_subject_open(struct bench_subject *s, const struct bench_args *args, const struct bench_scene *scene,
                       struct bench_error *log, struct bench_error *error)
{
    const struct hf_config config = {
        .threads = args->threads, .isa = args->isa, .log = keep_message, .log_cookie = log};
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

void bench_subject_close(struct bench_subject *s)
{
    bench_workers_close(&s->workers);
    bench_image_free(&s->out);
    bench_image_free(&s->in);
    free(s->scratch);
    hf_close(&s->context);
}

int bench_write_report(const struct bench_args *args, void (*table)(FILE *out, const void *what),
                       void (*json)(FILE *out, const void *what), const void *what, struct bench_error *error)
{
    const char *path = args->json;
    const int to_stdout = path && !strcmp(path, "-");
    (to_stdout ? json : table)(stdout, what);
    if (fflush(stdout))
        return bench_fail(error, "cannot write to stdout: %s", strerror(errno));
    if (!path || to_stdout)
        return 0;
    FILE *f = fopen(path, "w");
    if (!f)
        return bench_fail(error, "cannot write %s: %s", path, strerror(errno));
    json(f, what);
    const int failed = ferror(f);
    if (fclose(f) || failed)
        return bench_fail(error, "cannot write %s: %s", path, strerror(errno));
    return 0;
}
