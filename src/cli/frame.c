// SPDX-License-Identifier: BSD-3-Clause
#include "cli/frame.h"

#include <stdlib.h>
#include <time.h>

#include "cli/dump.h"
#include "cli/explain.h"
#include "cli/views.h"

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

// The library says why before it returns an error; that is the sentence to show.
static void on_log(void *cookie, enum hf_log_level level, const char *message)
{
    struct cli_session *session = cookie;
    if (level == HF_LOG_ERROR)
        cli_fail(&session->log, 0, "%s", message);
    else if (level == HF_LOG_WARNING)
        cli_print_line("%s%s%s", session->label ? session->label : "", session->label ? ": " : "", message);
}

int cli_session_open(struct cli_session *session, const struct cli_args *args, struct cli_error *error)
{
    char isa[32];
    cli_choice_name("isa", (int)args->isa, isa, sizeof(isa));
    *session = (struct cli_session){0};
    if (!hf_isa_available(args->isa))
        return cli_fail(error, CLI_BAD_ARGUMENTS, "--isa %s cannot be used: this processor or this build lacks it",
                        isa);
    const struct hf_config config = {.threads = args->threads, .isa = args->isa, .log = on_log, .log_cookie = session};
    const int status = hf_open(&session->context, &config);
    if (status == HF_OK)
        return 0;
    const char *why = session->log.text[0] ? session->log.text : hf_error_string(status);
    // AUTO is only unavailable when the environment variable says so.
    const char *variable = getenv("HYPERFOCAL_ISA");
    if (status == HF_ERR_ISA && args->isa == HF_ISA_AUTO && variable)
        return cli_fail(error, CLI_BAD_ARGUMENTS, "HYPERFOCAL_ISA=%s: %s", variable, why);
    return cli_fail(error, status == HF_ERR_MEMORY || status == HF_ERR_THREAD ? CLI_ALL_FAILED : CLI_BAD_ARGUMENTS,
                    "--threads %d, --isa %s: %s", args->threads, isa, why);
}

int cli_frame_open(struct cli_frame *frame, const struct cli_args *args, struct cli_error *error)
{
    struct hf_io_error io;
    *frame = (struct cli_frame){.args = args};
    const double start = now_ms();
    // With a depth file the channel's name is meant for that one.
    if (hf_io_open(&frame->file, args->input, args->depth_file ? NULL : args->depth_channel, &io))
        return cli_fail(error, CLI_ALL_FAILED, "%s", io.message);
    frame->read_ms += now_ms() - start;
    return cli_select_views(frame, error);
}

static size_t pixel_count(const struct hf_io_view *view)
{
    return (size_t)view->width * (size_t)view->height;
}

static float *new_plane(const struct cli_view *v, struct cli_error *error)
{
    float *plane = malloc(pixel_count(v->view) * sizeof(float));
    if (!plane)
        cli_fail(error, CLI_ALL_FAILED, "%s: out of memory for %d x %d pixels", v->label, v->view->width,
                 v->view->height);
    return plane;
}

static int read_depth(struct cli_frame *frame, struct cli_view *v, struct cli_error *error)
{
    const struct cli_args *args = frame->args;
    struct hf_io_error io;
    v->depth = new_plane(v, error);
    if (!v->depth)
        return CLI_ALL_FAILED;
    const double start = now_ms();
    if (args->depth_file ? hf_io_read_depth_file(args->depth_file, args->depth_channel, v->view, v->depth, &io)
                         : hf_io_read_depth(frame->file, v->index, v->depth, &io))
        return cli_fail(error, CLI_ALL_FAILED, "%s", io.message);
    frame->read_ms += now_ms() - start;
    return 0;
}

int cli_frame_setup(struct cli_frame *frame, struct cli_error *error)
{
    for (int i = 0; i < frame->view_count; i++) {
        struct cli_view *v = &frame->views[i];
        int status = cli_focus_needs_depth(frame->args) ? read_depth(frame, v, error) : 0;
        if (!status)
            status = cli_setup_view(&v->setup, frame->args, v->view, v->depth, v->label, error);
        if (status)
            return status;
    }
    return 0;
}

static int read_colour(struct cli_frame *frame, struct cli_view *v, struct cli_error *error)
{
    struct hf_io_error io;
    for (int c = 0; c < 4; c++) {
        if (c == 3 && v->view->colour[3][0] == '\0')
            continue;
        v->planes[c] = new_plane(v, error);
        if (!v->planes[c])
            return CLI_ALL_FAILED;
    }
    const double start = now_ms();
    if (hf_io_read_colour(frame->file, v->index, v->planes, &io))
        return cli_fail(error, CLI_ALL_FAILED, "%s", io.message);
    frame->read_ms += now_ms() - start;
    return 0;
}

// All that is needed to render a view; *image is its colour.
static int load_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, struct hf_image *image,
                     struct cli_error *error)
{
    int status = v->depth ? 0 : read_depth(frame, v, error);
    if (!status)
        status = read_colour(frame, v, error);
    if (status)
        return status;
    *image = (struct hf_image){.width = v->view->width, .height = v->view->height, .format = HF_FORMAT_PLANAR32F};
    for (int c = 0; c < 4; c++) {
        image->data[c] = v->planes[c];
        image->stride[c] = (ptrdiff_t)v->view->width * (ptrdiff_t)sizeof(float);
    }
    v->setup.depth.data = v->depth;
    session->label = v->label;
    session->log.text[0] = '\0';
    return 0;
}

// After the library has seen the view: what went wrong, or what to keep.
static int finish_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, int status,
                       struct cli_error *error)
{
    if (status != HF_OK) {
        hf_set_dump(session->context, NULL, NULL);
        return cli_fail(error, status == HF_ERR_ARG ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED, "%s: %s", v->label,
                        session->log.text[0] ? session->log.text : hf_error_string(status));
    }
    hf_get_stats(session->context, &v->stats);
    free(v->depth);
    v->depth = NULL;
    const struct cli_args *args = frame->args;
    return args->explain || args->explain_image || args->json ? cli_explain_keep(v, session->context, error) : 0;
}

static int render_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session,
                       struct cli_error *error)
{
    struct hf_image image;
    struct cli_dump dump;
    int status = load_view(frame, v, session, &image, error);
    if (status)
        return status;
    if (frame->args->dump_dir)
        cli_dump_begin(&dump, session->context, frame, v);
    v->setup.params.colour_stats = frame->args->explain;
    status = hf_render(session->context, &image, &image, &v->setup.depth, &v->setup.params);
    status = finish_view(frame, v, session, status, error);
    return !status && frame->args->dump_dir ? cli_dump_end(&dump, session->context, &image, error) : status;
}

static int plan_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, struct cli_error *error)
{
    struct hf_image image;
    int status = load_view(frame, v, session, &image, error);
    if (status)
        return status;
    v->setup.params.colour_stats = frame->args->explain;
    status = hf_plan(session->context, &image, &image, &v->setup.depth, &v->setup.params, NULL);
    return finish_view(frame, v, session, status, error);
}

typedef int view_step(struct cli_frame *frame, struct cli_view *v, struct cli_session *session,
                      struct cli_error *error);

static int each_view(struct cli_frame *frame, struct cli_session *session, view_step *step, struct cli_error *error)
{
    for (int i = 0; i < frame->view_count; i++) {
        const int status = step(frame, &frame->views[i], session, error);
        if (status)
            return status;
    }
    return 0;
}

int cli_frame_plan(struct cli_frame *frame, struct cli_session *session, struct cli_error *error)
{
    return each_view(frame, session, plan_view, error);
}

int cli_frame_render(struct cli_frame *frame, struct cli_session *session, struct cli_error *error)
{
    return each_view(frame, session, render_view, error);
}

int cli_frame_write(struct cli_frame *frame, struct cli_error *error)
{
    struct hf_io_error io;
    struct hf_io_result *results = calloc((size_t)frame->view_count, sizeof(*results));
    if (!results)
        return cli_fail(error, CLI_ALL_FAILED, "%s: out of memory", frame->args->output);
    for (int i = 0; i < frame->view_count; i++) {
        results[i].view = frame->views[i].index;
        for (int c = 0; c < 4; c++)
            results[i].planes[c] = frame->views[i].planes[c];
    }
    const double start = now_ms();
    const struct hf_io_job job = {.path = frame->args->output,
                                  .results = results,
                                  .result_count = frame->view_count,
                                  .compression = frame->args->compression};
    struct hf_io_written written;
    const int status = hf_io_write(frame->file, &job, &written, &io);
    frame->clamped = written.clamped;
    frame->write_ms += now_ms() - start;
    free(results);
    return status ? cli_fail(error, CLI_ALL_FAILED, "%s", io.message) : 0;
}

void cli_frame_close(struct cli_frame *frame)
{
    for (int i = 0; i < frame->view_count; i++) {
        struct cli_view *v = &frame->views[i];
        for (int c = 0; c < 4; c++)
            free(v->planes[c]);
        free(v->depth);
        free(v->label);
        free(v->tiles);
    }
    free(frame->views);
    hf_io_close(&frame->file);
    *frame = (struct cli_frame){0};
}
