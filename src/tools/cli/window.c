// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/coc.h"

enum {
    MARGIN = 2,  // pixels beyond the radius, for half resolution and soft edges
    STEP = 8     // the coarsest resolution, an eighth
};

static int visible(const struct cli_view *v, size_t i)
{
    for (int c = 0; c < 4; c++)
        if (v->planes[c] && !(v->planes[c][i] == 0))
            return 1;
    return 0;
}

int cli_window_cut(const struct cli_view *v)
{
    const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
    const int width = v->view->width, height = v->view->height;
    const int left = data->x0 > display->x0, right = data->x1<display->x1, top = data->y0> display->y0,
              bottom = data->y1 < display->y1;
    float most = 0;
    if (!(left | right | top | bottom))
        return 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const size_t i = (size_t)y * (size_t)width + (size_t)x;
            const float r = v->radii[i] == 0 ? 0 : fmaxf(fabsf(v->radii[i]), v->least_reach);
            float beyond = 0;
            if (left)
                beyond = fmaxf(beyond, r - (float)x);
            if (right)
                beyond = fmaxf(beyond, r - (float)(width - 1 - x));
            if (top)
                beyond = fmaxf(beyond, r - (float)y);
            if (bottom)
                beyond = fmaxf(beyond, r - (float)(height - 1 - y));
            if (beyond > most && visible(v, i))
                most = beyond;
        }
    return most >= 1 ? (int)ceilf(most) : 0;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

// Where a window that holds `from` begins: a multiple of STEP away from `first`, so that engines at half resolution
// and below group the same pixels as in the whole frame.
static int begin(int first, int from)
{
    return from <= first ? first : first + (from - first) / STEP * STEP;
}

// The data window enlarged by reach, but not beyond the display window, unless it is beyond already.
static struct hf_io_box grown(const struct hf_io_view *v, int reach)
{
    const struct hf_io_box *data = &v->data_window, *display = &v->display_window;
    return (struct hf_io_box){
        least(data->x0, begin(display->x0, data->x0 - reach)), least(data->y0, begin(display->y0, data->y0 - reach)),
        most(data->x1, least(display->x1, data->x1 + reach)), most(data->y1, least(display->y1, data->y1 + reach))};
}

// Move a plane from the old window to the new one; new pixels get value.
static int move_plane(float **plane, const struct hf_io_box *from, const struct hf_io_box *to, float value)
{
    const size_t old_width = (size_t)(from->x1 - from->x0), width = (size_t)(to->x1 - to->x0);
    const size_t n = width * (size_t)(to->y1 - to->y0);
    float *p = *plane ? malloc(n * sizeof(float)) : NULL;
    if (!*plane)
        return 0;
    if (!p)
        return -1;
    for (size_t i = 0; i < n; i++)
        p[i] = value;
    for (int y = from->y0; y < from->y1; y++)
        memcpy(p + (size_t)(y - to->y0) * width + (size_t)(from->x0 - to->x0),
               *plane + (size_t)(y - from->y0) * old_width, old_width * sizeof(float));
    free(*plane);
    *plane = p;
    return 0;
}

// The depth that means no surface: in the file, or in the plane that the library reads.
static float no_surface(const struct cli_args *args, int in_file)
{
    switch (args->depth_type) {
    case HF_DEPTH_NDC_D3D:
    case HF_DEPTH_NDC_GL:
        return 1;
    case HF_DEPTH_VIEW:
    case HF_DEPTH_RAY:
        return !in_file ? INFINITY : args->normalized ? (float)(args->normalized > 0) : 1e10f;
    default:
        return 0;
    }
}

// How far from a near pixel of radius q scatter and hexagon read to fill in what it occludes. Nothing exists beyond a
// window, so the window must hold these pixels: neighbourhoods of 2 q + 4 pixels, 14 where others are nearer, and 2
// for a bilinear sample.
static float behind(enum hf_engine engine, float q)
{
    return engine == HF_ENGINE_SCATTER || engine == HF_ENGINE_HEXAGON ? 2 * q + 4 + 14 + 2 : 0;
}

// How far visible blur reaches, the largest of all views of a part. The new pixels around the window are infinitely
// far, and their blur mixes with it at the edges.
static float largest(const struct cli_frame *frame, int part)
{
    float r = 0;
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const size_t n = v->view->part == part ? (size_t)v->view->width * (size_t)v->view->height : 0;
        r = n ? fmaxf(r, fmaxf(v->far_away, v->least_reach)) : r;
        for (size_t k = 0; k < n; k++) {
            const float q = v->radii[k], reach = fmaxf(fabsf(q), q < 0 ? behind(v->setup.params.engine, -q) : 0);
            r = reach > r && visible(v, k) ? reach : r;
        }
    }
    return r;
}

// Is this the first view of its part? The views of a part share a window, which grows once.
static int is_first(const struct cli_frame *frame, int i)
{
    for (int k = 0; k < i; k++)
        if (frame->views[k].view->part == frame->views[i].view->part)
            return 0;
    return 1;
}

// Does the data window fill the display window?
static int fills(const struct hf_io_view *view)
{
    const struct hf_io_box *data = &view->data_window, *display = &view->display_window;
    return data->x0 <= display->x0 && data->y0 <= display->y0 && data->x1 >= display->x1 && data->y1 >= display->y1;
}

int cli_window_enlarge(struct cli_frame *frame, const struct cli_view *view, const struct hf_io_box *box,
                       struct tool_error *error)
{
    const struct hf_io_box old = view->view->data_window;
    struct hf_io_error io;
    int status = 0;
    if (hf_io_grow(frame->file, view->index, *box, no_surface(frame->args, 1), frame->run, &io))
        return tool_fail(error, CLI_ALL_FAILED, "%s", io.message);
    for (int k = 0; k < frame->view_count && !status; k++) {
        struct cli_view *o = &frame->views[k];
        if (o->view->part != view->view->part)
            continue;
        for (int c = 0; c < 4 && !status; c++)
            status = move_plane(&o->planes[c], &old, box, 0);
        if (!status)
            status =
                move_plane(&o->depth, &old, box, no_surface(frame->args, 0)) || move_plane(&o->radii, &old, box, 0);
    }
    return status ? tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", view->label) : 0;
}

int cli_window_grow(struct cli_frame *frame, struct tool_error *error)
{
    for (int i = 0; i < frame->view_count; i++) {
        frame->views[i].setup.depth.data = frame->views[i].depth;
        frame->views[i].whole = fills(frame->views[i].view);
        const int status = cli_coc_look(&frame->views[i], frame->args, error);
        if (status)
            return status;
    }
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const float r = largest(frame, v->view->part);
        const struct hf_io_box box = grown(v->view, r > 0 ? (int)ceilf(r) + MARGIN : 0);
        const int same = !memcmp(&v->view->data_window, &box, sizeof(box));
        const int status = is_first(frame, i) && !same ? cli_window_enlarge(frame, v, &box, error) : 0;
        if (status)
            return status;
    }
    return 0;
}
