// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/plan.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "tools/cli/room.h"
#include "tools/cli/track.h"

static const double LITTLE_WAIT = 0.02;
static const double MOST_WAIT = 3;  // more frames at once do not make a disk faster
static const double GIB = 1024. * 1024 * 1024;

int cli_plan_threads(const struct cli_args *args)
{
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return args->threads ? args->threads : online > 0 ? (int)online : 1;
}

int cli_plan_open(struct cli_plan *plan, const struct cli_args *args, const struct cli_shot *shot,
                  struct tool_error *error)
{
    *plan = (struct cli_plan){.args = args, .shot = shot};
    int status = args->keys ? cli_keys_load(&plan->keys, args->keys, args->keys_blend == CLI_KEYS_SMOOTH, error) : 0;
    if (!status && !isnan(args->world_unit))
        cli_keys_scale(&plan->keys, args->world_unit);
    if (!status && args->focus_smooth > 0 && !cli_track_wanted(args, &plan->keys))
        return tool_fail(error, CLI_BAD_ARGUMENTS, "--focus-smooth %d is of no use: --keys %s has the focus itself",
                         args->focus_smooth, args->keys);
    if (status || !shot->jobs.count || !cli_track_wanted(args, &plan->keys))
        return status;
    struct hf_io_run run = {0};
    plan->focus = malloc((size_t)shot->jobs.count * sizeof(*plan->focus));
    if (!plan->focus)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
    hf_io_threads_open(&run, cli_plan_threads(args));
    status = cli_track(plan->focus, shot, args, &plan->keys, &run, error);
    hf_io_threads_close(&run);
    return status;
}

void cli_plan_close(struct cli_plan *plan)
{
    cli_keys_free(&plan->keys);
    free(plan->focus);
    plan->focus = NULL;
}

void cli_plan_args(const struct cli_plan *plan, int i, struct cli_args *args)
{
    cli_frame_args(args, plan->args, &plan->shot->jobs.list[i], &plan->keys);
    if (!plan->focus || isnan(plan->focus[i]))
        return;
    args->focus_from = args->focus_by == CLI_FOCUS_CENTER   ? "--focus center"
                       : args->focus_by == CLI_FOCUS_OBJECT ? "--focus-object"
                                                            : "--focus-at";
    args->focus_by = CLI_FOCUS_DISTANCE;
    args->focus = plan->focus[i];
}

double cli_plan_frame_bytes(const struct cli_frame *frame, double library)
{
    return library + cli_room_file_bytes(frame);
}

double cli_plan_memory_limit(const struct cli_args *args)
{
    if (!isnan(args->memory_limit))
        return args->memory_limit * GIB;
    const double half = 0.5 * (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    return half < 2 * GIB ? half : 2 * GIB;
}

// Two threads make a frame in half the time, with half the memory of two frames, whose pages the system has to find
// and clear first. But both threads wait while that frame waits for the disk. If that takes long, each thread gets a
// frame of its own; so it does if another process reads or writes frames, which mostly works on one thread.
static int busy_with(int threads, int helped, double wait)
{
    return wait < LITTLE_WAIT && !helped ? (threads + 1) / 2 : (int)lround(threads * (1 + fmin(wait, MOST_WAIT)));
}

int cli_plan_workers(const struct cli_args *args, int frames, int helped, double wait, double base, double frame_bytes)
{
    const double limit = cli_plan_memory_limit(args), fit = floor((limit - base) / frame_bytes);
    const int busy = busy_with(cli_plan_threads(args), helped, wait);
    const int most = frames < 1 ? 1 : frames < busy ? frames : busy;
    if (fit < 1)
        tool_print_line("a frame takes %.2f GiB, more than the limit of %.3g GiB: one at a time",
                        (base + frame_bytes) / GIB, limit / GIB);
    // A time budget learns from frame to frame in one context, so the frames are made one at a time.
    return fit < 1 || args->params.run.budget_ms > 0 ? 1 : fit < most ? (int)fit : most;
}
