// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/surfaces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hyperfocal/layers.h"
#include "tools/cli/window.h"

static int no_memory(const struct cli_frame *frame, struct tool_error *error)
{
    return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", frame->args->input);
}

const char *cli_surface_name(const struct cli_view *s, char *buf, size_t size)
{
    const char *layer = s->view->layer;
    char name[TOOL_SHOWN];
    if (s->file)
        snprintf(buf, size, "%s%s%s", tool_shown(s->path, name), layer[0] ? ", layer " : "", layer);
    else
        snprintf(buf, size, "layer %s", layer[0] ? layer : "RGB");
    return buf;
}

static struct cli_view *add_surface(struct cli_view *v)
{
    const size_t n = (size_t)v->surface_count;
    struct cli_view *list = realloc(v->surfaces, (n + 1) * sizeof(*list));
    if (!list)
        return NULL;
    v->surfaces = list;
    v->surface_count++;
    memset(&list[n], 0, sizeof(list[n]));
    return &list[n];
}

static int share_depth(const struct cli_view *a, const struct cli_view *b)
{
    return a->view->depth_part == b->view->depth_part && !strcmp(a->view->depth, b->view->depth);
}

static int fail_shared(const struct cli_view *a, const struct cli_view *b, struct tool_error *error)
{
    return tool_fail(error, CLI_ALL_FAILED, "%s: the depth %s is also that of layer %s; layers to merge need one each",
                     b->label, b->view->depth, a->view->layer[0] ? a->view->layer : "RGB");
}

// Make views of one name the pictures of the first of them.
static int merge_views(struct cli_frame *frame, struct tool_error *error)
{
    int count = 0;
    for (int i = 0; i < frame->view_count; i++) {
        struct cli_view *v = &frame->views[i], *first = NULL;
        for (int k = 0; k < count && !first; k++)
            first = strcmp(frame->views[k].view->name, v->view->name) ? NULL : &frame->views[k];
        if (!first) {
            const struct cli_view own = *v;
            memset(v, 0, sizeof(*v));
            frame->views[count++] = own;
            continue;
        }
        int shared = share_depth(first, v) ? 0 : -1;
        for (int k = 0; k < first->surface_count && shared < 0; k++)
            shared = share_depth(&first->surfaces[k], v) ? k + 1 : -1;
        struct cli_view *to = add_surface(first);
        if (!to)
            return no_memory(frame, error);
        *to = *v;
        memset(v, 0, sizeof(*v));
        if (shared >= 0)
            return fail_shared(shared ? &first->surfaces[shared - 1] : first, to, error);
    }
    frame->view_count = count;
    for (int i = 0; i < count; i++)
        if (!frame->views[i].surface_count)
            return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --merge needs several layers, there is only %s",
                             frame->args->input, frame->views[i].view->layer[0] ? frame->views[i].view->layer : "RGB");
    return 0;
}

// Open a further file: its layer of the name that --layer gives, if it has one, else its main one.
static int open_other(struct cli_frame *frame, int i, struct tool_error *error)
{
    const struct cli_args *args = frame->args;
    const struct hf_io_choice named = {args->depth_channel, args->merge ? NULL : args->layer},
                              plain = {args->depth_channel, NULL};
    struct hf_io_error io;
    int status = named.layer ? hf_io_open(&frame->others[i], args->others[i], &named, &io) : -1;
    if (status)
        status = hf_io_open(&frame->others[i], args->others[i], &plain, &io);
    return status ? tool_fail(error, CLI_ALL_FAILED, "%s %s", args->other_option, io.message) : 0;
}

// The view of a file that has a name; of a file with one view, that.
static int find_view(const struct hf_io_file *file, const char *name)
{
    for (int i = 0; i < hf_io_view_count(file); i++)
        if (!strcmp(hf_io_view(file, i)->name, name))
            return i;
    return hf_io_view_count(file) == 1 ? 0 : -1;
}

static int check_surface(const struct cli_frame *frame, const struct cli_view *v, const struct cli_view *s,
                         struct tool_error *error)
{
    const char *option = frame->args->other_option;
    const struct hf_io_box *a = &v->view->display_window, *b = &s->view->display_window;
    char channels[1024];
    if (s->view->depth_part < 0) {
        hf_io_channels(s->file, channels, sizeof(channels));
        return tool_fail(error, CLI_ALL_FAILED, "%s %s: there is no depth channel, the channels are: %s", option,
                         s->path, channels);
    }
    if (b->x1 - b->x0 != a->x1 - a->x0 || b->y1 - b->y0 != a->y1 - a->y0)
        return tool_fail(error, CLI_ALL_FAILED,
                         "%s %s is %d x %d pixels, %s %d x %d; pictures of a scene have one size", option, s->path,
                         b->x1 - b->x0, b->y1 - b->y0, v->label, a->x1 - a->x0, a->y1 - a->y0);
    return 0;
}

// The picture of a further file that belongs to a view.
static int add_other(struct cli_frame *frame, struct cli_view *v, int i, struct tool_error *error)
{
    struct hf_io_file *file = frame->others[i];
    const char *path = frame->args->others[i], *name = v->view->name;
    const int view = find_view(file, name);
    if (view < 0)
        return tool_fail(error, CLI_ALL_FAILED, "%s %s has no view %s, which %s has", frame->args->other_option, path,
                         name[0] ? name : "without a name", frame->args->input);
    struct cli_view *s = add_surface(v);
    if (!s)
        return no_memory(frame, error);
    s->file = file;
    s->path = path;
    s->index = view;
    s->view = hf_io_view(file, view);
    s->label = strdup(path);
    return s->label ? check_surface(frame, v, s, error) : no_memory(frame, error);
}

// Where a picture's data window is in the coordinates of the view that it belongs to: their display windows agree.
static struct hf_io_box place(const struct cli_view *v, const struct cli_view *s)
{
    const struct hf_io_box *to = &v->view->display_window, *from = &s->view->display_window,
                           *data = &s->view->data_window;
    const int x = s->file ? to->x0 - from->x0 : 0, y = s->file ? to->y0 - from->y0 : 0;
    return (struct hf_io_box){data->x0 + x, data->y0 + y, data->x1 + x, data->y1 + y};
}

int cli_surfaces_find(struct cli_frame *frame, struct tool_error *error)
{
    const int count = frame->args->other_count;
    int status = frame->args->merge ? merge_views(frame, error) : 0;
    frame->others = calloc((size_t)count + 1, sizeof(struct hf_io_file *));
    if (!status && !frame->others)
        return no_memory(frame, error);
    for (; frame->other_count < count && !status; frame->other_count++)
        status = open_other(frame, frame->other_count, error);
    for (int i = 0; i < frame->view_count; i++)
        for (int k = 0; k < count && !status; k++)
            status = add_other(frame, &frame->views[i], k, error);
    for (int i = 0; i < frame->view_count && !status; i++)
        for (int k = 0; k < frame->views[i].surface_count; k++)
            frame->views[i].surfaces[k].place = place(&frame->views[i], &frame->views[i].surfaces[k]);
    return status;
}

int cli_surfaces_inside(const struct cli_frame *frame)
{
    int count = 0;
    for (int i = 0; i < frame->view_count; i++)
        for (int k = 0; k < frame->views[i].surface_count; k++)
            count += !frame->views[i].surfaces[k].file;
    return count;
}

// The smallest window that holds a view's own and what of its pictures is in the display window.
static struct hf_io_box hold(const struct cli_view *v)
{
    struct hf_io_box all = v->view->data_window;
    const struct hf_io_box *display = &v->view->display_window;
    for (int i = 0; i < v->surface_count; i++) {
        const struct hf_io_box b = v->surfaces[i].place;
        const struct hf_io_box in = {b.x0 > display->x0 ? b.x0 : display->x0, b.y0 > display->y0 ? b.y0 : display->y0,
                                     b.x1 < display->x1 ? b.x1 : display->x1, b.y1 < display->y1 ? b.y1 : display->y1};
        if (in.x0 >= in.x1 || in.y0 >= in.y1)
            continue;
        all.x0 = in.x0 < all.x0 ? in.x0 : all.x0;
        all.y0 = in.y0 < all.y0 ? in.y0 : all.y0;
        all.x1 = in.x1 > all.x1 ? in.x1 : all.x1;
        all.y1 = in.y1 > all.y1 ? in.y1 : all.y1;
    }
    return all;
}

// Copy what two windows share from a plane of the one to a new plane of the other, which has `empty` elsewhere.
static float *moved(const float *plane, const struct hf_io_box *from, const struct hf_io_box *to, float empty)
{
    const size_t width = (size_t)(to->x1 - to->x0), height = (size_t)(to->y1 - to->y0);
    float *made = hf_io_alloc(width * height * sizeof(*made));
    const int x0 = from->x0 > to->x0 ? from->x0 : to->x0, x1 = from->x1 < to->x1 ? from->x1 : to->x1;
    for (size_t i = 0; i < width * height && made; i++)
        made[i] = empty;
    for (int y = to->y0; y < to->y1 && made && x0 < x1; y++)
        if (y >= from->y0 && y < from->y1)
            memcpy(made + (size_t)(y - to->y0) * width + (size_t)(x0 - to->x0),
                   plane + (size_t)(y - from->y0) * (size_t)(from->x1 - from->x0) + (size_t)(x0 - from->x0),
                   sizeof(*made) * (size_t)(x1 - x0));
    return made;
}

static int replace(float **plane, float *by)
{
    free(*plane);
    *plane = by;
    return by ? 0 : -1;
}

// Bring a picture to the window of its view. What it does not cover has alpha 0, so a picture without alpha gets one.
static int fit(struct cli_view *s, const struct hf_io_box *to)
{
    const struct hf_io_box from = s->place;
    const size_t n = (size_t)(from.x1 - from.x0) * (size_t)(from.y1 - from.y0);
    if (!memcmp(&from, to, sizeof(from)))
        return 0;
    if (!s->planes[3]) {
        s->planes[3] = hf_io_alloc(n * sizeof(float));
        for (size_t i = 0; i < n && s->planes[3]; i++)
            s->planes[3][i] = 1;
    }
    int failed = !s->planes[3];
    for (int c = 0; c < 4 && !failed; c++)
        failed = replace(&s->planes[c], moved(s->planes[c], &from, to, 0));
    return failed || replace(&s->depth, moved(s->depth, &from, to, 1)) ? -1 : 0;
}

// Read the pictures in one further file.
static int read_other(struct cli_frame *frame, const struct hf_io_file *file, struct tool_error *error)
{
    struct hf_io_want *wants = calloc((size_t)frame->view_count, sizeof(*wants));
    struct hf_io_error io;
    int count = 0, status = wants ? 0 : no_memory(frame, error);
    struct hf_io_file *own = NULL;
    for (int i = 0; i < frame->view_count && !status; i++)
        for (int k = 0; k < frame->views[i].surface_count && !status; k++) {
            struct cli_view *s = &frame->views[i].surfaces[k];
            if (s->file != file)
                continue;
            own = s->file;
            status = cli_view_want(s, 1, &wants[count++], error);
        }
    if (!status && count && (hf_io_fetch(own, wants, count, &io) || hf_io_decode(own, wants, count, frame->run, &io)))
        status = tool_fail(error, CLI_ALL_FAILED, "%s %s", frame->args->other_option, io.message);
    free(wants);
    return status;
}

static int fit_all(struct cli_frame *frame, struct cli_view *v, struct tool_error *error)
{
    const struct hf_io_box window = hold(v);
    int status = 0;
    for (int k = 0; k < v->surface_count && !status; k++)
        if (fit(&v->surfaces[k], &window))
            status = no_memory(frame, error);
    if (!status && memcmp(&window, &v->view->data_window, sizeof(window)))
        status = cli_window_enlarge(frame, v, &window, error);
    return status;
}

int cli_surfaces_load(struct cli_frame *frame, struct tool_error *error)
{
    int status = 0;
    for (int i = 0; i < frame->other_count && !status; i++)
        status = read_other(frame, frame->others[i], error);
    for (int i = 0; i < frame->view_count; i++)
        for (int k = 0; k < frame->views[i].surface_count && !status; k++)
            status = cli_view_prepare(frame, &frame->views[i].surfaces[k], error);
    for (int i = 0; i < frame->view_count && !status; i++)
        if (frame->views[i].surface_count)
            status = fit_all(frame, &frame->views[i], error);
    return status;
}

// Whether larger numbers of the depth are nearer.
static int turned(enum hf_depth_type type)
{
    return type == HF_DEPTH_NDC_REVERSED || type == HF_DEPTH_INVERSE;
}

float *cli_surfaces_depth(const struct cli_frame *frame, const struct cli_view *v)
{
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    const int larger = turned(frame->args->depth_type);
    float *depth = hf_io_alloc(n * sizeof(*depth));
    if (!depth)
        return NULL;
    for (size_t i = 0; i < n; i++)
        depth[i] = v->planes[3] && v->planes[3][i] < 0.5f ? NAN : v->depth[i];
    for (int k = 0; k < v->surface_count && !cli_others_peel(frame->args); k++)
        for (size_t i = 0; i < n; i++) {
            const struct cli_view *s = &v->surfaces[k];
            const float z = s->depth[i];
            if ((!s->planes[3] || s->planes[3][i] >= 0.5f) &&
                (isnan(depth[i]) || (larger ? z > depth[i] : z < depth[i])))
                depth[i] = z;
        }
    for (size_t i = 0; i < n; i++)
        depth[i] = isnan(depth[i]) ? v->depth[i] : depth[i];
    return depth;
}

// The view with all of its pictures into dst, which is none of them.
static int render_layers(struct hf_context *c, const struct cli_args *args, const struct cli_view *v,
                         const struct hf_image *image, const struct hf_image *dst, const struct hf_params *params)
{
    enum { MOST = 64 };
    struct hf_layer layers[MOST];
    struct hf_image images[MOST];
    struct hf_depth depths[MOST];
    const enum hf_layer_kind kind = cli_others_peel(args) ? HF_LAYER_PEEL : HF_LAYER_WHOLE;
    int count = 1;
    images[0] = *image;
    depths[0] = v->setup.depth;
    for (int k = 0; k < v->surface_count && count < MOST; k++, count++) {
        struct cli_view s = v->surfaces[k];
        s.view = v->view;  // whose size it has
        images[count] = cli_view_image(&s, 0);
        depths[count] = v->setup.depth;
        depths[count].data = s.depth;
    }
    for (int k = 0; k < count; k++)
        layers[k] = (struct hf_layer){
            .size = sizeof(*layers), .kind = k ? kind : HF_LAYER_WHOLE, .image = &images[k], .depth = &depths[k]};
    return hf_render_layers(c, dst, layers, count, params, NULL);
}

int cli_surfaces_render(struct hf_context *c, const struct cli_args *args, struct cli_view *v, struct hf_image *image,
                        const struct hf_params *params)
{
    struct hf_image made = *image;
    const size_t bytes = (size_t)v->view->width * (size_t)v->view->height * sizeof(float);
    int status = HF_OK;
    for (int i = 0; i < 4 && status == HF_OK; i++) {
        made.data[i] = image->data[i] ? hf_io_alloc(bytes) : NULL;
        status = image->data[i] && !made.data[i] ? HF_ERR_MEMORY : HF_OK;
    }
    if (status == HF_OK)
        status = render_layers(c, args, v, image, &made, params);
    for (int i = 0; i < 4; i++) {
        if (status != HF_OK || !made.data[i]) {
            free(made.data[i]);
            continue;
        }
        free(v->planes[i]);
        v->planes[i] = image->data[i] = made.data[i];
    }
    return status;
}

int cli_deep_render(struct hf_context *c, const struct cli_frame *frame, struct cli_view *v,
                    const struct hf_image *image, const struct hf_params *params)
{
    const struct hf_io_deep from = hf_io_deep(frame->file);
    struct cli_depth_found found;
    const struct hf_deep deep = {.size = sizeof(deep),
                                 .width = v->view->width,
                                 .height = v->view->height,
                                 .first = from.first,
                                 .samples = from.samples,
                                 .colour = {from.colour[0], from.colour[1], from.colour[2]},
                                 .alpha = from.alpha,
                                 .depth = from.depth,
                                 .as = &v->setup.depth,
                                 .back = from.back};
    if (!v->samples_ready) {
        cli_depth_prepare(frame->args, from.depth, (size_t)from.samples, &found);
        if (from.back)
            cli_depth_prepare(frame->args, from.back, (size_t)from.samples, &found);
    }
    v->samples_ready = 1;
    return hf_render_deep(c, image, &deep, params, NULL);
}

int cli_surfaces_render_to(struct hf_context *c, const struct cli_frame *frame, struct cli_view *v,
                           const struct hf_image *image, const struct hf_image *dst, const struct hf_params *params)
{
    return v->view->deep      ? cli_deep_render(c, frame, v, dst, params)
           : v->surface_count ? render_layers(c, frame->args, v, image, dst, params)
                              : hf_render(c, dst, image, &v->setup.depth, params);
}

double cli_surfaces_bytes(const struct cli_frame *frame)
{
    double bytes = 0;
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const struct hf_io_box box = hold(v);
        // Colour and depth of each, and the result beside them.
        const double pixels = ((double)box.x1 - box.x0) * ((double)box.y1 - box.y0);
        bytes += v->surface_count ? (5. * v->surface_count + 4) * (double)sizeof(float) * pixels : 0;
    }
    for (int i = 0; i < frame->other_count; i++)
        bytes += hf_io_memory(frame->others[i]);
    return bytes;
}

void cli_surfaces_close(struct cli_frame *frame)
{
    for (int i = 0; i < frame->view_count; i++) {
        for (int k = 0; k < frame->views[i].surface_count; k++)
            cli_view_free(&frame->views[i].surfaces[k]);
        free(frame->views[i].surfaces);
    }
    for (int i = 0; i < frame->other_count; i++)
        hf_io_close(&frame->others[i]);
    free(frame->others);
}
