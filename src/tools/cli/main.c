// SPDX-License-Identifier: BSD-3-Clause
// hyperfocal INPUT -o OUTPUT. args.c says what to do, setup.c and frame.c do it, and this file writes to stdout and
// stderr.
#include "tools/cli/aperture.h"
#include "tools/cli/batch.h"
#include "tools/cli/explain.h"
#include "tools/cli/frame.h"
#include "tools/cli/guessed.h"
#include "tools/cli/json.h"
#include "tools/cli/lens.h"
#include "tools/cli/overlay.h"
#include "tools/cli/pattern.h"
#include "tools/cli/preview.h"
#include "tools/cli/summary.h"
#include "tools/cli/surfaces.h"
#include "tools/cli/target.h"
#include "tools/cli/warn.h"
#include "tools/common/standard.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int print_plan(const struct cli_frame *frame, const struct cli_session *session, struct tool_error *error)
{
    const struct cli_args *args = frame->args;
    char name[TOOL_SHOWN], other[TOOL_SHOWN], third[TOOL_SHOWN];
    printf("%s: would write %s%s\n", tool_shown(args->input, name),
           args->output ? tool_shown(args->output, other) : "nothing, as there is no -o",
           frame->in_place ? ", over the input" : "");
    const struct hf_params *first = &frame->views[0].setup.params;
    printf("  engine %s, ", hf_engine_name(first->engine));
    if (first->engine == HF_ENGINE_GATHER || first->engine == HF_ENGINE_CHAPTER)
        printf("%s storage, ", hf_name(HF_NAMES_STORAGE, (int)first->gather.storage));
    if (first->engine == HF_ENGINE_LAYERS)
        printf("%s quality, ", hf_name(HF_NAMES_LAYERS, (int)first->layers.quality));
    printf("%d threads, %s\n", hf_context_threads(session->context), hf_isa_name(hf_context_isa(session->context)));
    for (int i = 0; i < frame->view_count; i++) {
        const struct cli_view *v = &frame->views[i];
        const struct hf_io_box *data = &v->view->data_window, *display = &v->view->display_window;
        const struct hf_params *p = &v->setup.params;
        printf("  view %s%s%s: %d x %d, data window %d,%d to %d,%d, display window %d,%d to %d,%d\n",
               v->view->name[0] ? tool_shown(v->view->name, name) : "(no name)", v->view->layer[0] ? ", layer " : "",
               tool_shown(v->view->layer, other), v->view->width, v->view->height, data->x0, data->y0, data->x1 - 1,
               data->y1 - 1, display->x0, display->y0, display->x1 - 1, display->y1 - 1);
        const char *part = hf_io_part_name(frame->file, v->view->part);
        const char *depth_part = args->depth_file ? "" : hf_io_part_name(frame->file, v->view->depth_part);
        printf("    colour");
        for (int c = 0; c < 4; c++)
            if (v->view->colour[c][0])
                printf("%s %s", c ? "," : "", tool_shown(v->view->colour[c], name));
        printf("%s%s\n    depth %s%s%s, type %s\n", part[0] ? " of part " : "", tool_shown(part, other),
               tool_shown(args->depth_file ? args->depth_file : v->view->depth, name), depth_part[0] ? " of part " : "",
               tool_shown(depth_part, third), cli_depth_type_name(args));
        for (int k = 0; k < v->surface_count; k++)
            printf(
                "    %s %s, depth %s\n", args->other_option && v->surfaces[k].file ? args->other_option + 2 : "merge",
                cli_surface_name(&v->surfaces[k], name, sizeof(name)), tool_shown(v->surfaces[k].view->depth, other));
        printf("    model %s", cli_model_name(v->setup.model));
        if (v->setup.model == CLI_MODEL_LENS)
            printf(", f/%g, focal length %g mm, sensor %g mm%s, world unit %g m", p->lens.f_number,
                   p->lens.focal_length_mm, p->lens.sensor_width_mm, cli_lens_from(args, &v->view->camera),
                   p->lens.world_unit_m);
        const int autofocus = p->focus == HF_DERIVE;  // no number yet
        if (autofocus)
            printf(", focus from %s", v->setup.focus_from);
        else if (v->setup.focus_from)
            printf(", focus %g from %s", p->focus, v->setup.focus_from);
        if (v->setup.model == CLI_MODEL_RANGE && p->range.distance != HF_DERIVE)
            printf(", range %g", p->range.distance);
        else if (v->setup.model == CLI_MODEL_RANGE && !autofocus)
            printf(", range %g", p->focus / 2);
        if (v->setup.model == CLI_MODEL_RANGE)
            printf(", strength %g", p->range.strength);
        printf("\n");
        const int status = cli_print_resolved(v, error);
        if (status)
            return status;
    }
    const struct cli_expected e = cli_expect(frame, session);
    printf("  expected: %.0f MiB, %.0f ms, defocus %.0f ms of it\n", (e.base + e.bytes) / (1 << 20), e.ms,
           e.defocus_ms);
    return 0;
}

static int write_json(int argc, char **argv, const struct cli_frame *frame, const struct cli_session *session,
                      struct tool_error *error)
{
    if (frame->args->json_file)
        return cli_write_json_file(argc, argv, frame, session, error);
    cli_write_json(stdout, argc, argv, frame, session);  // main() checks stdout for errors
    return 0;
}

static int run_frame(int argc, char **argv, const struct cli_args *args, struct cli_session *session,
                     struct tool_error *error)
{
    struct cli_frame frame;
    int status = cli_frame_open(&frame, args, &session->run, error);
    frame.alone = 1;
    if (status && access(args->input, F_OK))
        status = CLI_BAD_ARGUMENTS;  // the command line names what does not exist
    if (!status)
        status = cli_frame_setup(&frame, error);
    if (!status)
        status = cli_overlay_check(&frame, error);
    if (!status && !args->dry_run)
        status = cli_frame_render(&frame, session, error);
    else if (!status)
        status = cli_frame_plan(&frame, session, error);
    if (!status && !args->dry_run)
        status = cli_frame_encode(&frame, NULL, 0, error);
    if (!status && !args->dry_run) {
        status = cli_frame_save(&frame, error);
        if (!status)
            cli_print_summary(&frame, cli_print_warnings(&frame));
        if (!status)
            cli_guessed_print(&frame);
    }
    if (!status)
        status = cli_overlay_write(&frame, error);
    if (!status && args->json)
        status = write_json(argc, argv, &frame, session, error);
    if (!status && args->dry_run && (!args->json || args->json_file))
        status = print_plan(&frame, session, error);
    if (!status && args->dry_run)
        cli_print_warnings(&frame);
    // If programs read JSON from stdout, the table for people goes to stderr.
    if (!status && args->explain)
        cli_explain_print(args->json && !args->json_file ? stderr : stdout, &frame, !args->dry_run);
    if (args->verbose || args->explain)
        cli_print_sandbox();
    cli_frame_close(&frame);
    return status;
}

// Refuse options that describe a single frame when there is a shot.
static int check_alone(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error)
{
    const char *option = args->json            ? "--json"
                         : args->explain       ? "--explain"
                         : args->explain_image ? "--explain-image"
                         : args->focus_image   ? "--focus-image"
                         : args->guessed_image ? "--guessed-image"
                         : args->dump_dir      ? "--dump-passes"
                                               : NULL;
    if (option)
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "%s is for one picture by its own name; for a shot, also of one frame, there is --log",
                         option);
    if (args->resume && args->output && !cli_is_exr(args->output))
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "--resume needs an EXR OUTPUT, as %s cannot store the settings that made it", args->output);
    if (args->resume && !shot->sequence && cli_is_in_place(args))
        return tool_fail(error, CLI_BAD_ARGUMENTS,
                         "--resume cannot be used where OUTPUT %s is INPUT: it would be unknown which frames are done",
                         args->output);
    return 0;
}

static int run_shot(int argc, char **argv, const struct cli_args *args, const struct cli_shot *shot,
                    struct tool_error *error)
{
    int status = check_alone(args, shot, error);
    if (!status && shot->missing)
        tool_print_line("%d frame%s missing: %s", shot->missing, shot->missing == 1 ? " is" : "s are", shot->gaps);
    if (!status && shot->jobs.count == 0)
        tool_print_line("this process's part of the shot has no frames: nothing to do");
    else if (!status && args->dry_run)
        status = cli_preview(args, shot, error);
    else if (!status)
        status = cli_batch(argc, argv, args, shot, error);
    return status;
}

// Make one frame, with its report.
static int run_alone(int argc, char **argv, const struct cli_args *args, const struct cli_job *job,
                     struct tool_error *error)
{
    struct cli_session session;
    struct cli_args own = *args;
    own.output = job->output;
    own.depth_file = job->depth_file;
    own.others = (const char **)job->others;
    int status = cli_session_open(&session, &own, own.threads, error);
    if (!status)
        status = run_frame(argc, argv, &own, &session, error);
    if (session.context)
        cli_session_close(&session);
    return status;
}

// A file without a number serves all frames, so check it first. Numbered ones are checked with their frames.
static int check_readable(const char *option, const char *path, struct tool_error *error)
{
    if (cli_pattern_has_frame(path) || cli_pattern_has_view(path) || !access(path, R_OK))
        return 0;
    return tool_fail(error, CLI_BAD_ARGUMENTS, "%s %s cannot be read: %s", option, path, strerror(errno));
}

static int run_args(int argc, char **argv, struct cli_args *args, struct tool_error *error)
{
    const struct cli_shot_request request = {.inputs = args->inputs,
                                             .input_count = args->input_count,
                                             .output = args->output,
                                             .depth_file = args->depth_file,
                                             .frames = args->frames,
                                             .chunk = args->chunk,
                                             .others = args->others,
                                             .other_count = args->other_count,
                                             .other_option = args->other_option,
                                             .views = args->views,
                                             .log_file = args->log_file};
    struct cli_shot shot;
    struct cli_aperture aperture = {0};
    int status = cli_shot_make(&shot, &request, error);
    if (!status && args->depth_file)
        status = check_readable("--depth-file", args->depth_file, error);
    for (int i = 0; i < args->other_count && !status; i++)
        status = check_readable(args->other_option, args->others[i], error);
    for (int i = 0; i < shot.jobs.count && !status; i++) {
        struct cli_args own = *args;
        own.input = shot.jobs.list[i].input;
        own.output = shot.jobs.list[i].output;
        own.depth_file = shot.jobs.list[i].depth_file;
        own.others = (const char **)shot.jobs.list[i].others;
        status = cli_check_targets(&own, error);
    }
    if (!status)
        status = cli_aperture_load(&aperture, args, error);
    if (!status && args->print_focus)
        status = cli_print_focus(args, &shot, error);
    else if (!status && cli_batch_wanted(args, &shot))
        status = run_shot(argc, argv, args, &shot, error);
    else if (!status)
        status = run_alone(argc, argv, args, &shot.jobs.list[0], error);
    cli_aperture_free(&aperture);
    cli_shot_free(&shot);
    return status;
}

static int run(int argc, char **argv, struct tool_error *error)
{
    struct cli_args args;
    int status = cli_parse_args(&args, argc, argv, error) ? CLI_BAD_ARGUMENTS : CLI_DONE;
    if (!status && args.quality == HF_QUALITY_HIGH) {
        tool_print_line(
            "--quality high chooses what best does: no setting that is worth having lies between standard and best");
        args.quality = HF_QUALITY_BEST;
    }
    if (!status && args.help > 2)
        tool_print_man(&cli_program);
    else if (!status && args.help)
        tool_print_help(&cli_program, NULL, args.help > 1);
    else if (!status && args.version)
        printf("hyperfocal %s\n", hf_version());
    else if (!status)
        status = run_args(argc, argv, &args, error);
    cli_free_args(&args);
    return status;
}

int main(int argc, char **argv)
{
    tool_open_standard();
    // A file that exceeds the system's size limit is an error, as a full disk is. It must not end the process.
    signal(SIGXFSZ, SIG_IGN);
    hf_io_catch_signals();
    struct tool_error error = {""};
    const int status = run(argc, argv, &error);
    // A shot has already printed its errors, and leaves the text empty.
    return tool_end(status, CLI_ALL_FAILED, &error);
}
