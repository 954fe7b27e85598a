// SPDX-License-Identifier: BSD-3-Clause
#include <math.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/actions.h"
#include "tools/view/app.h"
#include "tools/view/bench.h"
#include "tools/view/demo.h"
#include "tools/view/job.h"
#include "tools/view/keys_file.h"
#include "tools/view/name.h"
#include "tools/view/panel.h"
#include "tools/view/profiler.h"
#include "tools/view/say.h"
#include "tools/view/timeline.h"

// The canvas.

static void on_click(void *cookie, double x, double y)
{
    struct view_app *app = cookie;
    app->event_ms = tool_now_ms();
    view_app_focus_at(app, x, y);
}

static void on_moved(void *cookie)
{
    struct view_app *app = cookie;
    view_app_ask(app, 0);
    view_window_refresh(app);
}

static void on_hover(void *cookie, double x, double y, int inside)
{
    view_window_hover(cookie, x, y, inside);
}

static void on_drawn(void *cookie, const struct view_result *result)
{
    view_window_drawn(cookie, result);
}

static void on_failed(void *cookie)
{
    struct view_app *app = cookie;
    if (app->window)
        view_app_tell(app, "There is not enough memory to draw the picture.");
}

static void on_result(void *cookie, struct view_result *result)
{
    struct view_app *app = cookie;
    if (app->window && !result->failed) {
        view_canvas_set_result(VIEW_CANVAS(app->canvas), result);
        return;
    }
    if (app->window)
        view_app_tell(app, "%s", result->error.text);
    view_result_free(result);
}

// Where the canvas is on the screen, when the window's corner is the screen's: for tests.
static void say_drawn(struct view_app *app, const struct view_result *r, const char *stage)
{
    double x, y, sx, sy;
    gtk_widget_translate_coordinates(app->canvas, app->window, 0, 0, &x, &y);
    gtk_native_get_surface_transform(GTK_NATIVE(app->window), &sx, &sy);
    const struct view_camera c = view_canvas_camera(VIEW_CANVAS(app->canvas));
    view_say("drawn stage=%s n=%d at=%d,%d,%d,%d canvas=%g,%g,%d,%d camera=%g,%g,%g,%g focus=%g fstop=%g ms=%.1f "
             "latency=%.1f show=%s",
             stage, r->n, r->at.x, r->at.y, r->at.width, r->at.height, x + sx, y + sy,
             gtk_widget_get_width(app->canvas), gtk_widget_get_height(app->canvas), c.zoom, c.x, c.y, c.aspect,
             app->setup.params.focus, app->setup.params.lens.f_number, r->ms, tool_now_ms() - r->asked_ms,
             view_show_names[r->show]);
}

static void on_buffer(GtkDropDown *down, GParamSpec *spec, gpointer data)
{
    struct view_app *app = data;
    GtkStringObject *item = gtk_drop_down_get_selected_item(down);
    (void)spec;
    if (app->quiet || !item || !strcmp(app->buffer, gtk_string_object_get_string(item)))
        return;
    g_strlcpy(app->buffer, gtk_string_object_get_string(item), sizeof(app->buffer));
    view_app_ask(app, 0);
}

static int index_of(char *const *words, const char *word)
{
    for (int i = 0; words[i]; i++)
        if (!strcmp(words[i], word))
            return i;
    return -1;
}

void view_window_next_buffer(struct view_app *app)
{
    const guint n = g_list_model_get_n_items(gtk_drop_down_get_model(GTK_DROP_DOWN(app->buffers)));
    if (app->show == VIEW_SHOW_BUFFER && n)
        gtk_drop_down_set_selected(GTK_DROP_DOWN(app->buffers),
                                   (gtk_drop_down_get_selected(GTK_DROP_DOWN(app->buffers)) + 1) % n);
}

// Give a choice other words, unless it has these.
static void set_words(GtkWidget *choice, int count, const char *const *words)
{
    GtkStringList *list = GTK_STRING_LIST(gtk_drop_down_get_model(GTK_DROP_DOWN(choice)));
    const guint old = g_list_model_get_n_items(G_LIST_MODEL(list));
    int same = (int)old == count;
    for (int i = 0; i < count && same; i++)
        same = !strcmp(gtk_string_list_get_string(list, (guint)i), words[i]);
    if (same)
        return;
    GtkStringList *made = gtk_string_list_new(NULL);
    for (int i = 0; i < count; i++)
        gtk_string_list_append(made, words[i]);
    gtk_drop_down_set_model(GTK_DROP_DOWN(choice), G_LIST_MODEL(made));
    g_object_unref(made);
}

// The engine's buffers, as soon as their names are known.
static void show_buffers(struct view_app *app, const struct view_result *r)
{
    char **names = r->buffers ? g_strsplit(g_strchomp(g_strdup(r->buffers)), "\n", -1) : NULL;
    if (names) {
        // At first what tells most of an engine.
        const char *const wanted[] = {app->buffer, "Slices", "CoC, near and far"};
        int place = -1;
        for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]) && place < 0; i++)
            place = index_of(names, wanted[i]);
        app->quiet = 1;
        set_words(app->buffers, (int)g_strv_length(names), (const char *const *)names);
        gtk_drop_down_set_selected(GTK_DROP_DOWN(app->buffers), (guint)MAX(0, place));
        app->quiet = 0;
        on_buffer(GTK_DROP_DOWN(app->buffers), NULL, app);
    }
    gtk_widget_set_visible(app->buffers, app->show == VIEW_SHOW_BUFFER && (names || app->buffer[0]));
    g_strfreev(names);
}

// The views of a file with several.
static void show_views(struct view_app *app)
{
    const struct cli_frame *f = app->picture ? &app->picture->frame : NULL;
    const int count = f && f->view_count > 1 ? f->view_count : 0;
    GPtrArray *names = g_ptr_array_new();
    for (int i = 0; i < count; i++)
        g_ptr_array_add(names, f->views[i].tag);
    app->quiet = 1;
    set_words(app->views, (int)names->len, (const char *const *)names->pdata);
    gtk_widget_set_visible(app->views, count > 0);
    if (count)
        gtk_drop_down_set_selected(GTK_DROP_DOWN(app->views), (guint)app->picture->shown);
    app->quiet = 0;
    g_ptr_array_unref(names);
}

static void on_view(GtkDropDown *down, GParamSpec *spec, gpointer data)
{
    struct view_app *app = data;
    const guint view = gtk_drop_down_get_selected(down);
    (void)spec;
    if (app->quiet || view == GTK_INVALID_LIST_POSITION || (int)view == app->view)
        return;
    app->view = (int)view;
    app->event_ms = tool_now_ms();
    view_say("view %d", app->view);
    view_app_apply(app);
}

static void on_show(GtkDropDown *down, GParamSpec *spec, gpointer data)
{
    struct view_app *app = data;
    (void)spec;
    if (!app->buffers)  // the window is being made
        return;
    app->show = (enum view_show)gtk_drop_down_get_selected(down);
    app->event_ms = tool_now_ms();
    gtk_widget_set_visible(app->buffers, FALSE);
    view_say("show %s", view_show_names[app->show]);
    view_app_ask(app, 0);
}

void view_window_show(struct view_app *app, enum view_show show)
{
    gtk_drop_down_set_selected(GTK_DROP_DOWN(app->shows), app->show == show ? VIEW_SHOW_AFTER : show);
}

void view_window_drawn(struct view_app *app, const struct view_result *result)
{
    static const char *const stages[] = {"moving", "standard", "final"};
    char text[160];
    snprintf(text, sizeof(text), "%s · %.0f ms · %s", hf_engine_name(result->report.params.engine), result->ms,
             stages[result->stage]);
    gtk_label_set_text(GTK_LABEL(app->state), text);
    if (result->report.inner.passes && !view_demo_done(app))
        view_profile_add(&app->profile, &result->report, result->ms, tool_now_ms());
    view_profiler_refresh(app);
    say_drawn(app, result, stages[result->stage]);
    show_buffers(app, result);
    if (result->channels)
        view_say("buffer %s", app->buffer);
    view_bench_drawn(app, result);
    view_demo_drawn(app);
}

void view_window_hover(struct view_app *app, double x, double y, int inside)
{
    const struct view_result *r = view_canvas_result(VIEW_CANVAS(app->canvas));
    char text[200] = "", colour[80] = "", depth[40] = "no surface", radius[40] = "";
    float z, coc;
    if (!inside || !app->picture || !app->set_up) {
        gtk_label_set_text(GTK_LABEL(app->value), "");
        return;
    }
    const struct hf_io_view *v = view_picture_view(app->picture)->view;
    const struct hf_region at = {sizeof(at), (int)x, (int)y, 1, 1};
    if (r) {
        const int u = (int)(x / r->n) - r->at.x, w = (int)(y / r->n) - r->at.y;
        if (u >= 0 && w >= 0 && u < r->at.width && w < r->at.height) {
            const size_t i = (size_t)w * (size_t)r->at.width + (size_t)u;
            const float value[3] = {r->plane[0][i], r->plane[1][i], r->plane[2][i]};
            if (r->channels == 1)
                snprintf(colour, sizeof(colour), "   value %.4g", value[0]);
            else if (r->channels == 2)
                snprintf(colour, sizeof(colour), "   values %.4g  %.4g", value[0], value[1]);
            else
                snprintf(colour, sizeof(colour), "   R %.4g  G %.4g  B %.4g", value[0], value[1], value[2]);
        }
    }
    if (hf_depth_at(&app->setup.depth, v->width, v->height, at.x, at.y, &z, NULL) == HF_OK)
        snprintf(depth, sizeof(depth), "depth %.5g", z);
    if (!view_radii(&app->setup.depth, v->width, v->height, &app->setup.params, &at, &coc))
        snprintf(radius, sizeof(radius), "   radius %+.1f px", coc);
    snprintf(text, sizeof(text), "%d, %d   %s%s%s", v->data_window.x0 + at.x, v->data_window.y0 + at.y, depth, radius,
             colour);
    gtk_label_set_text(GTK_LABEL(app->value), text);
}

void view_window_refresh(struct view_app *app)
{
    char text[64];
    const double zoom = view_canvas_get_zoom(VIEW_CANVAS(app->canvas));
    snprintf(text, sizeof(text), "%.0f %%", zoom * 100);
    gtk_button_set_label(GTK_BUTTON(app->zoom), text);
    view_name(app->zoom, "Zoom 1:1");
    snprintf(text, sizeof(text), "%+.1f EV", app->model.now.exposure);
    gtk_label_set_text(GTK_LABEL(app->exposure), text);
    const char *name = app->picture ? app->picture->args.input : app->model.input_count ? app->model.inputs[0] : NULL;
    char *base = name ? g_path_get_basename(name) : g_strdup("hyperfocal");
    gtk_window_set_title(GTK_WINDOW(app->window), base);
    g_free(base);
    show_views(app);
    view_actions_refresh(app);
    view_panel_refresh(app);
    view_timeline_refresh(app);
}

// Making.

static GtkWidget *button(const char *icon, const char *label, const char *action)
{
    GtkWidget *b = gtk_button_new_from_icon_name(icon);
    gtk_widget_set_tooltip_text(b, label);
    gtk_actionable_set_action_name(GTK_ACTIONABLE(b), action);
    view_name(b, label);
    return b;
}

static GtkWidget *make_header(struct view_app *app)
{
    GtkWidget *bar = gtk_header_bar_new();
    GtkHeaderBar *h = GTK_HEADER_BAR(bar);
    gtk_header_bar_pack_start(h, button("document-open-symbolic", "Open a picture", "win.open"));
    gtk_header_bar_pack_start(h, button("document-save-symbolic", "Save the picture", "win.save"));
    gtk_header_bar_pack_start(h, button("edit-copy-symbolic", "Copy the command line", "win.copy"));
    gtk_header_bar_pack_start(h, button("edit-undo-symbolic", "Undo", "win.undo"));
    gtk_header_bar_pack_start(h, button("edit-redo-symbolic", "Redo", "win.redo"));
    GtkWidget *menu = gtk_menu_button_new();
    gtk_menu_button_set_icon_name(GTK_MENU_BUTTON(menu), "open-menu-symbolic");
    gtk_menu_button_set_menu_model(GTK_MENU_BUTTON(menu), view_actions_menu());
    gtk_widget_set_tooltip_text(menu, "Menu");
    view_name(menu, "Menu");
    gtk_header_bar_pack_end(h, menu);
    gtk_header_bar_pack_end(h, button("zoom-fit-best-symbolic", "All of the picture", "win.fit"));
    app->zoom = gtk_button_new_with_label("100 %");
    gtk_widget_set_tooltip_text(app->zoom, "Show each pixel as it is, 1:1");
    gtk_actionable_set_action_name(GTK_ACTIONABLE(app->zoom), "win.full");
    gtk_header_bar_pack_end(h, app->zoom);
    return bar;
}

static GtkWidget *make_notice(struct view_app *app)
{
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
    app->notice = box;
    app->notice_text = gtk_label_new("");
    gtk_label_set_wrap(GTK_LABEL(app->notice_text), TRUE);
    gtk_label_set_xalign(GTK_LABEL(app->notice_text), 0);
    gtk_label_set_selectable(GTK_LABEL(app->notice_text), TRUE);
    gtk_widget_set_hexpand(app->notice_text, TRUE);
    gtk_box_append(GTK_BOX(box), app->notice_text);
    gtk_box_append(GTK_BOX(box), button("window-close-symbolic", "Close this message", "win.quiet"));
    gtk_widget_add_css_class(box, "notice");
    gtk_widget_set_visible(box, FALSE);
    return box;
}

static GtkWidget *label(const char *class, float xalign)
{
    GtkWidget *l = gtk_label_new("");
    gtk_label_set_xalign(GTK_LABEL(l), xalign);
    gtk_label_set_ellipsize(GTK_LABEL(l), PANGO_ELLIPSIZE_END);
    gtk_widget_add_css_class(l, class);
    return l;
}

static GtkWidget *make_choice(const char *name, GCallback changed, struct view_app *app)
{
    GtkWidget *down = gtk_drop_down_new(G_LIST_MODEL(gtk_string_list_new(NULL)), NULL);
    gtk_widget_set_tooltip_text(down, name);
    view_name_choice(down, name);
    g_signal_connect(down, "notify::selected", changed, app);
    return down;
}

static GtkWidget *make_status(struct view_app *app)
{
    static const char *const titles[VIEW_SHOWS] = {"Result", "Input", "Depth", "Radius", "Peaking", "Tiles", "Buffers"};
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 12);
    app->value = label("numeric", 0);
    app->state = label("numeric", 1);
    app->exposure = label("numeric", 1);
    gtk_widget_set_hexpand(app->value, TRUE);
    app->shows = make_choice("What is shown", G_CALLBACK(on_show), app);
    for (int i = 0; i < VIEW_SHOWS; i++)
        gtk_string_list_append(GTK_STRING_LIST(gtk_drop_down_get_model(GTK_DROP_DOWN(app->shows))), titles[i]);
    app->buffers = make_choice("Buffer of the engine", G_CALLBACK(on_buffer), app);
    gtk_widget_set_visible(app->buffers, FALSE);
    gtk_box_append(GTK_BOX(box), app->shows);
    app->views = make_choice("View of the file", G_CALLBACK(on_view), app);
    gtk_widget_set_visible(app->views, FALSE);
    gtk_box_append(GTK_BOX(box), app->views);
    gtk_box_append(GTK_BOX(box), app->buffers);
    gtk_box_append(GTK_BOX(box), app->value);
    gtk_box_append(GTK_BOX(box), app->exposure);
    gtk_box_append(GTK_BOX(box), app->state);
    gtk_widget_add_css_class(box, "status");
    return box;
}

static void load_style(void)
{
    GtkCssProvider *css = gtk_css_provider_new();
    gtk_css_provider_load_from_data(css,
                                    ".notice { padding: 6px 12px; background: #e5a50a; color: black; }"
                                    ".status { padding: 4px 12px; }"
                                    ".keys { padding: 0 24px 24px; }"
                                    ".panel { padding: 8px 12px; }"
                                    ".panel .derived { opacity: 0.7; }"
                                    ".panel label.given { font-weight: bold; }"
                                    ".panel scale { padding: 2px 6px; }"
                                    ".panel entry { min-width: 0; min-height: 26px; padding: 0 6px; }"
                                    ".panel .key { padding: 0; min-width: 22px; min-height: 22px; }"
                                    ".panel dropdown > button { min-height: 22px; padding: 1px 8px; }"
                                    ".status dropdown > button { min-height: 20px; padding: 0 8px; }"
                                    ".numeric { font-feature-settings: 'tnum'; }",
                                    -1);
    gtk_style_context_add_provider_for_display(gdk_display_get_default(), GTK_STYLE_PROVIDER(css),
                                               GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
    g_object_unref(css);
}

static GtkWidget *make_canvas(struct view_app *app)
{
    const struct view_canvas_events events = {on_click, on_moved, on_hover, on_drawn, on_failed};
    app->canvas = view_canvas_new(&events, app);
    if (app->own.bench)
        gtk_widget_set_size_request(app->canvas, VIEW_BENCH_WIDTH, VIEW_BENCH_HEIGHT);
    else
        gtk_widget_set_size_request(app->canvas, 240, 180);
    return app->canvas;
}

static gboolean on_close(GtkWindow *window, gpointer data)
{
    (void)window;
    return view_job_runs(data) || !view_keys_end(data);
}

gboolean view_window_close(gpointer data)
{
    struct view_app *app = data;
    if (app->window)
        gtk_window_close(GTK_WINDOW(app->window));
    return G_SOURCE_REMOVE;
}

int view_window_make(struct view_app *app, struct tool_error *error)
{
    struct view_words words;
    struct cli_args args;
    if (view_model_words(&app->model, NULL, NULL, &words) || view_words_parse(&words, &args, error))
        return -1;
    app->renderer = view_renderer_open(args.threads, args.isa, on_result, app, error);
    cli_free_args(&args);
    view_words_free(&words);
    if (!app->renderer)
        return -1;
    load_style();
    app->window = gtk_application_window_new(app->application);
    g_object_add_weak_pointer(G_OBJECT(app->window), (gpointer *)&app->window);
    gtk_window_set_default_size(GTK_WINDOW(app->window), 1280, 800);
    if (app->own.dark)
        g_object_set(gtk_settings_get_default(), "gtk-application-prefer-dark-theme", TRUE, NULL);
    gtk_window_set_titlebar(GTK_WINDOW(app->window), make_header(app));
    GtkWidget *column = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0);
    GtkWidget *middle = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 0);
    gtk_box_append(GTK_BOX(column), make_notice(app));
    gtk_box_append(GTK_BOX(middle), make_canvas(app));
    gtk_box_append(GTK_BOX(middle), view_panel_new(app));
    gtk_box_append(GTK_BOX(column), middle);
    gtk_box_append(GTK_BOX(column), view_profiler_new(app));
    gtk_box_append(GTK_BOX(column), view_timeline_new(app));
    gtk_box_append(GTK_BOX(column), view_job_bar(app));
    gtk_box_append(GTK_BOX(column), make_status(app));
    gtk_window_set_child(GTK_WINDOW(app->window), column);
    g_signal_connect(app->window, "close-request", G_CALLBACK(on_close), app);
    view_actions_add(app);
    view_window_refresh(app);
    gtk_window_present(GTK_WINDOW(app->window));
    gtk_widget_grab_focus(app->canvas);
    view_say("window");
    return 0;
}
