// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/json.h"

#include "tools/cli/choose.h"
#include "tools/cli/explain.h"
#include "tools/cli/guessed.h"
#include "tools/cli/preview.h"
#include "tools/cli/summary.h"
#include "tools/cli/surfaces.h"
#include "tools/cli/warn.h"
#include "tools/common/json.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tools/io/out.h"
#include "tools/common/report.h"

static void put_model(struct tool_json *j, const struct cli_setup *setup)
{
    const struct hf_params *p = &setup->params;
    tool_json_text(j, "model", cli_model_name(setup->model));
    if (setup->focus_from && p->focus == INFINITY)
        tool_json_text(j, "focus", "inf");
    else
        tool_json_number(j, "focus", setup->focus_from && p->focus != HF_DERIVE ? p->focus : NAN);
    tool_json_text(j, "focus_from", setup->focus_from);
    if (setup->model != CLI_MODEL_LENS)
        return;
    tool_json_number(j, "fstop", p->lens.f_number);
    tool_json_number(j, "focal_length", p->lens.focal_length_mm);
    tool_json_number(j, "sensor_width", p->lens.sensor_width_mm);
    tool_json_number(j, "world_unit", p->lens.world_unit_m);
}

static void put_stats(struct tool_json *j, const struct cli_view *v, const struct cli_frame *frame)
{
    const struct tool_report *s = &v->report;
    const double pixels = (double)v->view->width * v->view->height;
    tool_json_number(j, "max_radius", s->params.max_radius);
    tool_json_text(j, "limit", hf_name(HF_NAMES_LIMIT, (int)s->used.limit));
    tool_json_flag(j, "limited", cli_is_limited(v));
    tool_json_number(j, "near_share", (double)s->all.near_pixels / pixels);
    tool_json_number(j, "sharp_share", (double)s->all.sharp_pixels / pixels);
    tool_json_number(j, "far_share", (double)s->all.far_pixels / pixels);
    tool_json_count(j, "colour_repaired", (long long)s->all.colour_repaired);
    tool_json_count(j, "depth_repaired", (long long)s->all.depth_repaired);
    tool_json_count(j, "no_surface", (long long)s->all.no_surface);
    // The file layer counts the samples of all views together, so with several views the sum stands beside them.
    tool_json_count(j, "clamped", (long long)(s->all.clamped + (frame->view_count == 1 ? frame->written.clamped : 0)));
    tool_json_flag(j, "depth_negative", v->found.flipped);
    tool_json_number(j, "least_radius", v->least_radius);
    if (s->params.engine == HF_ENGINE_GAUSSIAN) {
        tool_json_number(j, "sigma", s->params.gaussian.sigma);
        tool_json_number(j, "near_blend", v->blend[0]);
        tool_json_number(j, "far_blend", v->blend[1]);
    }
    tool_json_count(j, "cut", v->cut);
    cli_guessed_json(j, frame, v);
    if (v->setup.params.highlight.gain > 1) {
        tool_json_count(j, "highlights", (long long)v->highlights);
        tool_json_count(j, "lamps", v->lamps);
    }
    tool_json_count(j, "warnings", cli_warnings_of(frame, v));
    tool_json_ms(j, "total_ms", s->all.total_ms);
    if (v->setup.params.run.budget_ms > 0)
        tool_json_flag(j, "budget_missed", cli_missed_budget(v));
    tool_json_open(j, "passes", '[');
    for (int i = 0; i < tool_passes(s->params.engine); i++) {
        tool_json_row(j, NULL, '{');
        tool_json_text(j, "name", hf_inspect_pass_name(s->params.engine, i));
        tool_json_ms(j, "ms", s->pass[i].ms);
        tool_json_close(j);
    }
    tool_json_close(j);
}

static void put_pass(struct tool_json *j, const struct hf_inspect_pass *p)
{
    tool_json_row(j, NULL, '{');
    tool_json_text(j, "name", p->name);
    tool_json_count(j, "run", p->run);
    tool_json_count(j, "all", p->all);
    tool_json_ms(j, "predicted_ms", p->predicted_ms);
    tool_json_ms(j, "ms", p->ms);
    if (p->skipped)
        tool_json_text(j, "skipped", p->skipped);
    tool_json_close(j);
}

static void put_report(struct tool_json *j, const struct tool_report *r)
{
    const struct hf_params *used = &r->params;
    tool_json_open(j, "plan", '{');
    tool_json_text(j, "engine", hf_engine_name(used->engine));
    tool_json_text(j, "resolution", hf_name(HF_NAMES_RESOLUTION, (int)cli_explain_resolution(used)));
    tool_json_count(j, "rings", used->engine == HF_ENGINE_CHAPTER && !r->used.sharp ? used->chapter.rings : 0);
    tool_json_count(j, "budget_step", r->all.budget_step);
    tool_json_text(j, "budget_options", r->inner.budget_options);
    tool_json_row(j, "tile_size", '[');
    tool_json_count(j, NULL, r->inner.tile_width);
    tool_json_count(j, NULL, r->inner.tile_height);
    tool_json_close(j);
    tool_json_row(j, "tiles", '{');
    tool_json_count(j, "sharp", r->inner.tile_count[HF_TILE_SHARP]);
    tool_json_count(j, "near", r->inner.tile_count[HF_TILE_NEAR]);
    tool_json_count(j, "far", r->inner.tile_count[HF_TILE_FAR]);
    tool_json_count(j, "both", r->inner.tile_count[HF_TILE_BOTH]);
    tool_json_close(j);
    if (r->inner.colour_known) {
        tool_json_number(j, "brightest", r->inner.brightest);
        tool_json_flag(j, "opaque", r->inner.opaque);
        tool_json_count(j, "not_finite", (long long)r->inner.not_finite);
    }
    tool_json_number(j, "near_radius", r->all.near_radius);
    tool_json_number(j, "far_radius", r->all.far_radius);
    if (used->engine == HF_ENGINE_LAYERS) {
        tool_json_row(j, "slices", '[');
        for (int i = 0; i < 4; i++)
            tool_json_count(j, NULL, r->inner.slices[i]);
        tool_json_close(j);
        tool_json_count(j, "hidden_levels", r->inner.hidden_levels);
    }
    tool_json_count(j, "memory", (long long)r->all.memory);
    tool_json_count(j, "memory_saved", (long long)r->inner.memory_saved);
    tool_json_ms(j, "plan_ms", r->inner.plan_ms);
    tool_json_ms(j, "predicted_ms", r->all.predicted_ms);
    tool_json_open(j, "passes", '[');
    for (int i = 0; i < r->inner.passes; i++)
        put_pass(j, &r->pass[i]);
    tool_json_close(j);
    tool_json_close(j);
}

// Both corners lie in the window.
static void put_window(struct tool_json *j, const char *name, const struct hf_io_box *box)
{
    tool_json_row(j, name, '[');
    tool_json_count(j, NULL, box->x0);
    tool_json_count(j, NULL, box->y0);
    tool_json_count(j, NULL, box->x1 - 1);
    tool_json_count(j, NULL, box->y1 - 1);
    tool_json_close(j);
}

void cli_json_surfaces(struct tool_json *j, const struct cli_view *v)
{
    char name[TOOL_SHOWN + 300];
    if (!v->surface_count)
        return;
    tool_json_open(j, "surfaces", '[');
    for (int k = 0; k < v->surface_count; k++)
        tool_json_text(j, NULL, cli_surface_name(&v->surfaces[k], name, sizeof(name)));
    tool_json_close(j);
}

void cli_json_map(struct tool_json *j, const struct cli_view *v)
{
    if (v->map_bits || v->sharpened)
        tool_json_count(j, "depth_sharpened", v->sharpened);
    if (v->smoothed)
        tool_json_count(j, "depth_smoothed", v->smoothed);
    if (!v->map_size[0])
        return;
    tool_json_row(j, "depth_scaled_from", '[');
    tool_json_count(j, NULL, v->map_size[0]);
    tool_json_count(j, NULL, v->map_size[1]);
    tool_json_close(j);
}

static void put_view(struct tool_json *j, const struct cli_view *v, const struct cli_frame *frame)
{
    tool_json_open(j, NULL, '{');
    tool_json_text(j, "name", v->view->name);
    tool_json_text(j, "layer", v->view->layer);
    tool_json_row(j, "colour", '[');
    for (int c = 0; c < 4; c++)
        if (v->view->colour[c][0])
            tool_json_text(j, NULL, v->view->colour[c]);
    tool_json_close(j);
    tool_json_text(j, "depth", frame->args->depth_file ? frame->args->depth_file : v->view->depth);
    tool_json_text(j, "depth_type", cli_depth_type_name(frame->args));
    cli_json_surfaces(j, v);
    cli_json_map(j, v);
    tool_json_count(j, "width", v->view->width);
    tool_json_count(j, "height", v->view->height);
    put_window(j, "data_window", &v->view->data_window);
    put_window(j, "display_window", &v->view->display_window);
    put_model(j, &v->setup);
    tool_json_number(j, "highlight_gain", v->setup.params.highlight.gain);
    if (v->setup.params.highlight.gain > 1)
        tool_json_number(j, "highlight_threshold", v->setup.params.highlight.threshold);
    cli_choose_json(j, &v->setup, 1e-6 * v->view->width * v->view->height);
    if (!frame->args->dry_run)
        put_stats(j, v, frame);
    if (v->tiles)
        put_report(j, &v->report);
    tool_json_close(j);
}

void cli_write_json(FILE *out, int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session)
{
    const struct cli_args *args = frame->args;
    struct tool_json j;
    tool_json_begin(&j, out, 0);
    tool_json_command(&j, "command", argc, argv);
    tool_json_machine(&j, argc - 1, argv + 1);
    tool_json_text(&j, "input", args->input);
    tool_json_text(&j, "output", args->output);
    tool_json_text(&j, "engine", hf_engine_name(frame->views[0].setup.params.engine));
    tool_json_text(&j, "isa", hf_isa_name(hf_context_isa(session->context)));
    tool_json_count(&j, "threads", hf_context_threads(session->context));
    tool_json_text(&j, "storage", hf_name(HF_NAMES_STORAGE, (int)frame->views[0].setup.params.gather.storage));
    if (args->dry_run) {
        const struct cli_expected e = cli_expect(frame, session);
        tool_json_flag(&j, "dry_run", 1);
        tool_json_count(&j, "expected_memory", (long long)(e.base + e.bytes));
        tool_json_ms(&j, "expected_ms", e.ms);
        tool_json_ms(&j, "expected_defocus_ms", e.defocus_ms);
    } else {
        tool_json_ms(&j, "read_ms", frame->ms[CLI_READ] + frame->ms[CLI_DECODE]);
        tool_json_ms(&j, "write_ms", frame->ms[CLI_ENCODE] + frame->ms[CLI_WRITE]);
        tool_json_count(&j, "clamped", (long long)frame->written.clamped);
        tool_json_text(&j, "note", frame->written.note[0] ? frame->written.note : NULL);
    }
    tool_json_flag(&j, "in_place", frame->in_place);
    cli_json_warnings(&j, frame);
    tool_json_open(&j, "views", '[');
    for (int i = 0; i < frame->view_count; i++)
        put_view(&j, &frame->views[i], frame);
    tool_json_end(&j);
}

static int write_device(int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session,
                        struct tool_error *error)
{
    const char *path = frame->args->json_file;
    FILE *out = fopen(path, "w");
    if (!out)
        return tool_fail(error, CLI_ALL_FAILED, "--json %s cannot be written: %s", path, strerror(errno));
    cli_write_json(out, argc, argv, frame, session);
    const int failed = ferror(out);
    if (fclose(out) || failed)
        return tool_fail(error, CLI_ALL_FAILED, "--json %s could not be written", path);
    return 0;
}

int cli_write_json_file(int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session,
                        struct tool_error *error)
{
    struct hf_out out;
    struct hf_io_error io;
    struct stat st;
    if (!stat(frame->args->json_file, &st) && !S_ISREG(st.st_mode))
        return write_device(argc, argv, frame, session, error);
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    int failed = !memory;
    if (memory) {
        cli_write_json(memory, argc, argv, frame, session);
        failed = ferror(memory);
        failed |= fclose(memory);
    }
    int status = hf_out_open(&out, frame->args->json_file, &io);
    if (!status && failed)
        status = hf_io_fail(&io, "%s: out of memory", frame->args->json_file);
    if (!status)
        status = hf_out_write(&out, text, size, &io);
    if (!status)
        status = hf_out_commit(&out, &io);
    hf_out_abort(&out);
    free(text);
    return status ? tool_fail(error, CLI_ALL_FAILED, "--json %s", io.message) : 0;
}
