// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/coc.h"
#include "tools/cli/dump.h"
#include "tools/cli/explain.h"
#include "tools/cli/focus.h"
#include "tools/cli/guessed.h"
#include "tools/cli/lamps.h"
#include "tools/cli/room.h"
#include "tools/cli/surfaces.h"
#include "tools/cli/target.h"
#include "tools/cli/views.h"
#include "tools/cli/window.h"
#include "tools/io/depth_edges.h"
#include "tools/common/luminance.h"
#include "tools/common/machine.h"
#include "hyperfocal/inspect.h"

static void keep_warning(struct cli_session *session, const char *message)
{
    char *said = NULL;
    session->warnings++;
    if (asprintf(&said, "%s%s\n", session->said ? session->said : "", message) < 0)
        return;
    free(session->said);
    session->said = said;
}

// The library logs the reason before it returns an error. That sentence is the one to show.
static void on_log(void *cookie, const struct hf_message *message)
{
    struct cli_session *session = cookie;
    char buf[TOOL_SENTENCE];
    const char *sentence = tool_sentence(&cli_program, message, buf);
    if (message->level == HF_LOG_ERROR)
        tool_fail(&session->log, 0, "%s", sentence);
    else if (message->level == HF_LOG_WARNING)
        keep_warning(session, sentence);
    if (message->level == HF_LOG_WARNING)
        tool_print_line("%s%s%s", session->label ? session->label : "", session->label ? ": " : "", sentence);
}

const char *const cli_stage_names[CLI_STAGES] = {"read", "decode", "defocus", "encode", "write"};

void cli_session_close(struct cli_session *session)
{
    hf_close(&session->context);
    free(session->said);
    session->said = NULL;
    hf_io_threads_close(&session->run);
}

int cli_session_open(struct cli_session *session, const struct cli_args *args, int threads, struct tool_error *error)
{
    *session = (struct cli_session){.base = cli_room_resident()};
    if (!hf_isa_available(args->isa))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--isa %s cannot be used: this processor or this build lacks it",
                         hf_isa_name(args->isa));
    const struct hf_config config = {
        .size = sizeof config, .threads = threads, .isa = args->isa, .log = on_log, .log_cookie = session};
    const int status = hf_open(&session->context, &config);
    // Without these threads this thread reads and writes the files.
    if (status == HF_OK)
        hf_io_threads_open(&session->run, hf_context_threads(session->context));
    if (status == HF_OK)
        return 0;
    const char *why = session->log.text[0] ? session->log.text : hf_error_string(status);
    // HF_ISA_AUTO fails only if the environment variable names an instruction set that is missing.
    if (status == HF_ERR_ISA && args->isa == HF_ISA_AUTO)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s", why);
    return tool_fail(error, status == HF_ERR_MEMORY || status == HF_ERR_THREAD ? CLI_ALL_FAILED : CLI_BAD_ARGUMENTS,
                     "--threads %d, --isa %s: %s", args->threads, hf_isa_name(args->isa), why);
}

// A file could not be opened. Is the reason the layer that --layer names?
static int lacks_layer(const struct cli_args *args)
{
    struct hf_io_file *file;
    if (!args->layer || hf_io_open(&file, args->input, &(struct hf_io_choice){NULL, "all"}, NULL))
        return 0;
    hf_io_close(&file);
    return 1;
}

int cli_frame_open(struct cli_frame *frame, const struct cli_args *args, const struct hf_io_run *run,
                   struct tool_error *error)
{
    struct hf_io_error io;
    *frame = (struct cli_frame){.args = args, .run = run};
    const double start = tool_now_ms();
    // With --depth-file, --depth-channel names a channel of that file.
    const struct hf_io_choice choice = {args->depth_file ? NULL : args->depth_channel, args->layer};
    if (hf_io_open(&frame->file, args->input, &choice, &io))
        return tool_fail(error, lacks_layer(args) ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED, "%s", io.message);
    frame->ms[CLI_READ] += tool_now_ms() - start;
    frame->in_place = args->output && cli_is_in_place(args);
    int status = cli_select_views(frame, error);
    if (!status)
        status = cli_surfaces_find(frame, error);
    return status ? status : cli_check_single(frame, error);
}

static int new_plane(const struct cli_view *v, float **plane, struct tool_error *error)
{
    *plane = hf_io_alloc((size_t)v->view->width * (size_t)v->view->height * sizeof(float));
    return *plane ? 0
                  : tool_fail(error, CLI_ALL_FAILED, "%s: out of memory for %d x %d pixels", v->label, v->view->width,
                              v->view->height);
}

static int read_depth_file(const struct cli_args *args, const struct hf_io_run *run, struct cli_view *v,
                           struct tool_error *error)
{
    struct hf_io_error io;
    struct hf_io_map map;
    if (hf_io_read_depth_file(args->depth_file, args->depth_channel, args->depth_edges, v->view, run, v->depth, &map,
                              &io))
        return tool_fail(error, CLI_ALL_FAILED, "%s", io.message);
    const int scaled = map.width != v->view->width || map.height != v->view->height;
    v->map_size[0] = scaled ? map.width : 0;
    v->map_size[1] = scaled ? map.height : 0;
    v->scaled_to[0] = v->view->width;
    v->scaled_to[1] = v->view->height;
    v->map_bits = map.bits;
    v->sharpened = map.sharpened;
    v->smoothed = map.smoothed;
    if (map.bits && args->depth_type == HF_DEPTH_INVERSE && isnan(args->near_plane) && isnan(args->depth_scale))
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s: whole numbers of %d bits count as 0 to 1, so --depth-type inverse needs --near, the "
                         "distance of what is white, or --depth-scale",
                         args->depth_file, map.bits);
    return 0;
}

// Read some rows of the depth in INPUT itself.
static int sharpen(const struct cli_args *args, const struct hf_io_run *run, struct cli_view *v, float *depth,
                   int height, struct tool_error *error)
{
    if (args->depth_file || args->depth_edges != HF_IO_EDGES_SHARPEN)
        return 0;
    if (hf_io_sharpen_depth(depth, v->view->width, height, run, &v->sharpened))
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    return 0;
}

// --blur: the depth becomes radii.
static int blur_without_scale(const struct cli_args *args, struct cli_view *v, struct tool_error *error)
{
    const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
    const int centre = args->focus_by == CLI_FOCUS_CENTER;
    const int x = centre ? display->x0 + (display->x1 - display->x0) / 2 : args->focus_x;
    const int y = centre ? display->y0 + (display->y1 - display->y0) / 2 : args->focus_y;
    const int size[2] = {v->view->width, v->view->height}, at[2] = {x - data->x0, y - data->y0};
    if (!cli_depth_blur(args, v->depth, size, at, v->map_bits != 0))
        return 0;
    return tool_fail(error, CLI_BAD_ARGUMENTS,
                     "%s: %s is pixel %d,%d, which is outside the data window %d,%d to %d,%d, or has no depth",
                     v->label, centre ? "--focus center" : "--focus-at", x, y, data->x0, data->y0, data->x1 - 1,
                     data->y1 - 1);
}

int cli_view_prepare(struct cli_frame *frame, struct cli_view *v, struct tool_error *error)
{
    const int status = sharpen(frame->args, frame->run, v, v->depth, v->view->height, error);
    if (!status)
        cli_depth_prepare(frame->args, v->depth, (size_t)v->view->width * (size_t)v->view->height, &v->found);
    return status;
}

static int read_files(struct cli_frame *frame, const struct hf_io_want *wants, int count, struct tool_error *error)
{
    const struct cli_args *args = frame->args;
    struct hf_io_error io;
    const double start = tool_now_ms();
    if (hf_io_fetch(frame->file, wants, count, &io))
        return tool_fail(error, CLI_ALL_FAILED, "%s", io.message);
    const double fetched = tool_now_ms();
    if (hf_io_decode(frame->file, wants, count, frame->run, &io))
        return tool_fail(error, CLI_ALL_FAILED, "%s", io.message);
    for (int i = 0; i < frame->view_count && args->depth_file; i++) {
        const int status = read_depth_file(args, frame->run, &frame->views[i], error);
        if (status)
            return status;
    }
    for (int i = 0; i < frame->view_count; i++) {
        struct cli_view *v = &frame->views[i];
        const int status = cli_view_prepare(frame, v, error);
        if (status)
            return status;
        if (!isnan(args->blur) && blur_without_scale(args, v, error))
            return CLI_BAD_ARGUMENTS;
    }
    const int status = cli_surfaces_load(frame, error);
    frame->ms[CLI_READ] += fetched - start;
    frame->ms[CLI_DECODE] += tool_now_ms() - fetched;
    return status;
}

int cli_view_want(struct cli_view *v, int depth, struct hf_io_want *want, struct tool_error *error)
{
    int status = 0;
    want->view = v->index;
    for (int c = 0; c < 4 && !status; c++)
        if (c < 3 || v->view->colour[3][0])
            status = new_plane(v, &v->planes[c], error);
    if (!status)
        status = new_plane(v, &v->depth, error);
    memcpy(want->planes, v->planes, sizeof(v->planes));
    want->depth = depth ? v->depth : NULL;
    return status;
}

int cli_frame_load(struct cli_frame *frame, struct tool_error *error)
{
    if (frame->loaded)
        return 0;
    struct hf_io_want *wants = calloc((size_t)(frame->view_count + cli_surfaces_inside(frame)), sizeof(*wants));
    int count = 0, status = wants ? 0 : tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", frame->args->input);
    for (int i = 0; i < frame->view_count && !status; i++) {
        struct cli_view *v = &frame->views[i];
        status = cli_view_want(v, !frame->args->depth_file, &wants[count++], error);
        for (int k = 0; k < v->surface_count && !status; k++)
            if (!v->surfaces[k].file)
                status = cli_view_want(&v->surfaces[k], 1, &wants[count++], error);
    }
    if (!status)
        status = read_files(frame, wants, count, error);
    free(wants);
    frame->loaded = !status;
    return status;
}

// The depth of what several pictures show together, in place of the view's own.
static int read_shown(struct cli_frame *frame, struct cli_view *v, struct tool_error *error)
{
    free(v->depth);
    v->depth = NULL;
    const int status = cli_frame_load(frame, error);
    float *shown = status ? NULL : cli_surfaces_depth(frame, v);
    if (!status && !shown)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    if (shown) {
        free(v->depth);
        v->depth = shown;
    }
    return status;
}

// Read the rows around the pixel to focus on: its own, and `around` beside it; of an object all rows.
static int read_focus_rows(struct cli_frame *frame, struct cli_view *v, int around, struct tool_error *error)
{
    struct hf_io_error io;
    const struct cli_args *args = frame->args;
    const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
    const int at = args->focus_by == CLI_FOCUS_AT ? args->focus_y : display->y0 + (display->y1 - display->y0) / 2;
    const int reach = around + (args->depth_edges == HF_IO_EDGES_SHARPEN ? HF_IO_EDGE_REACH : 0);
    const int all = args->depth_file || args->focus_by == CLI_FOCUS_OBJECT;
    const int from = all || at - reach < data->y0 ? data->y0 : at - reach;
    const int to = all || at + reach + 1 > data->y1 ? data->y1 : at + reach + 1;
    int status = 0;
    if (v->surface_count)
        return read_shown(frame, v, error);
    if (args->depth_file)
        status = read_depth_file(args, frame->run, v, error);
    else if (from < to && hf_io_read_depth_rows(frame->file, v->index, from - data->y0, to - from, v->depth, &io))
        status = tool_fail(error, CLI_ALL_FAILED, "%s", io.message);
    if (status || from >= to)
        return status;
    float *rows = v->depth + (size_t)(from - data->y0) * (size_t)v->view->width;
    status = sharpen(args, frame->run, v, rows, to - from, error);
    if (!status)
        cli_depth_prepare(args, rows, (size_t)(to - from) * (size_t)v->view->width, &v->found);
    return status;
}

int cli_frame_focus(struct cli_frame *frame, float *focus, struct tool_error *error)
{
    struct cli_view *v = &frame->views[0];
    struct cli_args args = *frame->args;
    int status = 0;
    if (cli_focus_needs_depth(&args)) {
        status = new_plane(v, &v->depth, error);
        // The samples next to it replace one that is NaN.
        if (!status)
            status = read_focus_rows(frame, v, 1, error);
        if (!status && args.focus_by == CLI_FOCUS_OBJECT)
            status = cli_focus_object(&args, frame, v, error);
    }
    if (!status)
        status = cli_setup_view(&v->setup, &args, v->view, v->depth, v->label, error);
    if (!status)
        *focus = v->setup.params.focus;
    return status;
}

int cli_frame_around(struct cli_frame *frame, struct cli_around *around, struct tool_error *error)
{
    struct cli_view *v = &frame->views[0];
    int status = new_plane(v, &v->depth, error);
    if (!status)
        status = read_focus_rows(frame, v, CLI_AROUND, error);
    if (!status)
        cli_focus_around(around, frame->args, v, frame->args->focus_x, frame->args->focus_y);
    return status;
}

// If the focus is read from the picture, all views take that of the first view: what one eye sees sharp, the other has
// to see sharp too.
static void share_focus(struct cli_frame *frame, struct cli_args *args)
{
    const struct cli_setup *first = &frame->views[0].setup;
    if (!cli_focus_needs_depth(frame->args) || frame->args->focus_per_view)
        return;
    args->focus_by = CLI_FOCUS_DISTANCE;
    args->focus = first->params.focus;
    args->focus_from = first->focus_from;
}

static int set_up(struct cli_frame *frame, struct tool_error *error)
{
    struct cli_args args = *frame->args;
    int status = cli_focus_needs_depth(&args) ? cli_frame_load(frame, error) : 0;
    for (int i = 0; i < frame->view_count && !status; i++) {
        struct cli_view *v = &frame->views[i];
        struct cli_args own = args;
        if (own.focus_by == CLI_FOCUS_OBJECT)
            status = cli_focus_object(&own, frame, v, error);
        float *shown = NULL;
        if (!status && v->surface_count && cli_focus_needs_depth(&own) && !(shown = cli_surfaces_depth(frame, v)))
            status = tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
        if (!status)
            status = cli_setup_view(&v->setup, &own, v->view, shown ? shown : v->depth, v->label, error);
        free(shown);
        if (!status && i == 0)
            share_focus(frame, &args);
    }
    return status;
}

int cli_frame_setup(struct cli_frame *frame, struct tool_error *error)
{
    // Further pictures may enlarge the windows.
    int status = frame->views[0].surface_count ? cli_frame_load(frame, error) : 0;
    if (!status)
        status = set_up(frame, error);
    // --grow needs the pixels to know how far blur reaches. Growing moves coordinates, so the views are set up again.
    if (!status && frame->args->grow) {
        status = cli_frame_load(frame, error);
        if (!status)
            status = cli_window_grow(frame, error);
        if (!status)
            status = set_up(frame, error);
    }
    return status;
}

// Is alpha 1 everywhere? Then its blur is 1 too, and the engines need not compute it: a quarter less work.
static int is_opaque(const struct cli_view *v)
{
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    size_t i = 0;
    while (i < n && v->planes[3] && v->planes[3][i] == 1)
        i++;
    return i == n;
}

struct hf_image cli_view_image(const struct cli_view *v, int keep_alpha)
{
    struct hf_image image = {
        .size = sizeof(image), .width = v->view->width, .height = v->view->height, .format = HF_FORMAT_PLANAR32F};
    const int channels = !keep_alpha && is_opaque(v) ? 3 : 4;
    for (int c = 0; c < channels; c++) {
        image.data[c] = v->planes[c];
        image.stride[c] = (ptrdiff_t)v->view->width * (ptrdiff_t)sizeof(float);
    }
    return image;
}

// What is in focus may be in a further picture of the scene.
static int look_further(const struct cli_args *args, struct cli_view *v, struct tool_error *error)
{
    int status = 0;
    for (int k = 0; k < v->surface_count && !status; k++) {
        struct cli_view *s = &v->surfaces[k];
        struct cli_view as = *v;
        as.radii = NULL;
        as.setup.depth.data = s->depth;
        status = cli_coc_look(&as, args, error);
        v->least_radius = fminf(v->least_radius, as.least_radius);
        free(as.radii);
    }
    return status;
}

// Load all that is needed to render a view; *image becomes its colour.
static int load_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, struct hf_image *image,
                     struct tool_error *error)
{
    const int status = cli_frame_load(frame, error);
    if (status)
        return status;
    // --dump-passes shows all channels, so alpha is kept.
    *image = cli_view_image(v, frame->args->dump_dir != NULL);
    v->setup.depth.data = v->depth;
    session->label = v->label;
    session->log.text[0] = '\0';
    session->warnings = 0;
    free(session->said);
    session->said = NULL;
    const int looked = cli_coc_look(v, frame->args, error);
    v->cut = !looked && v->radii ? cli_window_cut(v) : 0;
    return looked ? looked : look_further(frame->args, v, error);
}

// Call after the library rendered or planned the view: report its error, or keep its report.
static int finish_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, int status,
                       struct tool_error *error)
{
    if (status != HF_OK) {
        hf_inspect_dump(session->context, NULL, NULL);
        return tool_fail(error, status == HF_ERR_ARG ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED, "%s: %s", v->label,
                         session->log.text[0] ? session->log.text : hf_error_string(status));
    }
    tool_report_get(session->context, &v->report);
    v->warned = session->warnings;
    free(v->said);
    v->said = session->said;
    session->said = NULL;
    cli_coc_measure(v);
    free(v->depth);
    v->depth = NULL;
    const struct cli_args *args = frame->args;
    return args->explain || args->explain_image || args->json ? cli_explain_keep(v, session->context, error) : 0;
}

static int render_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session,
                       struct tool_error *error)
{
    struct hf_image image;
    struct cli_dump dump;
    int status = load_view(frame, v, session, &image, error);
    if (status)
        return status;
    if (frame->args->dump_dir)
        cli_dump_begin(&dump, session->context, frame, v);
    hf_inspect_colour(session->context, frame->args->explain);
    const double start = tool_now_ms();
    struct cli_lamps lamps;
    struct hf_params params = v->setup.params;
    params.highlight.gain = 1;
    status = frame->args->guessed ? cli_guessed_find(session, frame, v, &image, error) : 0;
    if (status)
        return status;
    status = cli_lamps_raise(&lamps, v, error);
    if (status) {
        cli_lamps_free(&lamps);
        return status;
    }
    status = v->view->deep      ? cli_deep_render(session->context, frame, v, &image, &params)
             : v->surface_count ? cli_surfaces_render(session->context, frame->args, v, &image, &params)
                                : hf_render(session->context, &image, &image, &v->setup.depth, &params);
    if (status == HF_OK)
        cli_lamps_lower(&lamps, v);
    cli_lamps_free(&lamps);
    frame->ms[CLI_DEFOCUS] += tool_now_ms() - start;
    status = finish_view(frame, v, session, status, error);
    return !status && frame->args->dump_dir ? cli_dump_end(&dump, session->context, &image, error) : status;
}

static int plan_view(struct cli_frame *frame, struct cli_view *v, struct cli_session *session, struct tool_error *error)
{
    struct hf_image image;
    int status = load_view(frame, v, session, &image, error);
    if (status)
        return status;
    hf_inspect_colour(session->context, frame->args->explain);
    struct cli_lamps lamps;
    status = cli_lamps_raise(&lamps, v, error);
    cli_lamps_free(&lamps);
    if (status)
        return status;
    struct hf_params params = v->setup.params;
    params.highlight.gain = 1;
    status = hf_plan(session->context, &image, &image, &v->setup.depth, &params, NULL);
    return finish_view(frame, v, session, status, error);
}

typedef int view_step(struct cli_frame *frame, struct cli_view *v, struct cli_session *session,
                      struct tool_error *error);

static int each_view(struct cli_frame *frame, struct cli_session *session, view_step *step, struct tool_error *error)
{
    for (int i = 0; i < frame->view_count; i++) {
        const int status = step(frame, &frame->views[i], session, error);
        if (status)
            return status;
    }
    return 0;
}

int cli_frame_plan(struct cli_frame *frame, struct cli_session *session, struct tool_error *error)
{
    return each_view(frame, session, plan_view, error);
}

int cli_frame_render(struct cli_frame *frame, struct cli_session *session, struct tool_error *error)
{
    return each_view(frame, session, render_view, error);
}

int cli_frame_encode(struct cli_frame *frame, const struct hf_io_text *texts, int text_count, struct tool_error *error)
{
    struct hf_io_error io;
    struct hf_io_result *results = calloc((size_t)frame->view_count, sizeof(*results));
    if (!results)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", frame->args->output);
    for (int i = 0; i < frame->view_count; i++) {
        results[i].view = frame->views[i].index;
        for (int c = 0; c < 4; c++)
            results[i].planes[c] = frame->views[i].planes[c];
        results[i].guessed = frame->args->guessed == CLI_GUESSED_CHANNEL ? frame->views[i].guesses : NULL;
    }
    const double start = tool_now_ms();
    const struct hf_io_job job = {.path = frame->args->output,
                                  .results = results,
                                  .result_count = frame->view_count,
                                  .compression = frame->args->compression,
                                  .zip_level = frame->args->zip_level,
                                  .texts = texts,
                                  .text_count = text_count,
                                  .run = frame->run};
    const int status = hf_io_encode(&frame->output, frame->file, &job, &frame->written, &io);
    frame->ms[CLI_ENCODE] += tool_now_ms() - start;
    free(results);
    return status ? tool_fail(error, CLI_ALL_FAILED, "%s", io.message) : 0;
}

int cli_frame_save(struct cli_frame *frame, struct tool_error *error)
{
    struct hf_io_error io;
    const double start = tool_now_ms();
    const int status = hf_io_save(frame->output, &frame->written, &io);
    frame->ms[CLI_WRITE] += tool_now_ms() - start;
    return status ? tool_fail(error, CLI_ALL_FAILED, "%s", io.message) : 0;
}

void cli_view_free(struct cli_view *v)
{
    for (int c = 0; c < 4; c++)
        free(v->planes[c]);
    free(v->depth);
    free(v->label);
    free(v->tag);
    free(v->radii);
    free(v->guesses);
    free(v->tiles);
    free(v->said);
}

void cli_frame_close(struct cli_frame *frame)
{
    for (int i = 0; i < frame->view_count; i++)
        cli_view_free(&frame->views[i]);
    cli_surfaces_close(frame);
    free(frame->views);
    hf_io_output_free(&frame->output);
    hf_io_close(&frame->file);
    *frame = (struct cli_frame){0};
}
