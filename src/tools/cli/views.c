// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/views.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SIZE = 65536 };  // of hf_image

// Names of all views, for messages: "left, right".
static void list_views(const struct hf_io_file *file, char *buf, size_t size)
{
    buf[0] = '\0';
    for (int i = 0; i < hf_io_view_count(file); i++) {
        const char *name = hf_io_view(file, i)->name;
        int again = 0;  // in another layer
        for (int k = 0; k < i; k++)
            again |= !strcmp(name, hf_io_view(file, k)->name);
        if (!again)
            hf_io_list(buf, size, NULL, name[0] ? name : "one without a name", "");
    }
}

static int has_word(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (const char *c = list;; c++) {
        const size_t n = strcspn(c, ",");
        if (n == length && !memcmp(c, word, n))
            return 1;
        c += n;
        if (!*c)
            return 0;
    }
}

// Check that each name in --views is a view of the file.
static int check_names(const struct cli_frame *frame, struct tool_error *error)
{
    const char *list = frame->args->views;
    for (const char *c = list; c; c = strchr(c, ',') ? strchr(c, ',') + 1 : NULL) {
        const size_t n = strcspn(c, ",");
        int found = 0;
        for (int i = 0; i < hf_io_view_count(frame->file); i++) {
            const char *name = hf_io_view(frame->file, i)->name;
            found |= n > 0 && n == strlen(name) && !memcmp(c, name, n);
        }
        if (!found) {
            char names[1024], wanted[256], nearest[256], meant[300] = "";
            list_views(frame->file, names, sizeof(names));
            snprintf(wanted, sizeof(wanted), "%.*s", (int)n, c);
            if (hf_io_nearest(names, wanted, nearest))
                snprintf(meant, sizeof(meant), " (did you mean %s?)", nearest);
            return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --views names '%s'%s, but the views are: %s",
                             frame->args->input, wanted, meant, names);
        }
    }
    return 0;
}

static int check_window(const struct hf_io_box *box, const char *name, const char *label, struct tool_error *error)
{
    const int64_t width = (int64_t)box->x1 - box->x0, height = (int64_t)box->y1 - box->y0;
    if (width < 1 || height < 1 || width > MAX_SIZE || height > MAX_SIZE)
        return tool_fail(error, CLI_ALL_FAILED,
                         "%s: the %s is %lld x %lld, but 1 to %d pixels each way can be "
                         "worked with",
                         label, name, (long long)width, (long long)height, (int)MAX_SIZE);
    return 0;
}

static int check_view(const struct cli_view *v, const struct cli_frame *frame, struct tool_error *error)
{
    const struct hf_io_view *view = v->view;
    if (view->depth_part < 0 && !frame->args->depth_file) {
        char channels[2048], nearest[256], meant[300] = "";
        const char *wanted = frame->args->depth_channel;
        hf_io_channels(frame->file, channels, sizeof(channels));
        if (wanted && hf_io_nearest(channels, wanted, nearest))
            snprintf(meant, sizeof(meant), " (did you mean %s?)", nearest);
        return tool_fail(error, wanted ? CLI_BAD_ARGUMENTS : CLI_ALL_FAILED,
                         "%s: there is no depth channel%s%s%s%s%s, the channels are: %s", v->label, wanted ? " '" : "",
                         wanted ? wanted : "", wanted ? "'" : "", meant,
                         wanted ? "" : " (give one with --depth-channel or --depth-file)", channels);
    }
    const struct cli_args *args = frame->args;
    const char *alone = args->depth_file                  ? "--depth-file"
                        : !isnan(args->blur)              ? "--blur"
                        : args->grow                      ? "--grow"
                        : args->params.highlight.gain > 1 ? "--highlight-gain"
                        : args->focus_object              ? "--focus-object"
                        : args->merge                     ? "--merge"
                                                          : args->other_option;
    if (view->deep && alone)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: %s is for flat pictures, this one is deep", v->label, alone);
    if (check_window(&view->data_window, "data window", v->label, error) ||
        check_window(&view->display_window, "display window", v->label, error))
        return CLI_ALL_FAILED;
    if (!(view->pixel_aspect >= 0.1f && view->pixel_aspect <= 10))
        return tool_fail(error, CLI_ALL_FAILED, "%s: the pixelAspectRatio is %g, but only 0.1 to 10 is supported",
                         v->label, view->pixel_aspect);
    return 0;
}

// 1 if two views of the file differ in their names, or in their layers.
static int differ(const struct hf_io_file *file, int by_layer)
{
    const struct hf_io_view *first = hf_io_view(file, 0);
    for (int i = 1; i < hf_io_view_count(file); i++) {
        const struct hf_io_view *v = hf_io_view(file, i);
        if (by_layer ? strcmp(v->layer, first->layer) : strcmp(v->name, first->name))
            return 1;
    }
    return 0;
}

static int name_view(const struct cli_frame *frame, struct cli_view *v)
{
    const char *name = differ(frame->file, 0) ? v->view->name : "";
    const char *layer = !differ(frame->file, 1) ? "" : v->view->layer[0] ? v->view->layer : "RGB";
    if (asprintf(&v->tag, "%s%s%s", name, name[0] && layer[0] ? "." : "", layer) < 0)
        v->tag = NULL;
    if (asprintf(&v->label, "%s%s%s%s%s", frame->args->input, name[0] ? ", view " : "", name,
                 layer[0] ? ", layer " : "", layer) < 0)
        v->label = NULL;
    return v->tag && v->label ? 0 : -1;
}

// --display: declare the picture a crop of a larger frame, and check that it lies inside.
static int set_display(const struct cli_frame *frame, int i, struct tool_error *error)
{
    const int *d = frame->args->display;
    const struct hf_io_view *v = hf_io_view(frame->file, i);
    const struct hf_io_box *data = &v->data_window;
    if (!d[0])
        return 0;
    const int x = d[2] == CLI_CENTRED ? (d[0] - v->width) / 2 : d[2];
    const int y = d[3] == CLI_CENTRED ? (d[1] - v->height) / 2 : d[3];
    if (d[0] < v->width || d[1] < v->height || x < 0 || y < 0 || x > d[0] - v->width || y > d[1] - v->height)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --display %dx%d does not hold the picture, %d x %d%s",
                         frame->args->input, d[0], d[1], v->width, v->height,
                         d[2] == CLI_CENTRED ? "" : ", at the place given");
    hf_io_set_display(frame->file, i,
                      (struct hf_io_box){data->x0 - x, data->y0 - y, data->x0 - x + d[0], data->y0 - y + d[1]});
    return 0;
}

int cli_select_views(struct cli_frame *frame, struct tool_error *error)
{
    const struct cli_args *args = frame->args;
    const int count = hf_io_view_count(frame->file);
    if (check_names(frame, error))
        return CLI_BAD_ARGUMENTS;
    frame->views = calloc((size_t)count + 1, sizeof(*frame->views));
    for (int i = 0; i < count && frame->views; i++) {
        const struct hf_io_view *view = hf_io_view(frame->file, i);
        if (args->views && !has_word(args->views, view->name))
            continue;
        // With --layer all, a layer without a depth stays as it is.
        if (args->layer && !strcmp(args->layer, "all") && view->depth_part < 0 && !args->depth_file && count > 1) {
            tool_print_line("%s: layer %s has no depth of its own and stays as it is", args->input,
                            view->layer[0] ? view->layer : "RGB");
            continue;
        }
        struct cli_view *v = &frame->views[frame->view_count++];
        v->index = i;
        v->view = view;
        if (name_view(frame, v))
            return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
        const int status = check_view(v, frame, error);
        if (status || set_display(frame, i, error))
            return status ? status : CLI_BAD_ARGUMENTS;
    }
    if (!frame->views)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
    if (frame->view_count == 0)
        return tool_fail(error, CLI_ALL_FAILED, "%s: there are no colour channels", args->input);
    return 0;
}

int cli_check_single(const struct cli_frame *frame, struct tool_error *error)
{
    const struct cli_args *args = frame->args;
    if (frame->view_count > 1 && args->output && !cli_is_exr(args->output)) {
        char names[1024] = "";
        for (int i = 0; i < frame->view_count; i++)
            hf_io_list(names, sizeof(names), NULL, frame->views[i].tag, "");
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s can hold one picture only, choose one of %s's with %s: %s",
                         args->output, args->input, differ(frame->file, 1) ? "--layer" : "--views", names);
    }
    return 0;
}
