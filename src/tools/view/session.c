// SPDX-License-Identifier: BSD-3-Clause
// From the model to the picture: loading, setting up, asking the renderer.
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/track.h"
#include "tools/common/machine.h"
#include "tools/view/app.h"
#include "tools/view/keys_file.h"
#include "tools/view/say.h"
#include "tools/view/timeline.h"

enum { GLIDE_MS = 240, SETTLE_MS = 300 };

void view_app_tell(struct view_app *app, const char *format, ...)
{
    va_list values;
    char text[TOOL_SENTENCE * 4] = "";
    if (format) {
        va_start(values, format);
        vsnprintf(text, sizeof(text), format, values);
        va_end(values);
        view_say("notice %s", text);
    }
    gtk_label_set_text(GTK_LABEL(app->notice_text), text);
    gtk_widget_set_visible(app->notice, format != NULL);
}

// Asking.

void view_app_ask(struct view_app *app, int moving)
{
    struct view_request request = {.picture = app->picture,
                                   .params = app->setup.params,
                                   .depth = app->setup.depth,
                                   .moving = moving,
                                   .gain = exp2f(app->model.now.exposure),
                                   .show = app->show,
                                   .asked_ms = app->event_ms > 0 ? app->event_ms : tool_now_ms()};
    app->event_ms = 0;
    if (!app->picture || !app->set_up || !view_canvas_seen(VIEW_CANVAS(app->canvas), &request.seen, &request.n))
        return;
    memcpy(request.buffer, app->buffer, sizeof(request.buffer));
    view_canvas_set_gain(VIEW_CANVAS(app->canvas), request.gain);
    app->serial = view_renderer_ask(app->renderer, &request);
}

static void end_glide(struct view_app *app)
{
    if (app->glide_tick)
        gtk_widget_remove_tick_callback(app->canvas, app->glide_tick);
    app->glide_tick = 0;
}

// Blur is linear in the inverse distance, and so is the glide.
static gboolean on_glide(GtkWidget *widget, GdkFrameClock *clock, gpointer data)
{
    struct view_app *app = data;
    const double t = fmin(1, (tool_now_ms() - app->glide_start) / GLIDE_MS), s = t * t * (3 - 2 * t);
    const double from = 1 / app->glide_from, to = 1 / app->glide_to;
    (void)widget;
    (void)clock;
    app->setup.params.focus = t < 1 ? (float)(1 / (from + s * (to - from))) : app->glide_to;
    if (t >= 1)
        app->glide_tick = 0;
    view_app_ask(app, t < 1);
    return t < 1;
}

void view_app_glide(struct view_app *app, float from)
{
    view_app_apply(app);
    const float to = app->setup.params.focus;
    if (!app->set_up || !(from > 0) || !(to > 0) || from == to)
        return;
    app->glide_from = from;
    app->glide_to = to;
    app->glide_start = tool_now_ms();
    app->glide_tick = gtk_widget_add_tick_callback(app->canvas, on_glide, app, NULL);
}

// Setting up.

static const struct hf_image *find_aperture(const struct view_app *app, const char *path)
{
    for (guint i = 0; app->apertures && i < app->apertures->len; i++) {
        const struct view_aperture *a = app->apertures->pdata[i];
        if (!strcmp(a->path, path))
            return &a->read.image;
    }
    return NULL;
}

static void free_aperture(gpointer data)
{
    struct view_aperture *a = data;
    cli_aperture_free(&a->read);
    free(a->path);
    free(a);
}

// The aperture's picture, read once for each name.
static int set_aperture(struct view_app *app, struct cli_args *args, struct tool_error *error)
{
    if (!args->aperture_file)
        return 0;
    args->params.aperture.picture = find_aperture(app, args->aperture_file);
    if (args->params.aperture.picture)
        return 0;
    struct view_aperture *a = calloc(1, sizeof(*a));
    if (a)
        a->path = strdup(args->aperture_file);
    const int status = a && a->path ? cli_aperture_load(&a->read, args, error) : tool_fail(error, -1, "out of memory");
    if (status) {
        if (a)
            free_aperture(a);
        return status;
    }
    if (!app->apertures)
        app->apertures = g_ptr_array_new_with_free_func(free_aperture);
    g_ptr_array_add(app->apertures, a);
    return 0;
}

static int set_up_by(struct view_app *app, const struct cli_args *args, struct tool_error *error)
{
    struct cli_args own = *args, keyed;
    const struct cli_job *job = app->shot.jobs.count ? &app->shot.jobs.list[app->frame] : NULL;
    int status = set_aperture(app, &own, error);
    if (status)
        return status;
    own.keys = job && view_keys_any(&app->model.now.keys) ? "keys" : NULL;
    keyed = own;
    if (own.keys)
        cli_frame_args(&keyed, &own, job, &app->model.now.keys);
    return view_picture_setup(app->picture, &keyed, &app->setup, error);
}

static int set_up(struct view_app *app, struct tool_error *error)
{
    struct view_words words;
    struct cli_args args;
    const char *keys = view_keys_any(&app->model.now.keys) ? "keys" : NULL;
    if (view_model_words(&app->model, NULL, keys, &words))
        return tool_fail(error, -1, "out of memory");
    int status = view_words_parse(&words, &args, error);
    if (!status)
        status = set_up_by(app, &args, error);
    // Without a focus in the header there must be one all the same: the middle, then some distance.
    static const char *const others[] = {"center", "10"};
    const int focus = view_option_place("focus"), free_choice = args.focus_by == CLI_FOCUS_HEADER;
    for (int i = 0; i < 2 && status && free_choice; i++) {
        int dropped;
        cli_free_args(&args);
        view_words_free(&words);
        if (view_model_set(&app->model, focus, others[i], 0, &dropped, error) ||
            view_model_words(&app->model, NULL, keys, &words))
            return -1;
        status = view_words_parse(&words, &args, error);
        if (!status)
            status = set_up_by(app, &args, error);
    }
    cli_free_args(&args);
    view_words_free(&words);
    return status;
}

// What changes what is loaded, as one text: options, and the view that is shown.
static char *loading_options(const struct view_app *app)
{
    GString *text = g_string_new(NULL);
    for (int i = 0; i < view_option_count(); i++) {
        const struct tool_option *o = view_option(i);
        const int loads = o->group == TOOL_DEPTH || !strcmp(o->name, "views") || !strcmp(o->name, "layer") ||
                          !strcmp(o->name, "display");
        if (loads && app->model.now.value[i])
            g_string_append_printf(text, "--%s %s\n", o->name, app->model.now.value[i]);
    }
    g_string_append_printf(text, "view %d\n", app->view);
    return g_string_free(text, FALSE);
}

void view_app_apply(struct view_app *app)
{
    struct tool_error error;
    end_glide(app);
    char *loaded_by = loading_options(app);
    const int again = app->loaded_by && strcmp(loaded_by, app->loaded_by);
    g_free(loaded_by);
    if (app->model.input_count && again) {
        view_app_load(app);
        return;
    }
    if (app->picture) {
        struct cli_setup before = app->setup;
        if (set_up(app, &error)) {
            app->setup = before;
            view_app_tell(app, "%s", error.text);
        } else {
            app->set_up = 1;
        }
        view_app_ask(app, app->playing);
    }
    view_window_refresh(app);
}

int view_app_set(struct view_app *app, int option, const char *value, int merge)
{
    struct tool_error error;
    int dropped;
    if (view_model_set(&app->model, option, value, merge, &dropped, &error)) {
        view_app_tell(app, "%s", error.text);
        view_window_refresh(app);
        return -1;
    }
    if (dropped >= 0)
        view_app_tell(app, "--%s was taken back, as it cannot stand beside --%s", view_option(dropped)->name,
                      view_option(option)->name);
    else
        view_app_tell(app, NULL);
    return 0;
}

void view_app_focus_at(struct view_app *app, double x, double y)
{
    const struct cli_view *v = app->picture ? view_picture_view(app->picture) : NULL;
    const float from = app->setup.params.focus;
    char value[64];
    float z;
    if (!v || x < 0 || y < 0 || x >= v->view->width || y >= v->view->height || app->setup.model == CLI_MODEL_COC)
        return;
    if (hf_depth_at(&app->setup.depth, v->view->width, v->view->height, (int)x, (int)y, &z, NULL) != HF_OK) {
        view_app_tell(app, "There is no surface at this place to focus on.");
        return;
    }
    if (view_timeline_focus(app, z)) {
        view_app_glide(app, from);
        return;
    }
    snprintf(value, sizeof(value), "%d,%d", v->view->data_window.x0 + (int)x, v->view->data_window.y0 + (int)y);
    if (!view_app_set(app, view_option_place("focus-at"), value, 0))
        view_app_glide(app, from);
}

void view_app_undo(struct view_app *app, int redo)
{
    struct cli_keys before;
    if (view_keys_copy(&before, &app->model.now.keys)) {
        view_app_tell(app, "out of memory");
        return;
    }
    if (redo ? view_model_redo(&app->model) : view_model_undo(&app->model)) {
        view_app_tell(app, NULL);
        if (!view_keys_same(&before, &app->model.now.keys))
            view_keys_changed(app);
        view_app_apply(app);
    }
    cli_keys_free(&before);
}

// Loading, on a thread of its own.

static void read_ahead(struct view_app *app);

struct load {
    struct view_app *app;
    int number, frame, view;
    int shot;   // which of those that were opened
    int ahead;  // nobody waits for it
    struct view_words words;
    char *input, *depth_file, *loaded_by;
    struct view_picture *picture;
    struct tool_error error;
};

static void free_load(gpointer data)
{
    struct load *l = data;
    view_words_free(&l->words);
    free(l->input);
    free(l->depth_file);
    g_free(l->loaded_by);
    view_picture_unref(l->picture);
    free(l);
}

static void load_thread(GTask *task, gpointer source, gpointer data, GCancellable *cancellable)
{
    struct load *l = data;
    (void)source;
    (void)cancellable;
    l->picture = view_picture_load(&l->words, l->input, l->depth_file, l->view, &l->error);
    g_task_return_boolean(task, TRUE);
}

static gboolean on_settled(gpointer data)
{
    struct view_app *app = data;
    app->reload = 0;
    const int changed = app->window && app->picture ? view_picture_changed(app->picture) : 0;
    if (changed == 2)
        view_app_tell(app, "%s is gone; the picture is the one that was read before.", app->picture->args.input);
    else if (changed) {
        view_app_tell(app, "%s has been replaced and was read again.", app->picture->args.input);
        view_frames_drop(&app->frames, app->frame);
        view_app_load(app);
    }
    return G_SOURCE_REMOVE;
}

// A file is written in many steps: look at it when it has been left alone for a while.
static void on_file_event(GFileMonitor *monitor, GFile *file, GFile *other, GFileMonitorEvent event, gpointer data)
{
    struct view_app *app = data;
    (void)monitor;
    (void)file;
    (void)other;
    (void)event;
    if (app->reload)
        g_source_remove(app->reload);
    app->reload = g_timeout_add(SETTLE_MS, on_settled, app);
}

static void watch(struct view_app *app)
{
    if (app->monitor)
        g_object_unref(app->monitor);
    GFile *file = g_file_new_for_path(app->picture->args.input);
    app->monitor = g_file_monitor_file(file, G_FILE_MONITOR_WATCH_MOVES, NULL, NULL);
    g_object_unref(file);
    if (app->monitor)
        g_signal_connect(app->monitor, "changed", G_CALLBACK(on_file_event), app);
}

static void use_picture(struct view_app *app, struct view_picture *picture, char *loaded_by)
{
    const int first = !app->picture;
    const int other =
        !first && (view_picture_view(picture)->view->width != view_picture_view(app->picture)->view->width ||
                   view_picture_view(picture)->view->height != view_picture_view(app->picture)->view->height);
    view_picture_unref(app->picture);
    app->picture = view_picture_ref(picture);
    g_free(app->loaded_by);
    app->loaded_by = g_strdup(loaded_by);
    app->set_up = 0;
    view_canvas_set_picture(VIEW_CANVAS(app->canvas), picture, first || other);
    watch(app);
    view_say("loaded %s %dx%d", picture->args.input, view_picture_view(picture)->view->width,
             view_picture_view(picture)->view->height);
    view_app_apply(app);
}

void view_app_use(struct view_app *app, struct view_picture *picture)
{
    struct tool_error error;
    view_picture_unref(app->picture);
    app->picture = view_picture_ref(picture);
    view_canvas_set_picture(VIEW_CANVAS(app->canvas), picture, 1);
    app->set_up = !set_up(app, &error);
    if (!app->set_up)
        view_app_tell(app, "%s", error.text);
}

static void on_loaded(GObject *source, GAsyncResult *result, gpointer data)
{
    struct view_app *app = data;
    struct load *l = g_task_get_task_data(G_TASK(result));
    (void)source;
    if (!app->window)
        return;
    const int current = app->loaded_by && !strcmp(l->loaded_by, app->loaded_by);
    if (l->ahead)
        app->reading_ahead = 0;
    if (l->picture && (current || !l->ahead) && l->shot == app->shots)
        view_frames_put(&app->frames, l->frame, l->picture, app->frame);
    if (l->ahead || l->number != app->loading) {
        if (current && l->picture)
            read_ahead(app);
        return;
    }
    app->load_pending = 0;
    if (l->picture) {
        use_picture(app, l->picture, l->loaded_by);
        read_ahead(app);
    } else {
        view_app_tell(app, "%s", l->error.text);
        view_window_refresh(app);
    }
}

// Read a frame on a thread.
static void start_load(struct view_app *app, int frame, int ahead)
{
    const struct cli_job *job = app->shot.jobs.count ? &app->shot.jobs.list[frame] : NULL;
    struct load *l = calloc(1, sizeof(*l));
    if (!l || view_model_words(&app->model, NULL, NULL, &l->words)) {
        free(l);
        view_app_tell(app, "there is not enough memory for the picture");
        return;
    }
    l->app = app;
    l->frame = frame;
    l->ahead = ahead;
    l->view = app->view;
    l->shot = app->shots;
    l->number = ahead ? 0 : ++app->loading;
    l->input = job && job->input ? strdup(job->input) : NULL;
    l->depth_file = job && job->depth_file ? strdup(job->depth_file) : NULL;
    l->loaded_by = loading_options(app);
    GTask *task = g_task_new(NULL, NULL, on_loaded, app);
    g_task_set_task_data(task, l, free_load);
    g_task_run_in_thread(task, load_thread);
    g_object_unref(task);
}

static void read_ahead(struct view_app *app)
{
    const int next = app->reading_ahead || app->load_pending ? -1 : view_frames_ahead(&app->frames, app->frame);
    if (next < 0)
        return;
    app->reading_ahead = 1;
    start_load(app, next, 1);
}

void view_app_load(struct view_app *app)
{
    char *loaded_by = loading_options(app);
    const int same = app->loaded_by && !strcmp(loaded_by, app->loaded_by);
    struct view_picture *held = same ? view_frames_get(&app->frames, app->frame) : NULL;
    if (!same)
        view_frames_open(&app->frames, app->shot.jobs.count);
    if (held) {
        app->loading++;  // what is being read is not wanted any more
        app->load_pending = 0;
        use_picture(app, held, loaded_by);
        read_ahead(app);
    } else {
        app->load_pending = 1;
        start_load(app, app->frame, 0);
    }
    g_free(loaded_by);
}

// The files of the shot that the inputs name.
static int find_shot(struct view_app *app, struct tool_error *error)
{
    struct view_words words;
    struct cli_args args;
    if (view_model_words(&app->model, NULL, NULL, &words))
        return tool_fail(error, -1, "out of memory");
    int status = view_words_parse(&words, &args, error);
    if (!status) {
        const struct cli_shot_request request = {.inputs = args.inputs,
                                                 .input_count = args.input_count,
                                                 .depth_file = args.depth_file,
                                                 .frames = args.frames,
                                                 .chunk = args.chunk,
                                                 .views = args.views};
        cli_shot_free(&app->shot);
        app->frame = 0;
        status = cli_shot_make(&app->shot, &request, error);
    }
    cli_free_args(&args);
    view_words_free(&words);
    if (status)
        cli_shot_free(&app->shot);
    return status;
}

void view_app_open(struct view_app *app, char *const *names, int count)
{
    struct tool_error error;
    if (names && view_model_open_files(&app->model, names, count)) {
        view_app_tell(app, "out of memory");
        return;
    }
    if (find_shot(app, &error)) {
        view_app_tell(app, "%s", error.text);
        view_window_refresh(app);
        return;
    }
    if (names)
        view_app_tell(app, NULL);
    app->shots++;
    view_frames_open(&app->frames, app->shot.jobs.count);
    view_keys_begin(app);
    view_timeline_refresh(app);
    view_app_load(app);
}
