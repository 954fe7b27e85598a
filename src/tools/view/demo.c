// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/demo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/say.h"
#include "tools/view/scene.h"

#define FOLLOW_MS 350.0  // the focus comes to within a third of its goal
#define FADE_MS 600.0

struct view_demo {
    GThread *thread;
    GMutex lock;
    GCond wake;
    int quit, width, height;
    struct view_picture *ready;  // the next frame; NULL: not made yet
    double seconds;
    // On the main thread.
    int frames, drawn, waiting;
    float focus;
    double fade, goal, before_ms;
    guint tick;
};

struct view_picture *view_scene_picture(int width, int height, double seconds)
{
    const size_t n = (size_t)width * (size_t)height * sizeof(float);
    struct hf_io_view view = {.width = width,
                              .height = height,
                              .data_window = {0, 0, width, height},
                              .display_window = {0, 0, width, height},
                              .pixel_aspect = 1,
                              .screen_width = 1};
    view.camera = (struct hf_io_camera){.focus = NAN,
                                        .f_number = 0.4f,
                                        .focal_length_mm = 35,
                                        .sensor_width_mm = 36,
                                        .nominal_length_mm = NAN,
                                        .axis = {NAN}};
    float *planes[4] = {hf_io_alloc(n), hf_io_alloc(n), hf_io_alloc(n), hf_io_alloc(n)};
    if (!planes[0] || !planes[1] || !planes[2] || !planes[3]) {
        for (int c = 0; c < 4; c++)
            free(planes[c]);
        return NULL;
    }
    view_scene(planes, planes[3], width, height, seconds);
    return view_picture_make(&view, planes, planes[3]);
}

static gpointer run(gpointer data)
{
    struct view_demo *d = data;
    const double start = tool_now_ms();
    g_mutex_lock(&d->lock);
    while (!d->quit) {
        if (d->ready || d->width < 1) {
            g_cond_wait(&d->wake, &d->lock);
            continue;
        }
        const int width = d->width, height = d->height;
        g_mutex_unlock(&d->lock);
        struct view_picture *made = view_scene_picture(width, height, (tool_now_ms() - start) / 1000);
        g_mutex_lock(&d->lock);
        d->ready = made;
    }
    g_mutex_unlock(&d->lock);
    return NULL;
}

// The focus follows the middle of the picture, in inverse distance, in which blur is linear.
static void follow(struct view_app *app, double ms)
{
    struct view_demo *d = app->demo;
    const struct cli_view *v = view_picture_view(app->picture);
    const struct hf_io_view *view = v->view;
    const float goal = v->depth[(size_t)(view->height / 2) * (size_t)view->width + (size_t)(view->width / 2)];
    const double step = 1 - exp(-ms / FOLLOW_MS);
    d->focus = d->focus > 0 ? (float)(1 / (1 / d->focus + step * (1 / goal - 1 / d->focus))) : goal;
    const double fade = ms / FADE_MS;
    d->fade = d->goal > d->fade ? fmin(d->goal, d->fade + fade) : fmax(d->goal, d->fade - fade);
    app->setup.params.focus = d->focus;
    if (app->setup.params.model == HF_MODEL_LENS)
        app->setup.params.lens.f_number /= (float)fmax(d->fade, 1e-3);
    else
        app->setup.params.range.strength *= (float)d->fade;
}

static void show(struct view_app *app, struct view_picture *picture)
{
    struct view_demo *d = app->demo;
    const double now = tool_now_ms();
    app->event_ms = now;
    view_app_use(app, picture);
    if (app->set_up) {
        follow(app, fmin(100, now - d->before_ms));
        d->waiting = 1;
        view_app_ask(app, 1);
    }
    d->before_ms = now;
}

int view_demo_done(const struct view_app *app)
{
    return app->demo && app->demo->frames > 0 && app->demo->drawn >= app->demo->frames;
}

// One frame is asked for when the one before is on the screen.
static gboolean on_tick(GtkWidget *widget, GdkFrameClock *clock, gpointer data)
{
    struct view_app *app = data;
    struct view_demo *d = app->demo;
    const int factor = gtk_widget_get_scale_factor(widget);
    (void)clock;
    g_mutex_lock(&d->lock);
    d->width = gtk_widget_get_width(widget) * factor;
    d->height = gtk_widget_get_height(widget) * factor;
    struct view_picture *picture = d->waiting || view_demo_done(app) ? NULL : d->ready;
    if (picture)
        d->ready = NULL;
    g_cond_signal(&d->wake);
    g_mutex_unlock(&d->lock);
    if (picture) {
        show(app, picture);
        view_picture_unref(picture);
    }
    return TRUE;
}

void view_demo_begin(struct view_app *app, int frames)
{
    struct view_demo *d = app->demo = g_new0(struct view_demo, 1);
    d->frames = frames;
    d->goal = 1;
    d->before_ms = tool_now_ms();
    g_mutex_init(&d->lock);
    g_cond_init(&d->wake);
    d->thread = g_thread_new("scene", run, d);
    d->tick = gtk_widget_add_tick_callback(app->canvas, on_tick, app, NULL);
}

void view_demo_end(struct view_app *app)
{
    struct view_demo *d = app->demo;
    if (!d)
        return;
    app->demo = NULL;
    g_mutex_lock(&d->lock);
    d->quit = 1;
    g_cond_signal(&d->wake);
    g_mutex_unlock(&d->lock);
    g_thread_join(d->thread);
    view_picture_unref(d->ready);
    g_mutex_clear(&d->lock);
    g_cond_clear(&d->wake);
    g_free(d);
}

void view_demo_drawn(struct view_app *app)
{
    struct view_demo *d = app->demo;
    if (!d)
        return;
    d->waiting = 0;
    d->drawn++;
    if (d->drawn % 50 == 0)
        view_say("demo %d", d->drawn);
    if (d->frames > 0 && d->drawn == d->frames)
        g_idle_add(view_window_close, app);
}

void view_demo_fade(struct view_app *app)
{
    if (!app->demo)
        return;
    app->demo->goal = app->demo->goal > 0 ? 0 : 1;
    view_say("fade %g", app->demo->goal);
}
