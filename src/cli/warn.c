// SPDX-License-Identifier: BSD-3-Clause
#include "cli/warn.h"

#include "cli/lens.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct warner {
    const struct cli_frame *frame;
    const struct cli_args *args;
    const char *label;  // what is warned of
    int say;            // on stderr
    int count;
};

static void warn(struct warner *w, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void warn(struct warner *w, const char *format, ...)
{
    char text[2048];
    va_list list;
    w->count++;
    if (!w->say)
        return;
    va_start(list, format);
    vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    tool_print_line("%s: %s", w->label, text);
}

static const char *depth_name(const struct warner *w, const struct cli_view *v)
{
    return w->args->depth_file ? w->args->depth_file : v->view->depth;
}

// All is infinitely far.
static int is_empty(const struct cli_view *v)
{
    return v->setup.model != CLI_MODEL_COC &&
           v->report.no_surface == (uint64_t)v->view->width * (uint64_t)v->view->height;
}

static int is_sharp(const struct cli_view *v)
{
    return v->least_radius < CLI_SHARP_RADIUS;
}

static void warn_samples(struct warner *w, const struct cli_view *v)
{
    const struct hf_report *r = &v->report;
    if (r->colour_repaired)
        warn(w, "%" PRIu64 " colour samples were NaN or infinite, neighbours took their place", r->colour_repaired);
    if (r->depth_repaired)
        warn(w, "%" PRIu64 " depth samples were NaN, neighbours took their place", r->depth_repaired);
    if (v->found.flipped)
        warn(w, "depth %s is negative, so the camera looks along -z: taken without its sign", depth_name(w, v));
    if (v->found.negative)
        warn(w, "%" PRIu64 " samples of depth %s are negative and count as no surface", v->found.negative,
             depth_name(w, v));
}

// A picture of whole numbers that is taken for distances.
static int is_unscaled_map(const struct cli_args *args)
{
    return args->depth_file && !cli_is_exr(args->depth_file) && args->depth_type == HF_DEPTH_VIEW &&
           !args->normalized && isnan(args->depth_scale);
}

static void warn_focus(struct warner *w, const struct cli_view *v)
{
    if (is_empty(v))
        warn(w,
             "depth %s has no surface anywhere, so everything is infinitely far: is it the right channel, and "
             "--depth-type %s?",
             depth_name(w, v), cli_depth_type_name(w->args));
    else if (!is_sharp(v))
        warn(w, "nothing is in focus: all is blurred by %.3g pixels or more%s", v->least_radius,
             is_unscaled_map(w->args) ? "; the numbers of a map are 0 to 1, is it --depth-type normalized or inverse?"
                                      : "");
}

// What was asked for and cannot be had.
static void warn_options(struct warner *w, const struct cli_view *v)
{
    const struct hf_highlight_params *p = &v->setup.params.highlight;
    if (v->setup.missed)
        warn(w, "no setting errs as little as --max-error %g: the most accurate is expected to err %.3g",
             w->args->max_error, v->setup.choice.error);
    if (p->gain > 1 && v->highlights == 0)
        warn(w, "no pixel is brighter than %g, so --highlight-gain %g changes nothing: see --highlight-threshold",
             p->threshold, p->gain);
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

static void warn_view(struct warner *w, const struct cli_view *v)
{
    w->label = v->label;
    warn_lens(w, v);
    warn_samples(w, v);
    warn_focus(w, v);
    warn_options(w, v);
    w->count += v->warned;
}

// Layers that could be blurred too, of a file of which only the main one is.
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

static void warn_frame(struct warner *w)
{
    w->label = w->args->input;
    warn_layers(w);
}

int cli_warnings_of(const struct cli_frame *frame, const struct cli_view *v)
{
    struct warner w = {.frame = frame, .args = frame->args};
    warn_view(&w, v);
    return w.count;
}

int cli_print_warnings(const struct cli_frame *frame)
{
    struct warner w = {.frame = frame, .args = frame->args, .say = 1};
    warn_frame(&w);
    for (int i = 0; i < frame->view_count; i++)
        warn_view(&w, &frame->views[i]);
    w.label = frame->args->output;
    if (frame->written.clamped)
        warn(&w, "%" PRIu64 " samples did not fit their channels and were clamped", frame->written.clamped);
    if (frame->written.note[0])
        tool_print_line("%s", frame->written.note);
    return w.count + (frame->written.note[0] != '\0');
}

void cli_print_early_warnings(const struct cli_frame *frame)
{
    struct warner w = {.frame = frame, .args = frame->args, .say = 1};
    warn_frame(&w);
    for (int i = 0; i < frame->view_count; i++) {
        w.label = frame->views[i].label;
        warn_lens(&w, &frame->views[i]);
    }
}
