// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/warn.h"

#include "tools/cli/coc.h"
#include "tools/cli/lens.h"
#include "tools/common/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct warner {
    const struct cli_frame *frame;
    const struct cli_args *args;
    const char *label;       // names what the warning is about
    int say;                 // print it on stderr
    struct tool_json *list;  // gets the sentences, unless NULL
    int count;
};

static void warn(struct warner *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void warn(struct warner *w, const char *format, ...)
{
    char text[2048];
    va_list list;
    w->count++;
    va_start(list, format);
    vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    if (w->say)
        tool_print_line("%s: %s", w->label, text);
    if (w->list)
        tool_json_text(w->list, NULL, text);
}

static const char *depth_name(const struct warner *w, const struct cli_view *v)
{
    return w->args->depth_file ? w->args->depth_file : v->view->depth;
}

// Is everything infinitely far?
static int is_empty(const struct cli_view *v)
{
    return v->setup.model != CLI_MODEL_COC &&
           v->report.all.no_surface == (uint64_t)v->view->width * (uint64_t)v->view->height;
}

static int is_sharp(const struct cli_view *v)
{
    return v->least_radius < CLI_SHARP_RADIUS;
}

static void warn_samples(struct warner *w, const struct cli_view *v)
{
    const struct tool_report *r = &v->report;
    if (r->all.colour_repaired)
        warn(w, "%" PRIu64 " colour samples were NaN or infinite and were replaced from their neighbours",
             r->all.colour_repaired);
    if (r->all.depth_repaired)
        warn(w, "%" PRIu64 " depth samples were NaN and were replaced from their neighbours", r->all.depth_repaired);
    if (v->found.flipped)
        warn(w, "depth %s is negative, so the camera looks along -z: the sign is dropped", depth_name(w, v));
    if (v->found.negative)
        warn(w, "%" PRIu64 " samples of depth %s are negative and count as no surface", v->found.negative,
             depth_name(w, v));
}

static int is_distance(const struct cli_args *args)
{
    return (args->depth_type == HF_DEPTH_VIEW || args->depth_type == HF_DEPTH_RAY) && !args->normalized;
}

// Write the range of distances of the surfaces, and the focus.
static void tell_range(const struct cli_view *v, char *text, size_t size)
{
    if (v->range[0] == v->range[1])
        snprintf(text, size, "; the depth is %.4g", v->range[0]);
    else if (v->range[0] < v->range[1])
        snprintf(text, size, "; the depth is %.4g to %.4g", v->range[0], v->range[1]);
    if (text[0] && v->setup.model != CLI_MODEL_COC)
        snprintf(text + strlen(text), size - strlen(text), ", the focus %.4g", v->report.params.focus);
}

// The focus lies outside the depth. If a power of ten brings it inside, write a hint that their units differ.
static void guess_unit(const struct cli_args *args, const struct cli_view *v, char *text, size_t size)
{
    static const float factors[] = {10, 100, 1000}, SLACK = 1.5f;
    const float nearest = v->range[0] / SLACK, farthest = v->range[1] * SLACK, focus = v->report.params.focus;
    const int beyond = focus > farthest, metres = args->focus_by == CLI_FOCUS_HEADER;
    char list[64] = "";
    if (!(focus < nearest) && !beyond)
        return;
    for (int i = 0; i < 3; i++) {
        const float f = beyond ? focus / factors[i] : focus * factors[i];
        if (f >= nearest && f <= farthest)
            snprintf(list + strlen(list), sizeof(list) - strlen(list), "%s%g", list[0] ? " or " : "",
                     beyond ? f : 1 / factors[i]);
    }
    if (!list[0])
        return;
    if (beyond)
        snprintf(text, size, ": is the focus in other units? %s would be near", list);
    else if (metres)
        snprintf(text, size, ": is it in other units? --world-unit %s would make them agree", list);
    else
        snprintf(text, size,
                 ": is it in other units? --depth-scale %s would make them agree, or --world-unit %s with --focus "
                 "in metres (%gm)",
                 list, list, focus);
}

// Is it meant that nothing is in focus? Radii of the user's own and --uniform say so themselves. A focus that the
// command line or its keys give as a number, less than BESIDE times nearer or farther than everything, is a lens turned
// past the subject; one that is off by more may be in other units.
static int is_meant(const struct cli_args *args, const struct cli_view *v)
{
    static const float BESIDE = 4;
    const struct hf_params *p = &v->report.params;
    const int number = args->focus_by == CLI_FOCUS_DISTANCE && is_distance(args) && !v->map_bits && v->range[1] > 1;
    return v->setup.model == CLI_MODEL_COC || p->hexagon.uniform ||
           (number && p->focus > v->range[0] / BESIDE && p->focus < v->range[1] * BESIDE);
}

static void warn_focus(struct warner *w, const struct cli_view *v)
{
    char range[128] = "", hint[256] = "";
    if (is_empty(v)) {
        warn(w,
             "depth %s has no surface anywhere, so everything is infinitely far: is it the right channel, and "
             "--depth-type %s?",
             depth_name(w, v), cli_depth_type_name(w->args));
        return;
    }
    if (is_sharp(v) || is_meant(w->args, v))
        return;
    const int raw = is_distance(w->args) && isnan(w->args->depth_scale);
    tell_range(v, range, sizeof(range));
    if (raw && v->map_bits)
        snprintf(hint, sizeof(hint), ": the numbers of a map are 0 to 1, is it --depth-type normalized or inverse?%s",
                 v->map_bits == 16 ? " For millimetres in 16 bits --depth-scale 65.535 makes metres" : "");
    else if (raw && v->range[1] <= 1)
        snprintf(hint, sizeof(hint), ": is it --depth-type normalized, inverse or ndc-d3d?");
    else if (w->args->depth_type == HF_DEPTH_INVERSE && isnan(w->args->near_plane) && isnan(w->args->depth_scale))
        snprintf(hint, sizeof(hint), ": inverse depth may have a scale of its own, see --near and --depth-scale");
    else if (v->setup.model != CLI_MODEL_COC)
        guess_unit(w->args, v, hint, sizeof(hint));
    warn(w, "nothing is in focus: all is blurred by %.3g pixels or more%s%s", v->least_radius, range, hint);
}

// Warn if no blur is visible, unless the options ask for none.
static void warn_sharp(struct warner *w, const struct cli_view *v)
{
    const struct cli_args *args = w->args;
    const struct hf_lens_params *lens = &v->setup.params.lens;
    const float largest = cli_coc_largest(v);
    char hint[256] = "";
    if (is_empty(v) || largest >= CLI_SEEN_RADIUS || args->strength == 0 || args->params.max_radius == 0 ||
        isinf(args->fstop))
        return;
    if (v->setup.model == CLI_MODEL_LENS && lens->focal_length_mm < 1)
        snprintf(hint, sizeof(hint), "; the focal length is %g mm: is it %g mm?", lens->focal_length_mm,
                 1000 * lens->focal_length_mm);
    else if (v->setup.model == CLI_MODEL_LENS) {
        tell_range(v, hint, sizeof(hint));
        snprintf(hint + strlen(hint), sizeof(hint) - strlen(hint), ", the lens f/%g and %g mm%s", lens->f_number,
                 lens->focal_length_mm,
                 v->range[1] >= 100 && isnan(args->world_unit)
                     ? ": is the depth in metres? For millimetres --world-unit 0.001"
                     : "");
    } else if (isinf(args->range)) {
        snprintf(hint, sizeof(hint), "; --range inf asks for none");
    } else {
        tell_range(v, hint, sizeof(hint));
    }
    warn(w, "nothing is blurred: the largest radius is %.2f pixels%s", largest, hint);
}

// Warn of options that cannot be fulfilled, or that have no effect on this picture.
static void warn_options(struct warner *w, const struct cli_view *v)
{
    const struct hf_highlight_params *p = &v->setup.params.highlight;
    if (v->setup.missed)
        warn(w, "no setting errs as little as --max-error %g: the most accurate is expected to err %.3g",
             w->args->max_error, v->setup.choice.all.error);
    if (p->gain > 1 && v->highlights == 0)
        warn(w,
             "there is no lamp, small and brighter than %g among what is darker, so --highlight-gain %g changes "
             "nothing: see "
             "--highlight-threshold",
             p->threshold, p->gain);
    if (v->whole)
        warn(w, "--grow changes nothing: the data window holds all of the display window");
    if (v->cut)
        warn(w,
             "blur reaches %d pixels beyond the data window, which is smaller than the display window, and is cut "
             "there; --grow keeps it",
             v->cut);
}

static void warn_lens(struct warner *w, const struct cli_view *v)
{
    char text[512];
    if (cli_lens_remark(w->args, &v->setup, &v->view->camera, text, sizeof(text)))
        warn(w, "%s", text);
}

// Is width : height, or height : width, one of the usual shapes of a whole frame, to half a pixel?
static int usual_shape(int width, int height)
{
    static const double shapes[] = {1, 5 / 4., 4 / 3.,  1.37, 1.4142, 1.43, 3 / 2., 1.6,  1.66, 16 / 9., 1.85, 1.9,
                                    2, 2.2,    21 / 9., 2.35, 2.37,   2.39, 2.4,    2.55, 2.76, 3,       3.5,  4};
    const double wide = width > height ? width : height, high = width > height ? height : width;
    for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++)
        if (fabs(wide - high * shapes[i]) <= 0.5 * shapes[i] + 0.5)
            return 1;
    return 0;
}

// Blender's border render with "crop" writes a file whose windows are those of the crop. With a lens the blur is then too
// large, because the crop counts as the whole sensor. Nothing in the header tells a crop; an unusual shape hints at one.
static void warn_crop(struct warner *w, const struct cli_view *v)
{
    char text[8];
    const struct hf_io_box *box = &v->view->display_window;
    const int width = box->x1 - box->x0, height = box->y1 - box->y0;
    const int blender = hf_io_text(w->frame->file, "BlenderMultiChannel", text, sizeof(text))[0] ||
                        (hf_io_text(w->frame->file, "Scene", text, sizeof(text))[0] &&
                         hf_io_text(w->frame->file, "RenderTime", text, sizeof(text))[0]);
    if (v->setup.model == CLI_MODEL_LENS && blender && !w->args->display[0] && !usual_shape(width, height))
        warn(w,
             "a picture by Blender of an unusual shape, %d x %d: if it is a cropped border render, the lens must know "
             "the whole frame, as in --display 1920x1080+X+Y; --display %dx%d says that it is whole",
             width, height, width, height);
}

static void warn_view(struct warner *w, const struct cli_view *v)
{
    w->label = v->label;
    warn_lens(w, v);
    warn_crop(w, v);
    warn_samples(w, v);
    warn_focus(w, v);
    warn_sharp(w, v);
    warn_options(w, v);
    w->count += v->warned;
}

// Warn that other layers have depths too if only the main one is blurred.
static void warn_layers(struct warner *w)
{
    char names[512];
    const struct cli_args *args = w->args;
    if (args->layer || args->depth_file)
        return;
    const int count = hf_io_other_layers(w->frame->file, names, sizeof(names));
    if (count && args->output && !cli_is_exr(args->output))
        warn(w, "%s %s too and %s left out; --layer chooses", names, count > 1 ? "have depths" : "has a depth",
             count > 1 ? "are" : "is");
    else if (count)
        warn(w, "%s %s too and %s as %s; --layer all blurs each", names, count > 1 ? "have depths" : "has a depth",
             count > 1 ? "stay" : "stays", count > 1 ? "they are" : "it is");
}

// Warn if OUTPUT's format cannot hold the data window.
static void warn_window(struct warner *w)
{
    const struct hf_io_view *v = w->frame->views[0].view;
    const struct hf_io_box *data = &v->data_window, *display = &v->display_window;
    if (w->args->output && !cli_is_exr(w->args->output) && memcmp(data, display, sizeof(*data)))
        warn(w, "%s holds no windows: its picture is the data window, %d x %d at %d,%d of the display window, %d x %d",
             w->args->output, v->width, v->height, data->x0 - display->x0, data->y0 - display->y0,
             display->x1 - display->x0, display->y1 - display->y0);
}

// Warn if INPUT was defocused before, or if OUTPUT replaces it.
static void warn_input(struct warner *w)
{
    char text[2];
    if (hf_io_text(w->frame->file, "hyperfocalSettings", text, sizeof(text))[0] ||
        hf_io_text(w->frame->file, "hyperfocalHash", text, sizeof(text))[0])
        warn(w, "hyperfocal made this file, so it is defocused already and is now blurred a second time");
    if (w->frame->in_place)
        warn(w, "OUTPUT %s is INPUT: the picture is replaced by the defocused one; another OUTPUT keeps it",
             w->args->output);
}

// Warn of options that have an effect only on shots if there is one picture.
static void warn_alone(struct warner *w)
{
    const struct cli_args *args = w->args;
    const float budget = args->params.run.budget_ms;
    int cheaper = 0;
    if (!w->frame->alone)
        return;
    for (int i = 0; i < w->frame->view_count; i++)
        cheaper |= w->frame->views[i].report.all.budget_step;
    if (budget > 0 && !cheaper)
        warn(w, "--budget-ms %g does nothing for one picture: cheaper settings are chosen from frame to frame", budget);
    if (!isnan(args->memory_limit))
        warn(w, "--memory-limit %g does nothing for one picture: it says how many frames are worked on at once",
             args->memory_limit);
    if (args->stop_on_error)
        warn(w, "--stop-on-error does nothing for one picture: it stops a shot at a frame that fails");
    if (args->focus_smooth > 0)
        warn(w, "--focus-smooth %d does nothing for one picture: it is a mean over the frames before and after",
             args->focus_smooth);
    if (args->dump_dir && args->dry_run)
        warn(w, "--dump-passes %s: a dry run renders nothing, so there are no passes to write", args->dump_dir);
}

static void warn_frame(struct warner *w)
{
    w->label = w->args->input;
    warn_input(w);
    warn_layers(w);
    warn_window(w);
    warn_alone(w);
}

int cli_warnings_of(const struct cli_frame *frame, const struct cli_view *v)
{
    struct warner w = {.frame = frame, .args = frame->args};
    warn_view(&w, v);
    return w.count;
}

static void warn_all(struct warner *w)
{
    const struct cli_frame *frame = w->frame;
    warn_frame(w);
    for (int i = 0; i < frame->view_count; i++)
        warn_view(w, &frame->views[i]);
    w->label = w->args->output;
    if (frame->written.clamped)
        warn(w, "%" PRIu64 " samples did not fit their channels and were clamped", frame->written.clamped);
}

int cli_print_warnings(const struct cli_frame *frame)
{
    struct warner w = {.frame = frame, .args = frame->args, .say = 1};
    warn_all(&w);
    if (frame->written.note[0])
        tool_print_line("%s", frame->written.note);
    return w.count + (frame->written.note[0] != '\0');
}

void cli_json_warnings(struct tool_json *j, const struct cli_frame *frame)
{
    struct warner w = {.frame = frame, .args = frame->args, .list = j};
    tool_json_open(j, "warning_texts", '[');
    warn_all(&w);
    for (int i = 0; i < frame->view_count; i++)
        for (const char *c = frame->views[i].said; c && *c; c += strcspn(c, "\n") + 1) {
            char text[1024];
            snprintf(text, sizeof(text), "%.*s", (int)strcspn(c, "\n"), c);
            tool_json_text(j, NULL, text);
        }
    if (frame->written.note[0])
        tool_json_text(j, NULL, frame->written.note);
    tool_json_close(j);
}
