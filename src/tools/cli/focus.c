// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/focus.h"

#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float median(float *values, int count)
{
    if (!count)
        return NAN;
    qsort(values, (size_t)count, sizeof(*values), by_value);
    return values[count / 2];
}

// 1/distance of the surface at a pixel of the data window; NAN if there is none.
static float nearness(const struct hf_depth *depth, const struct cli_view *v, int x, int y)
{
    float z;
    if (x < 0 || y < 0 || x >= v->view->width || y >= v->view->height)
        return NAN;
    return hf_depth_at(depth, v->view->width, v->view->height, x, y, &z, NULL) == HF_OK && z > 0 && isfinite(z) ? 1 / z
                                                                                                                : NAN;
}

static int alike(float a, float b, float part)
{
    return fabsf(a - b) <= part * b;
}

// The pixel's own surface. One that no pixel beside it is alike is noise: then it is the median of the nine.
static float own_surface(const struct hf_depth *depth, const struct cli_view *v, int x, int y)
{
    static const float ALIKE = 0.1f;
    const float own = nearness(depth, v, x, y);
    float near[9];
    int count = 0, same = 0;
    for (int i = 0; i < 9; i++) {
        const float n = nearness(depth, v, x - 1 + i % 3, y - 1 + i / 3);
        if (isnan(n))
            continue;
        same += alike(n, own, ALIKE);
        near[count++] = n;
    }
    return same > 1 ? own : median(near, count);
}

void cli_focus_around(struct cli_around *around, const struct cli_args *args, const struct cli_view *v, int x, int y)
{
    const int left = x - v->view->data_window.x0, top = y - v->view->data_window.y0;
    struct hf_depth depth;
    cli_setup_depth(&depth, args, v->view, v->depth);
    around->count = 0;
    around->own = own_surface(&depth, v, left, top);
    for (int i = 0; i < CLI_AROUND_PIXELS; i++) {
        const int side = 2 * CLI_AROUND + 1;
        const float n = nearness(&depth, v, left - CLI_AROUND + i % side, top - CLI_AROUND + i / side);
        if (!isnan(n))
            around->near[around->count++] = n;
    }
}

float cli_focus_median(const struct cli_around *around, float from, float part, int *count)
{
    float near[CLI_AROUND_PIXELS];
    int n = 0;
    for (int i = 0; i < around->count; i++)
        if (alike(around->near[i], from, part))
            near[n++] = around->near[i];
    if (count)
        *count = n;
    return median(near, n);
}

// The median nearness of the pixels of which the object fills at least `least`; NAN if there are none.
static float object_nearness(const struct hf_depth *depth, const struct cli_view *v, const float *coverage, float least,
                             float *near)
{
    int count = 0;
    for (int y = 0; y < v->view->height; y++)
        for (int x = 0; x < v->view->width; x++) {
            const float part = coverage[(size_t)y * (size_t)v->view->width + (size_t)x];
            const float n = part >= least ? nearness(depth, v, x, y) : NAN;
            if (!isnan(n))
                near[count++] = n;
        }
    return median(near, count);
}

int cli_focus_object(struct cli_args *args, const struct cli_frame *frame, const struct cli_view *v,
                     struct tool_error *error)
{
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    float *coverage = malloc(2 * n * sizeof(*coverage));
    struct hf_io_error io;
    struct hf_depth depth;
    if (!coverage)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    cli_setup_depth(&depth, args, v->view, v->depth);
    int status = hf_io_read_object(frame->file, v->index, args->focus_object, coverage, &io)
                     ? tool_fail(error, CLI_BAD_ARGUMENTS, "--focus-object: %s", io.message)
                     : 0;
    // Pixels that the object fills by half show its own depth; one that is thin may have none of these.
    float near = status ? NAN : object_nearness(&depth, v, coverage, 0.5f, coverage + n);
    if (!status && isnan(near))
        near = object_nearness(&depth, v, coverage, 1e-3f, coverage + n);
    if (!status && isnan(near))
        status = tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --focus-object %s is nowhere in this picture", v->label,
                           args->focus_object);
    args->focus_by = CLI_FOCUS_DISTANCE;
    args->focus_from = "--focus-object";
    args->focus = 1 / near;
    free(coverage);
    return status;
}
