// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/track.h"

#include <math.h>
#include <stdlib.h>

#include "tools/cli/focus.h"
#include "tools/cli/frame.h"

// A frame whose focus is read.
struct look {
    double place;  // its number, or its place in a list without numbers
    int view;
    int wanted;
    float focus;
    struct cli_around *around;  // of a focus that follows a surface
    const struct cli_job *job;
};

struct tracker {
    const struct cli_args *args;
    const struct cli_keys *keys;
    struct look *looks;
    int count;
    int follows;  // the surface of the first frame
};

void cli_frame_args(struct cli_args *args, const struct cli_args *all, const struct cli_job *job,
                    const struct cli_keys *keys)
{
    *args = *all;
    args->input = job->input;
    args->output = job->output;
    args->depth_file = job->depth_file;
    args->others = (const char **)job->others;
    if (job->view_file)
        args->views = NULL;  // --views names files here, not views in a file
    if (!args->keys)
        return;
    const double frame = job->numbered ? job->frame : job->place;
    float *const to[CLI_KEY_COUNT] = {
        [CLI_KEY_FOCUS] = &args->focus,
        [CLI_KEY_RANGE] = &args->range,
        [CLI_KEY_STRENGTH] = &args->strength,
        [CLI_KEY_FSTOP] = &args->fstop,
        [CLI_KEY_FOCAL_LENGTH] = &args->focal_length,
        [CLI_KEY_MAX_RADIUS] = &args->params.max_radius,
    };
    for (int k = 0; k < CLI_KEY_COUNT; k++)
        if (to[k] && keys->column[k].count)
            *to[k] = (float)cli_keys_at(keys, k, frame);
    if (keys->column[CLI_KEY_FOCUS_X].count) {
        args->focus_by = CLI_FOCUS_AT;
        args->focus_x = (int)lround(cli_keys_at(keys, CLI_KEY_FOCUS_X, frame));
        args->focus_y = (int)lround(cli_keys_at(keys, CLI_KEY_FOCUS_Y, frame));
    }
    if (keys->column[CLI_KEY_FOCUS].count) {
        args->focus_by = CLI_FOCUS_DISTANCE;
        args->focus_from = "--keys";
    }
}

int cli_track_wanted(const struct cli_args *args, const struct cli_keys *keys)
{
    const int pixel = cli_focus_needs_depth(args) || (args->keys && keys->column[CLI_KEY_FOCUS_X].count);
    return pixel && !(args->keys && keys->column[CLI_KEY_FOCUS].count) && !args->focus_per_view;
}

static void look_at(void *arg, int i, int worker)
{
    const struct tracker *t = arg;
    struct look *l = &t->looks[i];
    struct cli_args args;
    struct cli_frame frame;
    struct tool_error error;
    (void)worker;
    l->focus = NAN;
    if (!l->wanted)
        return;
    cli_frame_args(&args, t->args, l->job, t->keys);
    if (!cli_frame_open(&frame, &args, NULL, &error) && !t->follows)
        cli_frame_focus(&frame, &l->focus, &error);
    else if (frame.file && t->follows && (l->around = calloc(1, sizeof(*l->around))) &&
             cli_frame_around(&frame, l->around, &error))
        l->around->count = 0;
    cli_frame_close(&frame);
}

// The surface of the first frame, from frame to frame: the median of what lies around the pixel and is nearly as near as
// the surface was in the frame before. Where there is too little of that, something else is in front of it, and it counts
// as where it was.
static void follow(struct tracker *t)
{
    static const float SAME = 0.1f,
                       STEP = 0.15f;  // parts of the nearness: within the first frame, and from one to the next
    enum { LEAST = 50 };              // one pixel in so many is enough
    float near = NAN;
    for (int i = 0; i < t->count; i++) {
        struct look *l = &t->looks[i];
        const struct cli_around *around = l->around;
        int count = 0;
        if (around && around->count && isnan(near)) {
            near = cli_focus_median(around, around->own, SAME, NULL);
        } else if (around && around->count) {
            const float here = cli_focus_median(around, near, STEP, &count);
            near = count > 0 && count >= around->count / LEAST ? here : near;
        }
        l->focus = 1 / near;
        free(l->around);
        l->around = NULL;
    }
}

static int by_place(const void *a, const void *b)
{
    const struct look *x = a, *y = b;
    return (x->place > y->place) - (x->place < y->place);
}

static double place_of(const struct cli_job *job)
{
    return job->numbered ? job->frame : job->place;
}

// Index of the first entry of t->looks at `place` or after it.
static int first_from(const struct tracker *t, double place)
{
    int low = 0, high = t->count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (t->looks[middle].place < place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static float mean(const struct tracker *t, double place, int reach)
{
    double sum = 0, weights = 0;
    for (int i = first_from(t, place - reach); i < t->count && t->looks[i].place <= place + reach; i++) {
        const struct look *l = &t->looks[i];
        if (!isfinite(l->focus) || l->focus <= 0)
            continue;
        const double weight = reach + 1 - fabs(l->place - place);
        sum += weight / l->focus;
        weights += weight;
    }
    return weights > 0 ? (float)(weights / sum) : NAN;
}

int cli_track(float *focus, const struct cli_shot *shot, const struct cli_args *args, const struct cli_keys *keys,
              const struct hf_io_run *run, struct tool_error *error)
{
    const struct cli_jobs *jobs = &shot->jobs, *around = shot->around.count ? &shot->around : jobs;
    const int reach = args->focus_smooth < 0 ? CLI_FOCUS_SMOOTH : args->focus_smooth;
    // Keys say where to look themselves.
    const int keyed = args->keys && keys->column[CLI_KEY_FOCUS_X].count;
    struct tracker t = {.args = args, .keys = keys, .follows = args->focus_by == CLI_FOCUS_AT && !keyed};
    int last = -1;
    t.looks = calloc((size_t)around->count, sizeof(*t.looks));
    if (!t.looks)
        return tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", args->input);
    // If each view is a file of its own, the focus is read from the first view.
    for (int i = 0; i < around->count; i++)
        if (around->list[i].view <= 0)
            t.looks[t.count++] = (struct look){.place = place_of(&around->list[i]), .job = &around->list[i]};
    qsort(t.looks, (size_t)t.count, sizeof(*t.looks), by_place);
    for (int i = 0; i < jobs->count; i++)
        for (int k = first_from(&t, place_of(&jobs->list[i]) - reach);
             k < t.count && t.looks[k].place <= place_of(&jobs->list[i]) + reach; k++) {
            t.looks[k].wanted = 1;
            last = last > k ? last : k;
        }
    // What is followed comes from the first frame of all.
    for (int k = 0; k <= last && t.follows; k++)
        t.looks[k].wanted = 1;
    hf_io_run(run, t.count, look_at, &t);
    if (t.follows)
        follow(&t);
    for (int i = 0; i < jobs->count; i++)
        focus[i] = mean(&t, place_of(&jobs->list[i]), reach);
    free(t.looks);
    return 0;
}
