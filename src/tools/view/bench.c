// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tools/common/machine.h"
#include "tools/view/demo.h"
#include "tools/view/say.h"

enum { STEPS = 300, WARM = 30, SIZES = 2 };
#define STEP_MS (1000.0 / 60)
#define NEAREST 1.5
#define FARTHEST 20.0

static const struct {
    const char *name;
    int width, height;
} sizes[SIZES] = {{"1080p", 1920, 1080}, {"4K", 3840, 2160}};

struct view_bench {
    int size, step, answered, shown;
    unsigned serial[STEPS + WARM];
    double asked[STEPS + WARM], latency[STEPS + WARM];
    double start, last_ms, standard_ms;
    guint tick;
};

static void begin_size(struct view_app *app);

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// The warming steps do not count.
static void print(struct view_app *app)
{
    struct view_bench *b = app->bench;
    double sorted[STEPS];
    int answered = 0;
    for (int i = WARM; i < STEPS + WARM; i++)
        if (b->latency[i] >= 0)
            sorted[answered++] = b->latency[i];
    qsort(sorted, (size_t)answered, sizeof(*sorted), by_value);
    printf(
        "%-6s event to pixels: median %.1f ms, 99th %.1f ms; %d of %d frames dropped, %d events lost; standard %.0f ms "
        "after the last event; canvas %d x %d\n",
        sizes[b->size].name, answered ? sorted[answered / 2] : NAN, answered ? sorted[answered * 99 / 100] : NAN,
        STEPS - MIN(b->shown, STEPS), STEPS, STEPS - answered, b->standard_ms, gtk_widget_get_width(app->canvas),
        gtk_widget_get_height(app->canvas));
    fflush(stdout);
}

static void end_size(struct view_app *app)
{
    struct view_bench *b = app->bench;
    print(app);
    if (++b->size < SIZES)
        begin_size(app);
    else
        g_idle_add(view_window_close, app);
}

// A step of the pull, 60 times a second, whether the one before is on the screen or not.
static void pull(struct view_app *app)
{
    struct view_bench *b = app->bench;
    const double t = (double)b->step / (STEPS + WARM), s = 0.5 - 0.5 * cos(4 * M_PI * t);
    b->asked[b->step] = app->event_ms = b->start + b->step * STEP_MS;
    b->latency[b->step] = -1;
    app->setup.params.focus = (float)(1 / (1 / NEAREST + s * (1 / FARTHEST - 1 / NEAREST)));
    view_app_ask(app, b->step + 1 < STEPS + WARM);
    b->serial[b->step++] = app->serial;
    b->last_ms = tool_now_ms();
}

static gboolean on_time(gpointer data)
{
    struct view_app *app = data;
    struct view_bench *b = app->bench;
    if (!b || !b->tick || !app->window)
        return G_SOURCE_REMOVE;
    while (b->step < STEPS + WARM && tool_now_ms() >= b->start + b->step * STEP_MS)
        pull(app);
    if (b->step < STEPS + WARM)
        return G_SOURCE_CONTINUE;
    b->tick = 0;
    return G_SOURCE_REMOVE;
}

void view_bench_drawn(struct view_app *app, const struct view_result *r)
{
    struct view_bench *b = app->bench;
    const double now = tool_now_ms();
    if (!b)
        return;
    if (!b->start) {  // the first picture at rest: begin
        if (r->stage != VIEW_FINAL)
            return;
        b->start = now;
        b->tick = g_timeout_add(1, on_time, app);
        return;
    }
    if (r->stage == VIEW_QUICK || b->step < STEPS + WARM)
        b->shown += b->answered >= WARM;
    while (b->answered < b->step && b->serial[b->answered] <= r->serial) {
        b->latency[b->answered] = now - b->asked[b->answered];
        b->answered++;
    }
    if (b->step == STEPS + WARM && r->serial == b->serial[b->step - 1] && r->stage != VIEW_QUICK) {
        b->standard_ms = now - b->last_ms;
        b->start = 0;
        end_size(app);
    }
}

static void begin_size(struct view_app *app)
{
    struct view_bench *b = app->bench;
    struct view_picture *picture = view_scene_picture(sizes[b->size].width, sizes[b->size].height, 3);
    const int size = b->size;
    *b = (struct view_bench){.size = size};
    if (!picture) {
        view_app_tell(app, "there is not enough memory for the picture");
        return;
    }
    view_app_use(app, picture);
    view_picture_unref(picture);
    view_app_ask(app, 0);
}

void view_bench_begin(struct view_app *app)
{
    app->bench = g_new0(struct view_bench, 1);
    begin_size(app);
}

void view_bench_free(struct view_app *app)
{
    g_free(app->bench);
    app->bench = NULL;
}
