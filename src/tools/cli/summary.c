// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/summary.h"

#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

#include "tools/cli/choose.h"
#include "tools/cli/lens.h"
#include "tools/common/report.h"

int cli_missed_budget(const struct cli_view *v)
{
    const struct tool_report *r = &v->report;
    return v->setup.params.run.budget_ms > 0 && r->all.total_ms > v->setup.params.run.budget_ms;
}

int cli_is_limited(const struct cli_view *v)
{
    const struct tool_report *r = &v->report;
    const float most = r->params.max_radius;
    return v->setup.model != CLI_MODEL_RANGE && (r->all.near_radius >= most || r->all.far_radius >= most);
}

// What limits the radius.
static const char *limit_words(enum hf_limit limit)
{
    switch (limit) {
    case HF_LIMIT_GIVEN:
        return "by --max-radius";
    case HF_LIMIT_MODEL:
        return "unless --max-radius says otherwise";
    case HF_LIMIT_ENGINE:
        return "as far as this engine reaches without --max-radius";
    case HF_LIMIT_PICTURE:
        return "as large as a picture of the aperture is drawn";
    default:
        return "the most that there can be";
    }
}

static void print_view(const struct cli_frame *frame, const struct cli_view *v, int warnings)
{
    const struct tool_report *r = &v->report;
    const struct hf_params *p = &r->params;
    const char *depth = frame->args->depth_file ? frame->args->depth_file : v->view->depth;
    const float budget = frame->args->params.run.budget_ms;
    char text[1024];
    int n = 0;
    if (v->surface_count)
        n += snprintf(text, sizeof(text), "%d %s, ", v->surface_count + 1,
                      cli_others_peel(frame->args) ? "surfaces" : "pictures of one scene");
    if (v->map_size[0])
        n += snprintf(text, sizeof(text), "%d x %d scaled to %d x %d, ", v->map_size[0], v->map_size[1],
                      v->scaled_to[0], v->scaled_to[1]);
    if (v->sharpened)
        n += snprintf(text + n, sizeof(text) - (size_t)n, "%lld samples beside outlines sharpened, ", v->sharpened);
    if (v->smoothed)
        n += snprintf(text + n, sizeof(text) - (size_t)n, "%lld samples of slopes smoothed, ", v->smoothed);
    n += snprintf(text + n, sizeof(text) - (size_t)n, "%s", hf_engine_name(p->engine));
    if (v->setup.choice.inner.options)
        n += snprintf(text + n, sizeof(text) - (size_t)n, " (%s chose %s)", cli_choice_option(frame->args).text,
                      v->setup.choice.inner.options);
    if (v->setup.model == CLI_MODEL_LENS)
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", f/%g %g mm%s", p->lens.f_number, p->lens.focal_length_mm,
                      cli_lens_from(frame->args, &v->view->camera));
    if (v->setup.focus_from)
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", focus %.4g (%s)", p->focus, v->setup.focus_from);
    if (p->engine == HF_ENGINE_GAUSSIAN)
        n += snprintf(text + n, sizeof(text) - (size_t)n,
                      ", standard deviation %.1f mixed in up to near %.0f %% far %.0f %%", p->gaussian.sigma,
                      100 * v->blend[0], 100 * v->blend[1]);
    else
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", radius near %.1f far %.1f", r->all.near_radius,
                      r->all.far_radius);
    if (cli_is_limited(v) && p->engine != HF_ENGINE_GAUSSIAN)
        n +=
            snprintf(text + n, sizeof(text) - (size_t)n, " (cut to %g, %s)", p->max_radius, limit_words(r->used.limit));
    const struct hf_highlight_params *light = &v->setup.params.highlight;
    if (light->gain > 1)
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", %d lamps, %" PRIu64 " pixels above %g raised, 1 to %g",
                      v->lamps, v->highlights, light->threshold, light->gain);
    if (frame->args->guessed)
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", %.3g %% of the light guessed", 100 * v->guess.share);
    if (r->all.budget_step)
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", --budget-ms %g chose %s, %d below what was asked for",
                      budget, r->inner.budget_options, r->all.budget_step);
    if (cli_missed_budget(v))
        n += snprintf(text + n, sizeof(text) - (size_t)n, ", longer than --budget-ms %g", budget);
    snprintf(text + n, sizeof(text) - (size_t)n, ", %.0f ms, %d warning%s", r->all.total_ms, warnings,
             warnings == 1 ? "" : "s");
    const char *part = frame->args->depth_file ? "" : hf_io_part_name(frame->file, v->view->depth_part);
    tool_print_line("%s: %s with depth %s%s%s, %s", v->label, v->view->layer[0] ? v->view->layer : "RGB", depth,
                    part[0] ? " of part " : "", part, text);
}

void cli_print_summary(const struct cli_frame *frame, int warnings)
{
    if (frame->args->quiet || (!frame->args->verbose && !isatty(2)))
        return;
    for (int i = 0; i < frame->view_count; i++)
        print_view(frame, &frame->views[i], warnings);
}

int cli_print_resolved(const struct cli_view *v, struct tool_error *error)
{
    struct hf_params p = {.size = sizeof(p)};
    struct hf_resolved r = {.size = sizeof(r)};
    struct hf_message message = {.size = sizeof(message)};
    char sentence[TOOL_SENTENCE];
    // A focus that comes from the picture is not known before the picture is read.
    if (v->setup.params.focus == HF_DERIVE && v->setup.model != CLI_MODEL_COC)
        return 0;
    if (hf_resolve(v->view->width, v->view->height, &v->setup.depth, &v->setup.params, &p, &r, &message))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s: %s", v->label, tool_sentence(&cli_program, &message, sentence));
    const struct hf_range_params *range = &p.range;
    if (r.limit == HF_LIMIT_NONE)
        printf("    radius limited only by the largest allowed, %g pixels\n", p.max_radius);
    else
        printf("    radius up to %g pixels, %s\n", p.max_radius, limit_words(r.limit));
    if (v->setup.model == CLI_MODEL_RANGE)
        printf("    near blur full up to %g, none from %g; far blur none up to %g, full from %g\n",
               range->near_begin > 0 ? range->near_begin : 0, range->near_end, range->far_begin, range->far_end);
    if (v->setup.model == CLI_MODEL_LENS)
        printf("    focal length %.6g pixels; radius %.6g * (1/focus - 1/distance)\n", r.focal_px, r.lens_k);
    if (p.engine == HF_ENGINE_CHAPTER)
        printf("    %d ring%s of taps\n", p.chapter.rings, p.chapter.rings == 1 ? "" : "s");
    if (p.engine == HF_ENGINE_GAUSSIAN)
        printf("    standard deviation %.4g pixels, blend by %s\n", p.gaussian.sigma,
               p.gaussian.by_depth ? "depth" : "radius");
    if (p.highlight.gain > 1)
        printf("    highlights above %g raised, 1 to %g\n", p.highlight.threshold, p.highlight.gain);
    if (r.sharp)
        printf("    nothing will be blurred\n");
    return 0;
}

void cli_print_sandbox(void)
{
    if (hf_io_sandbox())
        tool_print_line("%s", hf_io_sandbox());
}
