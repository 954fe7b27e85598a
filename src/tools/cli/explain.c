// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/explain.h"

#include <stdlib.h>
#include <string.h>

#include "tools/cli/choose.h"
#include "tools/common/report.h"

int cli_explain_keep(struct cli_view *v, struct hf_context *context, struct tool_error *error)
{
    const size_t tiles = hf_inspect_tiles(context, NULL, 0);
    v->tiles = malloc(tiles + 1);
    if (!v->tiles)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    hf_inspect_tiles(context, v->tiles, tiles);
    return 0;
}

enum hf_resolution cli_explain_resolution(const struct hf_params *p)
{
    switch (p->engine) {
    case HF_ENGINE_HEXAGON:
        return p->hexagon.resolution;
    case HF_ENGINE_SCATTER:
        return p->scatter.resolution;
    case HF_ENGINE_GAUSSIAN:
        return p->gaussian.resolution;
    default:
        return HF_RESOLUTION_FULL;
    }
}

// Of layers: "28 slices (9 full, 19 half resolution), hidden samples at 5 distances".
static void print_slices(FILE *out, const struct tool_report *r)
{
    static const char *const sizes[4] = {"full", "half", "quarter", "eighth"};
    const int all = r->inner.slices[0] + r->inner.slices[1] + r->inner.slices[2] + r->inner.slices[3];
    fprintf(out, ", %d slice%s", all, all == 1 ? "" : "s");
    for (int i = 0, shown = 0; i < 4; i++)
        if (r->inner.slices[i])
            fprintf(out, "%s%d %s", shown++ ? ", " : " (", r->inner.slices[i], sizes[i]);
    fprintf(out, "%s", all ? " resolution)" : "");
    if (r->inner.hidden_levels)
        fprintf(out, ", hidden samples at %d distances", r->inner.hidden_levels);
}

static void print_settings(FILE *out, const struct cli_args *args, const struct cli_view *v)
{
    const struct tool_report *r = &v->report;
    const struct hf_params *p = &r->params;
    const int rings = p->chapter.rings;
    fprintf(out, "  engine %s", hf_engine_name(p->engine));
    if (args->chose_chapter && p->engine == HF_ENGINE_CHAPTER)
        fprintf(out, ", as --engine gather with --%s is", args->chose_chapter);
    if (p->engine == HF_ENGINE_CHAPTER)
        fprintf(out, ", %d ring%s of taps", rings, rings == 1 ? "" : "s");
    else if (p->engine == HF_ENGINE_LAYERS)
        print_slices(out, r);
    else if (p->engine == HF_ENGINE_GATHER)
        fprintf(out, ", half resolution");
    else
        fprintf(out, ", %s resolution", hf_name(HF_NAMES_RESOLUTION, (int)cli_explain_resolution(p)));
    if (r->all.budget_step > 0)
        fprintf(out, ", %d step%s below what was asked for, to keep the budget: %s", r->all.budget_step,
                r->all.budget_step == 1 ? "" : "s", r->inner.budget_options);
    if (p->engine == HF_ENGINE_GAUSSIAN)
        fprintf(out, "\n  standard deviation: %.2f pixels, of which at most %.0f %% are mixed in near, %.0f %% far\n",
                p->gaussian.sigma, 100 * v->blend[0], 100 * v->blend[1]);
    else
        fprintf(out, "\n  largest CoC radius: near %.2f, far %.2f pixels\n", r->all.near_radius, r->all.far_radius);
    const struct hf_highlight_params *light = &v->setup.params.highlight;
    if (light->gain > 1)
        fprintf(out, "  highlights above %g raised while they are blurred, 1 to %g: %d lamps\n", light->threshold,
                light->gain, v->lamps);
    if (r->inner.colour_known)
        fprintf(out, "  colour to blur: up to %g, %s, %llu samples not finite\n", r->inner.brightest,
                r->inner.opaque ? "opaque" : "with alpha below 1", (unsigned long long)r->inner.not_finite);
    fprintf(out, "  tiles of %d x %d pixels: %u sharp, %u near, %u far, %u both\n", r->inner.tile_width,
            r->inner.tile_height, r->inner.tile_count[HF_TILE_SHARP], r->inner.tile_count[HF_TILE_NEAR],
            r->inner.tile_count[HF_TILE_FAR], r->inner.tile_count[HF_TILE_BOTH]);
}

static void print_report(FILE *out, const struct cli_args *args, const struct cli_view *v, int ran)
{
    const struct tool_report *r = &v->report;
    print_settings(out, args, v);
    fprintf(out, "  %-18s %7s %9s %13s %12s   %s\n", "pass", "runs on", "skips", "predicted ms",
            ran ? "measured ms" : "", "because");
    for (int i = 0; i < r->inner.passes; i++) {
        const struct hf_inspect_pass *p = &r->pass[i];
        fprintf(out, "  %-18s %7u %9u %13.3f ", p->name, p->run, p->all - p->run, p->predicted_ms);
        if (ran)
            fprintf(out, "%12.3f", p->ms);
        else
            fprintf(out, "%12s", "");
        fprintf(out, "   %s\n", p->skipped ? p->skipped : "");
    }
    fprintf(out, "  %-18s %7s %9s %13.3f ", "frame", "", "", r->all.predicted_ms);
    if (ran)
        fprintf(out, "%12.3f   of which planning %.3f\n", r->all.total_ms, r->inner.plan_ms);
    else
        fprintf(out, "\n");
    fprintf(out, "  memory for buffers: %.1f MB; skipping saves %.1f MB\n", (double)r->all.memory * 1e-6,
            (double)r->inner.memory_saved * 1e-6);
}

void cli_explain_print(FILE *out, const struct cli_frame *frame, int ran)
{
    for (int i = 0; i < frame->view_count; i++) {
        const struct hf_io_view *view = frame->views[i].view;
        char name[TOOL_SHOWN];
        fprintf(out, "%s\n", tool_shown(frame->views[i].label, name));
        cli_choose_print(out, frame->args, &frame->views[i].setup, 1e-6 * view->width * view->height);
        print_report(out, frame->args, &frame->views[i], ran);
    }
}
