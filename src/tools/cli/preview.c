// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/preview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tools/cli/frame.h"
#include "tools/cli/plan.h"
#include "tools/cli/progress.h"
#include "tools/cli/resume.h"
#include "tools/cli/warn.h"
#include "tools/common/report.h"

// How long encoding takes by how long decoding does, zlib at its usual level: a rough figure, said to be one.
static const double ENCODE_BY_DECODE = 2.5;

static void print_jobs(const struct cli_plan *plan, int *left)
{
    const struct cli_shot *shot = plan->shot;
    for (int i = 0; i < shot->jobs.count; i++) {
        struct cli_args args;
        struct cli_stamp stamp;
        char name[TOOL_SHOWN], other[TOOL_SHOWN];
        cli_plan_args(plan, i, &args);
        const int skip =
            args.resume && args.output && !cli_stamp_make(&stamp, &args) ? cli_stamp_fits(&stamp, args.output) : 0;
        if (args.resume && args.output)
            cli_stamp_free(&stamp);
        *left += !skip;
        printf("%s -> %s", tool_shown(args.input, name),
               args.output ? tool_shown(args.output, other) : "nothing, as there is no -o");
        if (args.depth_file)
            printf(", depth from %s", tool_shown(args.depth_file, name));
        for (int k = 0; k < args.other_count; k++)
            printf(", %s %s", args.other_option + 2, tool_shown(args.others[k], name));
        if (args.focus_by == CLI_FOCUS_DISTANCE)
            printf(", focus %.4g", args.focus);
        printf("%s\n", skip ? ", is there already" : "");
    }
}

// The first frame whose file is readable; frame 0 if none is.
static int first_there(const struct cli_shot *shot)
{
    for (int i = 0; i < shot->jobs.count; i++)
        if (!access(shot->jobs.list[i].input, R_OK))
            return i;
    return 0;
}

struct cli_expected cli_expect(const struct cli_frame *frame, const struct cli_session *session)
{
    struct tool_report report = {0};
    tool_report_get(session->context, &report);
    const double defocus = frame->view_count * report.all.predicted_ms;
    const double files = frame->ms[CLI_READ] + frame->ms[CLI_DECODE] * (1 + ENCODE_BY_DECODE);
    return (struct cli_expected){session->base, cli_plan_frame_bytes(frame, (double)report.all.memory_needed),
                                 files + defocus, defocus,
                                 hf_io_is_helped(frame->file, frame->args->output, frame->args->compression)};
}

// Look at a frame as if to render it.
static int expect(const struct cli_plan *plan, int left, struct tool_error *error)
{
    struct cli_args args;
    struct cli_session session = {0};
    struct cli_frame frame = {0};
    cli_plan_args(plan, first_there(plan->shot), &args);
    int status = cli_session_open(&session, &args, cli_plan_threads(&args), error);
    if (!status)
        status = cli_frame_open(&frame, &args, &session.run, error);
    if (!status)
        status = cli_frame_setup(&frame, error);
    if (!status)
        status = cli_frame_plan(&frame, &session, error);
    if (!status) {
        const struct cli_expected e = cli_expect(&frame, &session);
        const int workers = cli_plan_workers(&args, plan->shot->jobs.count, e.helped, 0, e.base, e.bytes);
        printf("%d frames, %d at a time; a frame takes about %.0f MiB, all at once %.0f MiB\n", left, workers,
               e.bytes / (1 << 20), (e.base + workers * e.bytes) / (1 << 20));
        printf("expected: %.0f ms for a frame alone, defocus %.0f ms of it; about %.0f s for all\n", e.ms, e.defocus_ms,
               e.ms * left / 1000);
        cli_print_warnings(&frame);
    }
    cli_frame_close(&frame);
    cli_session_close(&session);
    return status;
}

int cli_preview(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error)
{
    struct cli_plan plan;
    int left = 0;
    int status = cli_plan_open(&plan, args, shot, error);
    if (!status && args->log_file)
        tool_print_line("--log %s: a dry run makes no frames, so nothing is logged", args->log_file);
    if (!status)
        print_jobs(&plan, &left);
    if (!status)
        status = expect(&plan, left, error);
    cli_plan_close(&plan);
    return status;
}

int cli_print_focus(const struct cli_args *args, const struct cli_shot *shot, struct tool_error *error)
{
    struct cli_plan plan;
    int failed = 0;
    int status = cli_plan_open(&plan, args, shot, error);
    if (!status)
        printf("frame,focus\n");
    for (int i = 0; i < shot->jobs.count && !status; i++) {
        const struct cli_job *job = &shot->jobs.list[i];
        struct cli_args own;
        struct cli_frame frame;
        float focus = NAN;
        if (job->view > 0)
            continue;
        cli_plan_args(&plan, i, &own);
        int bad = cli_frame_open(&frame, &own, NULL, error);
        if (!bad)
            bad = cli_frame_focus(&frame, &focus, error);
        if (bad)
            tool_print_line("%s", error->text);
        else
            printf("%d,%.6g\n", job->numbered ? job->frame : job->place, focus);
        failed += bad != 0;
        cli_frame_close(&frame);
    }
    cli_plan_close(&plan);
    return status ? status : !failed ? CLI_DONE : failed < shot->jobs.count ? CLI_SOME_FAILED : CLI_ALL_FAILED;
}
