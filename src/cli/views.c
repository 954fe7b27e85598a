// SPDX-License-Identifier: BSD-3-Clause
#include "cli/views.h"

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
        const size_t used = strlen(buf);
        snprintf(buf + used, size - used, "%s%s", i ? ", " : "", name[0] ? name : "one without a name");
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

// Every name of --views must be one of the file's.
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
            char names[1024];
            list_views(frame->file, names, sizeof(names));
            return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --views names '%.*s', but the views are: %s",
                             frame->args->input, (int)n, c, names);
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
        char channels[2048];
        const char *wanted = frame->args->depth_channel;
        hf_io_channels(frame->file, channels, sizeof(channels));
        return tool_fail(error, CLI_ALL_FAILED, "%s: there is no depth channel%s%s%s, the channels are: %s", v->label,
                         wanted ? " '" : "", wanted ? wanted : "", wanted ? "'" : "", channels);
    }
    if (check_window(&view->data_window, "data window", v->label, error) ||
        check_window(&view->display_window, "display window", v->label, error))
        return CLI_ALL_FAILED;
    if (!(view->pixel_aspect >= 0.1f && view->pixel_aspect <= 10))
        return tool_fail(error, CLI_ALL_FAILED, "%s: the pixelAspectRatio is %g, but 0.1 to 10 can be worked with",
                         v->label, view->pixel_aspect);
    return 0;
}

static char *make_label(const struct cli_frame *frame, const char *view_name)
{
    char *label;
    const int several = hf_io_view_count(frame->file) > 1 && view_name[0];
    return asprintf(&label, "%s%s%s", frame->args->input, several ? ", view " : "", several ? view_name : "") < 0
               ? NULL
               : label;
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
        struct cli_view *v = &frame->views[frame->view_count++];
        v->index = i;
        v->view = view;
        v->label = make_label(frame, view->name);
        if (!v->label)
            return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
        const int status = check_view(v, frame, error);
        if (status)
            return status;
    }
    if (!frame->views)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
    if (frame->view_count == 0)
        return tool_fail(error, CLI_ALL_FAILED, "%s: there are no colour channels", args->input);
    if (frame->view_count > 1 && args->output && !cli_is_exr(args->output)) {
        char names[1024];
        list_views(frame->file, names, sizeof(names));
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s can hold one view only, choose one of %s's with --views: %s",
                         args->output, args->input, names);
    }
    return 0;
}
