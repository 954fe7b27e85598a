// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/timeline.h"

#include <math.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/keys_file.h"
#include "tools/view/name.h"
#include "tools/view/say.h"

#define RATE 24.0  // frames a second, where neither the header nor the command line says

struct view_timeline {
    GtkWidget *box, *play, *scale, *label, *curves, *smooth;
    guint tick;
    double next_ms;  // when the next frame is due
    int quiet;
};

// One colour for each column, light enough for dark backgrounds and dark enough for light ones.
static const double colours[CLI_KEY_COUNT][3] = {
    {0.9, 0.35, 0.1}, {0.2, 0.55, 0.9}, {0.3, 0.7, 0.3}, {0.75, 0.35, 0.8},
    {0.8, 0.65, 0.1}, {0.1, 0.7, 0.7},  {0.6, 0.6, 0.6}, {0.6, 0.6, 0.6},
};

static int frames_of(const struct view_app *app)
{
    return app->shot.jobs.count;
}

static double frame_at(const struct view_app *app, int place)
{
    const struct cli_job *job = &app->shot.jobs.list[place];
    return job->numbered ? job->frame : job->place;
}

double view_timeline_frame(const struct view_app *app)
{
    return frames_of(app) ? frame_at(app, app->frame) : 0;
}

void view_timeline_go(struct view_app *app, int place)
{
    if (!frames_of(app))
        return;
    app->frame = CLAMP(place, 0, frames_of(app) - 1);
    app->event_ms = tool_now_ms();
    view_app_load(app);
    view_timeline_refresh(app);
    view_say("frame %g", view_timeline_frame(app));
}

static double rate_of(const struct view_app *app)
{
    const double header = app->picture ? view_picture_view(app->picture)->view->frame_rate : 0;
    return app->own.rate > 0 ? app->own.rate : header > 0 ? header : RATE;
}

// Playing: the next frame when it is due and has been read.

static gboolean on_tick(GtkWidget *widget, GdkFrameClock *clock, gpointer data)
{
    struct view_app *app = data;
    struct view_timeline *t = app->timeline;
    const double now = tool_now_ms();
    const int next = (app->frame + 1) % frames_of(app);
    const double step = 1000 / rate_of(app);
    (void)widget;
    (void)clock;
    if (now < t->next_ms || !view_frames_get(&app->frames, next))
        return TRUE;
    t->next_ms = fmax(t->next_ms + step, now - step);
    view_timeline_go(app, next);
    return TRUE;
}

void view_timeline_play(struct view_app *app)
{
    struct view_timeline *t = app->timeline;
    if (frames_of(app) < 2)
        return;
    app->playing = !app->playing;
    gtk_button_set_icon_name(GTK_BUTTON(t->play),
                             app->playing ? "media-playback-pause-symbolic" : "media-playback-start-symbolic");
    view_name(t->play, app->playing ? "Pause" : "Play");
    if (app->playing) {
        view_say("playing at %g", rate_of(app));
        t->next_ms = tool_now_ms();
        t->tick = gtk_widget_add_tick_callback(app->canvas, on_tick, app, NULL);
        view_app_load(app);
        return;
    }
    view_say("paused");
    gtk_widget_remove_tick_callback(app->canvas, t->tick);
    view_app_ask(app, 0);
}

// Keys.

int view_timeline_key_state(struct view_app *app, const char *option)
{
    const int column = view_keys_column(option);
    if (column < 0 || !app->shot.sequence || !frames_of(app))
        return -1;
    return view_keys_find(&app->model.now.keys, column, view_timeline_frame(app)) >= 0;
}

// The value that a column has in the picture now.
static double value_of(const struct view_app *app, int column)
{
    const struct hf_params *p = &app->setup.params;
    struct hf_params filled = {.size = sizeof(filled)};
    const struct hf_io_view *v = view_picture_view(app->picture)->view;
    if (!hf_resolve(v->width, v->height, &app->setup.depth, p, &filled, NULL, NULL))
        p = &filled;
    switch (column) {
    case CLI_KEY_FOCUS:
        return p->focus;
    case CLI_KEY_RANGE:
        return p->range.distance;
    case CLI_KEY_STRENGTH:
        return p->range.strength;
    case CLI_KEY_FSTOP:
        return p->lens.f_number;
    case CLI_KEY_FOCAL_LENGTH:
        return p->lens.focal_length_mm;
    case CLI_KEY_MAX_RADIUS:
        return p->max_radius;
    default:
        return NAN;
    }
}

static void set_key(struct view_app *app, int column, double value)
{
    struct cli_keys *k = &app->model.now.keys;
    int x, y;
    const char *at = view_model_get(&app->model, view_option_place("focus-at"));
    if (column == CLI_KEY_FOCUS_X) {
        if (!at || sscanf(at, "%d,%d", &x, &y) != 2)
            return;
        view_keys_set(k, CLI_KEY_FOCUS_X, view_timeline_frame(app), x);
        view_keys_set(k, CLI_KEY_FOCUS_Y, view_timeline_frame(app), y);
    } else if (isfinite(value) && value >= 0) {
        view_keys_set(k, column, view_timeline_frame(app), value);
    }
    view_keys_changed(app);
}

void view_timeline_toggle(struct view_app *app, const char *option)
{
    const int column = view_keys_column(option);
    if (!app->picture || !app->set_up || view_timeline_key_state(app, option) < 0 || view_model_keep(&app->model, 0))
        return;
    if (view_timeline_key_state(app, option)) {
        view_keys_remove(&app->model.now.keys, column, view_timeline_frame(app));
        if (column == CLI_KEY_FOCUS_X)
            view_keys_remove(&app->model.now.keys, CLI_KEY_FOCUS_Y, view_timeline_frame(app));
        view_keys_changed(app);
    } else {
        set_key(app, column, value_of(app, column));
    }
    view_say("key %s %d", option, view_timeline_key_state(app, option));
    view_app_apply(app);
}

void view_timeline_follow(struct view_app *app, const char *option)
{
    const int column = view_keys_column(option);
    const char *text = column < 0 ? NULL : view_model_get(&app->model, view_option_place(option));
    double value = NAN;
    int metric;
    if (!text || view_timeline_key_state(app, option) < 0 || !app->model.now.keys.column[column].count)
        return;
    if (column != CLI_KEY_FOCUS_X &&
        tool_read_measure(view_option(view_option_place(option))->unit, text, &value, &metric))
        return;
    set_key(app, column, value);
}

int view_timeline_focus(struct view_app *app, float distance)
{
    if (view_timeline_key_state(app, "focus") < 0 || !app->model.now.keys.column[CLI_KEY_FOCUS].count ||
        view_model_keep(&app->model, 0))
        return 0;
    set_key(app, CLI_KEY_FOCUS, distance);
    return 1;
}

// Curves.

// The names stand above the curves.
enum { NAMES = 16 };

static double place_on(double value, double base, double span, int height)
{
    return height - 6 - (value - base) / span * (height - NAMES - 12);
}

static void draw_column(cairo_t *c, const struct view_app *app, int column, int width, int height)
{
    const struct cli_keys *k = &app->model.now.keys;
    const int last = frames_of(app) - 1;
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < k->column[column].count; i++) {
        least = fmin(least, k->column[column].keys[i].value);
        most = fmax(most, k->column[column].keys[i].value);
    }
    const double span = most > least ? most - least : 1, base = most > least ? least : least - 0.5;
    cairo_set_source_rgb(c, colours[column][0], colours[column][1], colours[column][2]);
    cairo_new_path(c);
    for (int x = 0; x < width; x++) {
        const double place = last * (double)x / (width - 1);
        const int i = (int)place;
        const double from = frame_at(app, i), to = frame_at(app, MIN(i + 1, last));
        const double value = cli_keys_at(k, (enum cli_key)column, from + (place - i) * (to - from));
        cairo_line_to(c, x, place_on(value, base, span, height));
    }
    cairo_stroke(c);
    for (int i = 0; i <= last; i++) {
        const int key = view_keys_find(k, column, frame_at(app, i));
        if (key < 0)
            continue;
        const double y = place_on(k->column[column].keys[key].value, base, span, height);
        cairo_arc(c, last ? (double)i / last * (width - 1) : 0, y, 4, 0, 2 * M_PI);
        cairo_fill(c);
    }
}

static void draw_curves(GtkDrawingArea *area, cairo_t *c, int width, int height, gpointer data)
{
    struct view_app *app = data;
    GdkRGBA text;
    if (!frames_of(app) || width < 2)
        return;
    gtk_style_context_get_color(gtk_widget_get_style_context(GTK_WIDGET(area)), &text);
    cairo_set_source_rgba(c, text.red, text.green, text.blue, 0.4);
    const double x = frames_of(app) > 1 ? (double)app->frame / (frames_of(app) - 1) * (width - 1) : 0;
    cairo_rectangle(c, x - 0.5, 0, 1, height);
    cairo_fill(c);
    cairo_set_line_width(c, 1.5);
    cairo_set_font_size(c, 11);
    if (!view_keys_any(&app->model.now.keys)) {
        gdk_cairo_set_source_rgba(c, &text);
        cairo_move_to(c, 8, 12);
        cairo_show_text(c, "A diamond beside a value sets a key at this frame. From key to key the value changes.");
    }
    double at = 8;
    for (int k = 0; k < CLI_KEY_COUNT; k++) {
        if (!app->model.now.keys.column[k].count || !view_keys_name(k))
            continue;
        draw_column(c, app, k, width, height);
        cairo_text_extents_t size;
        cairo_text_extents(c, view_keys_name(k), &size);
        cairo_move_to(c, at, 12);
        cairo_show_text(c, view_keys_name(k));
        at += size.x_advance + 12;
    }
}

// Making.

static void on_scale(GtkRange *range, gpointer data)
{
    struct view_app *app = data;
    if (!app->timeline->quiet)
        view_timeline_go(app, (int)lround(gtk_range_get_value(range)));
}

static void on_play(GtkButton *button, gpointer data)
{
    (void)button;
    view_timeline_play(data);
}

static void on_smooth(GtkCheckButton *check, gpointer data)
{
    struct view_app *app = data;
    if (app->timeline->quiet || view_model_keep(&app->model, 0))
        return;
    app->model.now.keys.smooth = gtk_check_button_get_active(check);
    view_keys_changed(app);
    view_app_apply(app);
}

static void on_curves(GtkGestureClick *click, int presses, double x, double y, gpointer data)
{
    struct view_app *app = data;
    const int width = gtk_widget_get_width(app->timeline->curves);
    (void)click;
    (void)presses;
    (void)y;
    if (width > 1)
        view_timeline_go(app, (int)lround(x / (width - 1) * (frames_of(app) - 1)));
}

GtkWidget *view_timeline_new(struct view_app *app)
{
    struct view_timeline *t = app->timeline = g_new0(struct view_timeline, 1);
    GtkWidget *row = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
    t->box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 2);
    t->play = gtk_button_new_from_icon_name("media-playback-start-symbolic");
    gtk_widget_set_tooltip_text(t->play, "Play (space)");
    view_name(t->play, "Play");
    g_signal_connect(t->play, "clicked", G_CALLBACK(on_play), app);
    t->scale = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 1, 1);
    gtk_scale_set_draw_value(GTK_SCALE(t->scale), FALSE);
    gtk_widget_set_hexpand(t->scale, TRUE);
    view_name(t->scale, "Frame");
    g_signal_connect(t->scale, "value-changed", G_CALLBACK(on_scale), app);
    t->label = gtk_label_new("");
    gtk_widget_add_css_class(t->label, "numeric");
    t->smooth = gtk_check_button_new_with_label("Smooth");
    gtk_widget_set_tooltip_text(t->smooth, "Values go smoothly from key to key (--keys-blend smooth)");
    g_signal_connect(t->smooth, "toggled", G_CALLBACK(on_smooth), app);
    GtkWidget *const parts[] = {t->play, t->scale, t->label, t->smooth};
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        gtk_box_append(GTK_BOX(row), parts[i]);
    t->curves = view_drawing();
    gtk_drawing_area_set_content_height(GTK_DRAWING_AREA(t->curves), 84);
    gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(t->curves), draw_curves, app, NULL);
    view_name(t->curves, "Curves of the keys");
    GtkGesture *click = gtk_gesture_click_new();
    g_signal_connect(click, "pressed", G_CALLBACK(on_curves), app);
    gtk_widget_add_controller(t->curves, GTK_EVENT_CONTROLLER(click));
    gtk_box_append(GTK_BOX(t->box), row);
    gtk_box_append(GTK_BOX(t->box), t->curves);
    gtk_widget_add_css_class(t->box, "status");
    gtk_widget_set_visible(t->box, FALSE);
    return t->box;
}

void view_timeline_refresh(struct view_app *app)
{
    struct view_timeline *t = app->timeline;
    char text[64];
    gtk_widget_set_visible(t->box, frames_of(app) > 1);
    if (frames_of(app) < 2)
        return;
    t->quiet = 1;
    gtk_range_set_range(GTK_RANGE(t->scale), 0, frames_of(app) - 1);
    gtk_range_set_value(GTK_RANGE(t->scale), app->frame);
    gtk_check_button_set_active(GTK_CHECK_BUTTON(t->smooth), app->model.now.keys.smooth);
    t->quiet = 0;
    g_snprintf(text, sizeof(text), "frame %g, %d of %d, %.4g a second", view_timeline_frame(app), app->frame + 1,
               frames_of(app), rate_of(app));
    gtk_label_set_text(GTK_LABEL(t->label), text);
    gtk_widget_queue_draw(t->curves);
}

void view_timeline_free(struct view_app *app)
{
    g_free(app->timeline);
    app->timeline = NULL;
}
