// SPDX-License-Identifier: BSD-3-Clause
#include "subject.h"

#include <stdlib.h>
#include <string.h>

// Keep the sentence of the last error, which names the argument; hf_error_string names only the kind of error.
static void keep_message(void *cookie, const struct hf_message *message)
{
    if (message->level == HF_LOG_ERROR)
        snprintf(((struct tool_error *)cookie)->text, sizeof((struct tool_error *)cookie)->text, "%s",
                 message->sentence);
}

int bench_subject_open(struct bench_subject *s, const struct bench_args *args, const struct bench_scene *scene,
                       struct tool_error *log, struct tool_error *error)
{
    const struct hf_config config = {
        .size = sizeof config, .threads = args->threads, .isa = args->isa, .log = keep_message, .log_cookie = log};
    const int err = hf_open(&s->context, &config);
    if (err)
        return tool_fail(error, -1, "%s", *log->text ? log->text : hf_error_string(err));
    s->params = args->params;
    s->depth = (struct hf_depth){
        .size = sizeof(struct hf_depth), .data = scene->depth, .stride = scene->width * (ptrdiff_t)sizeof(float)};
    s->scratch = calloc((size_t)scene->width * (size_t)scene->height, sizeof(float));
    if (!s->scratch || bench_image_alloc(&s->in, scene->width, scene->height, args->in) ||
        bench_image_alloc(&s->out, scene->width, scene->height, args->out))
        return tool_fail(error, -1, "there is not enough memory for pictures of %dx%d", scene->width, scene->height);
    if (bench_workers_open(&s->workers, hf_context_threads(s->context)))
        return tool_fail(error, -1, "%d threads could not be started", hf_context_threads(s->context));
    bench_image_pack(&s->in, scene->rgb);
    return 0;
}

void bench_subject_lens(struct bench_subject *s, const struct bench_camera *camera)
{
    struct hf_params *p = &s->params;
    p->model = HF_MODEL_LENS;
    p->focus = camera->focus;
    p->lens.f_number = camera->f_number;
    p->lens.focal_length_mm = camera->focal_length_mm;
    p->lens.sensor_width_mm = camera->sensor_width_mm > 0 ? camera->sensor_width_mm : 36;
}

void bench_subject_close(struct bench_subject *s)
{
    bench_workers_close(&s->workers);
    bench_image_free(&s->out);
    bench_image_free(&s->in);
    free(s->scratch);
    hf_close(&s->context);
}
