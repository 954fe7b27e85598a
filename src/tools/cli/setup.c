// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/setup.h"

#include "tools/cli/choose.h"
#include "tools/cli/lens.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int given(float number)
{
    return !isnan(number);
}

static float first_usable(float a, float b, float otherwise)
{
    return given(a) ? a : cli_lens_usable(b) ? b : otherwise;
}

const char *cli_model_name(enum cli_model model)
{
    static const char *const names[] = {"range", "lens", "coc"};
    return names[model];
}

static int display_width(const struct hf_io_view *view)
{
    return view->display_window.x1 - view->display_window.x0;
}

void cli_setup_depth(struct hf_depth *depth, const struct cli_args *args, const struct hf_io_view *view,
                     const float *data)
{
    *depth = (struct hf_depth){
        .size = sizeof(struct hf_depth),
        .data = data,
        .stride = (ptrdiff_t)view->width * (ptrdiff_t)sizeof(float),
        .type = args->depth_type,
        .near_plane = given(args->near_plane) ? args->near_plane : 0,
        .far_plane = given(args->far_plane) ? args->far_plane : 0,
    };
    const struct hf_io_box *display = &view->display_window;
    const float width = (float)display_width(view);
    const float screen_width = cli_lens_usable(view->screen_width) ? view->screen_width : 1;
    const float focal = first_usable(args->focal_length, cli_lens_header_focal(&view->camera), NAN);
    const float sensor = first_usable(args->sensor_width, view->camera.sensor_width_mm, 36);
    depth->focal_px = given(focal) ? focal / sensor * width : width / screen_width;

    // screenWindowCenter is how far the middle of the display window lies off the camera's axis, y upwards, in units
    // of which the display window is screenWindowWidth wide. With pixels that are not square the same distance is more
    // of them in y.
    const float shift_x = isfinite(view->screen_center_x) ? view->screen_center_x * (width / screen_width) : 0;
    const float shift_y =
        isfinite(view->screen_center_y) ? view->screen_center_y * (width / screen_width) * view->pixel_aspect : 0;
    depth->center_x = 0.5f * (float)(display->x0 + display->x1) - shift_x - (float)view->data_window.x0;
    depth->center_y = 0.5f * (float)(display->y0 + display->y1) + shift_y - (float)view->data_window.y0;
}

// Focus on the surface that a pixel shows; x and y are EXR coordinates.
static int focus_at(struct cli_setup *setup, const struct hf_io_view *view, int x, int y, const char *option,
                    const char *label, struct tool_error *error)
{
    const struct hf_io_box *data = &view->data_window;
    if (x < data->x0 || x >= data->x1 || y < data->y0 || y >= data->y1)
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s: %s is pixel %d,%d, which is outside the data window %d,%d to "
                         "%d,%d",
                         label, option, x, y, data->x0, data->y0, data->x1 - 1, data->y1 - 1);
    const int status =
        hf_depth_at(&setup->depth, view->width, view->height, x - data->x0, y - data->y0, &setup->params.focus, NULL);
    if (status == HF_ERR_FOCUS)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: %s is pixel %d,%d, where there is no surface to focus on",
                         label, option, x, y);
    if (status != HF_OK)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: %s at pixel %d,%d: %s", label, option, x, y,
                         hf_error_string(status));
    return 0;
}

// Focus on a point of the world.
static int focus_point(float *focus, const struct cli_args *args, const struct hf_io_view *view, const char *label,
                       struct tool_error *error)
{
    const float *axis = view->camera.axis, *p = args->focus_point;
    const float distance = fabsf(axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2] + axis[3]);
    if (isnan(axis[0]))
        return tool_fail(
            error, CLI_BAD_ARGUMENTS,
            "%s: --focus-point %g,%g,%g needs worldToCamera or worldToNDC in the header, which has neither", label,
            p[0], p[1], p[2]);
    *focus = distance;
    return distance > 0 && isfinite(distance)
               ? 0
               : tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --focus-point %g,%g,%g is at distance %g of the camera",
                           label, p[0], p[1], p[2], distance);
}

static int find_focus(struct cli_setup *setup, const struct cli_args *args, const struct hf_io_view *view,
                      const char *label, struct tool_error *error)
{
    float *focus = &setup->params.focus;
    char option[64];
    const struct hf_io_box *display = &view->display_window;
    if (setup->model == CLI_MODEL_COC)
        return 0;
    switch (args->focus_by) {
    case CLI_FOCUS_DISTANCE:
        setup->focus_from = args->focus_from ? args->focus_from : "--focus";
        *focus = args->focus;
        if (isinf(*focus) && setup->model == CLI_MODEL_RANGE)
            return tool_fail(error, CLI_BAD_ARGUMENTS,
                             "%s: %s inf is for a lens, give --fstop and --focal-length; a range needs a distance",
                             label, setup->focus_from);
        return 0;
    case CLI_FOCUS_CENTER:
        setup->focus_from = "--focus center";
        return focus_at(setup, view, display->x0 + (display->x1 - display->x0) / 2,
                        display->y0 + (display->y1 - display->y0) / 2, setup->focus_from, label, error);
    case CLI_FOCUS_AT:
        setup->focus_from = "--focus-at";
        snprintf(option, sizeof(option), "--focus-at %d,%d", args->focus_x, args->focus_y);
        return focus_at(setup, view, args->focus_x, args->focus_y, option, label, error);
    case CLI_FOCUS_POINT:
        setup->focus_from = "--focus-point";
        return focus_point(focus, args, view, label, error);
    case CLI_FOCUS_OBJECT:  // found before, and then a distance
    case CLI_FOCUS_HEADER:
        break;
    }
    if (setup->params.engine == HF_ENGINE_GAUSSIAN && setup->model == CLI_MODEL_RANGE) {
        setup->focus_from = "the picture's centre";
        *focus = HF_DERIVE;
        return 0;
    }
    const float unit = given(args->world_unit) ? args->world_unit : 1;
    const int endless = setup->model == CLI_MODEL_LENS && view->camera.focus == INFINITY;
    if (!endless && !cli_lens_usable(view->camera.focus / unit))
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s: there is no focus distance in the header, give one with "
                         "--focus or --focus-at",
                         label);
    setup->focus_from = "header";
    *focus = view->camera.focus / unit;
    return 0;
}

static int set_range(struct hf_params *p, const struct cli_args *args, const char *label, struct tool_error *error)
{
    if (given(args->range))
        p->range.distance = args->range;
    if (given(args->strength))
        p->range.strength = args->strength;
    const float half = given(args->depth_of_field) ? args->depth_of_field / 2 : 0;
    if (given(args->near_begin))
        p->range.near_begin = args->near_begin;
    if (given(args->near_end))
        p->range.near_end = args->near_end;
    if (given(args->far_begin))
        p->range.far_begin = args->far_begin;
    if (given(args->far_end))
        p->range.far_end = args->far_end;

    // The others follow from the focus and the range, so they may lie on the wrong side of those that were given. If
    // the gaussian engine finds the focus by itself, the library reports that.
    if (p->focus == HF_DERIVE)
        return 0;
    const float focus = p->focus;
    const float range = given(args->range) ? args->range : focus / 2;
    const float near_end = given(args->near_end) ? args->near_end : fmaxf(0, focus - half);
    const float near_begin = given(args->near_begin) ? args->near_begin : fmaxf(0, focus - half - range);
    const float far_begin = given(args->far_begin) ? args->far_begin : focus + half;
    const float far_end = given(args->far_end) ? args->far_end : focus + half + range;
    if (near_begin > near_end)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --near-begin %g is beyond --near-end %g (focus %g, range %g)",
                         label, near_begin, near_end, focus, range);
    if (far_begin > far_end)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: --far-begin %g is beyond --far-end %g (focus %g, range %g)",
                         label, far_begin, far_end, focus, range);
    if (near_end > far_begin)
        return tool_fail(
            error, CLI_BAD_ARGUMENTS,
            "%s: --near-end %g is beyond --far-begin %g (focus %g): what lies between would be near and far "
            "at once",
            label, near_end, far_begin, focus);
    if (half > 0) {
        p->range.near_begin = near_begin;
        p->range.near_end = near_end;
        p->range.far_begin = far_begin;
        p->range.far_end = far_end;
    }
    return 0;
}

// Refuse options that only a lens uses when the blur follows from a range or from the depth.
static int check_unused(const struct cli_setup *setup, const struct cli_args *args, const char *label,
                        struct tool_error *error)
{
    const char *model = setup->model == CLI_MODEL_RANGE ? "range" : "depth";
    const int unit_used = args->metric || args->keys || (setup->focus_from && !strcmp(setup->focus_from, "header"));
    if (given(args->sensor_width) && args->depth_type != HF_DEPTH_RAY)
        return tool_fail(
            error, CLI_BAD_ARGUMENTS,
            "%s: --sensor-width %g is of use only with a lens, but here the %s says how much blur there is", label,
            args->sensor_width, model);
    if (given(args->world_unit) && !unit_used)
        return tool_fail(
            error, CLI_BAD_ARGUMENTS,
            "%s: --world-unit %g is of use only with a lens, the header's focus or distances in metres, but "
            "here the %s says how much blur there is",
            label, args->world_unit, model);
    return 0;
}

int cli_setup_view(struct cli_setup *setup, const struct cli_args *args, const struct hf_io_view *view,
                   const float *depth, const char *label, struct tool_error *error)
{
    *setup = (struct cli_setup){.params = args->params, .model = cli_lens_model(args, &view->camera)};
    struct hf_params *p = &setup->params;
    cli_setup_depth(&setup->depth, args, view, depth);
    p->model = setup->model == CLI_MODEL_LENS ? HF_MODEL_LENS : HF_MODEL_RANGE;
    p->view.display_width = display_width(view);
    p->view.display_height = view->display_window.y1 - view->display_window.y0;
    p->view.pixel_aspect = view->pixel_aspect;
    cli_choose(setup, args);
    if (cli_check_planes(args, p->engine, error))
        return CLI_BAD_ARGUMENTS;
    if (args->params.range.blend != hf_default_params().range.blend && setup->model != CLI_MODEL_RANGE)
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s: --blend %s is of use only with a range, but here the %s says how "
                         "much blur there is",
                         label, hf_name(HF_NAMES_BLEND, (int)args->params.range.blend),
                         setup->model == CLI_MODEL_LENS ? "lens" : "depth");
    int status = find_focus(setup, args, view, label, error);
    if (!status && setup->model != CLI_MODEL_LENS)
        status = check_unused(setup, args, label, error);
    if (status || setup->model == CLI_MODEL_COC)
        return status;
    return setup->model == CLI_MODEL_LENS ? cli_lens_set(p, args, &view->camera, label, error)
                                          : set_range(p, args, label, error);
}
