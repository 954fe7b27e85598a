// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/actions.h"

#include <math.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/demo.h"
#include "tools/view/job.h"
#include "tools/view/keys_file.h"
#include "tools/view/profiler.h"
#include "tools/view/say.h"
#include "tools/view/timeline.h"

typedef void action(struct view_app *app);

static ViewCanvas *canvas(struct view_app *app)
{
    return VIEW_CANVAS(app->canvas);
}

// Opening.

static void on_file_chosen(GtkNativeDialog *dialog, int response, gpointer data)
{
    struct view_app *app = data;
    if (response == GTK_RESPONSE_ACCEPT) {
        GFile *file = gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog));
        char *path = file ? g_file_get_path(file) : NULL;
        if (path)
            view_app_open(app, &path, 1);
        g_free(path);
        g_clear_object(&file);
    }
    g_object_unref(dialog);
}

static void do_open(struct view_app *app)
{
    GtkFileChooserNative *dialog = gtk_file_chooser_native_new("Open a picture with depth", GTK_WINDOW(app->window),
                                                               GTK_FILE_CHOOSER_ACTION_OPEN, "Open", "Cancel");
    g_signal_connect(dialog, "response", G_CALLBACK(on_file_chosen), app);
    gtk_native_dialog_show(GTK_NATIVE_DIALOG(dialog));
}

static void do_quiet(struct view_app *app)
{
    view_app_tell(app, NULL);
}

static void do_undo(struct view_app *app)
{
    app->event_ms = tool_now_ms();
    view_app_undo(app, 0);
}

static void do_redo(struct view_app *app)
{
    app->event_ms = tool_now_ms();
    view_app_undo(app, 1);
}

static void do_fit(struct view_app *app)
{
    view_canvas_fit(canvas(app));
}

static void do_full(struct view_app *app)
{
    view_canvas_zoom(canvas(app), 1, -1, -1);
}

static void do_zoom_in(struct view_app *app)
{
    const double zoom = view_canvas_get_zoom(canvas(app));
    view_canvas_zoom(canvas(app), zoom >= 1 ? zoom + 1 : fmin(1, zoom * 1.25), -1, -1);
}

static void do_zoom_out(struct view_app *app)
{
    const double zoom = view_canvas_get_zoom(canvas(app));
    view_canvas_zoom(canvas(app), zoom > 1 ? zoom - 1 : zoom / 1.25, -1, -1);
}

static void expose(struct view_app *app, float stops)
{
    app->event_ms = tool_now_ms();
    view_model_set_exposure(&app->model, stops, stops != 0);
    view_app_apply(app);
}

static void do_brighter(struct view_app *app)
{
    expose(app, app->model.now.exposure + 0.5f);
}

static void do_darker(struct view_app *app)
{
    expose(app, app->model.now.exposure - 0.5f);
}

static void do_plain(struct view_app *app)
{
    expose(app, 0);
}

static void do_divider(struct view_app *app)
{
    view_canvas_set_divider(canvas(app), !view_canvas_get_divider(canvas(app)));
}

static void do_next(struct view_app *app)
{
    view_timeline_go(app, app->frame + 1);
}

static void do_previous(struct view_app *app)
{
    view_timeline_go(app, app->frame - 1);
}

static void do_key(struct view_app *app)
{
    view_timeline_toggle(app, "focus");
}

static void do_quit(struct view_app *app)
{
    gtk_window_close(GTK_WINDOW(app->window));
}

static void do_keys(struct view_app *app);

// name, label and key of each action; heading: where a section of the list of keys begins; show: what is shown, where nothing is
// run.
static const struct {
    const char *name, *label, *keys;
    action *run;
    const char *heading;
    enum view_show show;
} actions[] = {
    {"open", "Open a picture", "<Control>o", do_open, "File", 0},
    {"save", "Save the picture", "<Control>s", view_job_save, NULL, 0},
    {"copy", "Copy the command line", "<Control><Shift>c", view_job_copy, NULL, 0},
    {"shot", "Render all frames of the shot", "<Control>r", view_job_shot, NULL, 0},
    {"store", "Save the keys", "<Control>k", view_keys_store, NULL, 0},
    {"quit", "Quit", "<Control>q", do_quit, NULL, 0},
    {"undo", "Undo", "<Control>z", do_undo, "Change", 0},
    {"redo", "Redo", "<Control><Shift>z", do_redo, NULL, 0},
    {"brighter", "Half a stop brighter", "bracketright", do_brighter, NULL, 0},
    {"darker", "Half a stop darker", "bracketleft", do_darker, NULL, 0},
    {"plain", "Exposure as it is", "backslash", do_plain, NULL, 0},
    {"fit", "All of the picture", "f", do_fit, "Look", 0},
    {"full", "Each pixel as it is, 1:1", "1", do_full, NULL, 0},
    {"in", "Zoom in", "plus", do_zoom_in, NULL, 0},
    {"out", "Zoom out", "minus", do_zoom_out, NULL, 0},
    {"divider", "A line between before and after", "d", do_divider, "Look closer", 0},
    {"depth", "Depth in colours", "2", NULL, NULL, VIEW_SHOW_DEPTH},
    {"radius", "Radius of the blur in colours", "3", NULL, NULL, VIEW_SHOW_COC},
    {"peaking", "Mark edges in focus", "4", NULL, NULL, VIEW_SHOW_PEAKING},
    {"tiles", "What each tile needs", "5", NULL, NULL, VIEW_SHOW_TILES},
    {"buffers", "Buffers of the engine", "6", NULL, NULL, VIEW_SHOW_BUFFER},
    {"buffer", "Next buffer of the engine", "n", view_window_next_buffer, NULL, 0},
    {"profiler", "Times of passes and frames", "p", view_profiler_toggle, NULL, 0},
    {"fade", "Blur away, and back (demo)", "e", view_demo_fade, NULL, 0},
    {"play", "Play or pause", "space", view_timeline_play, "Shot", 0},
    {"next", "Next frame", "period", do_next, NULL, 0},
    {"previous", "Frame before", "comma", do_previous, NULL, 0},
    {"key", "Key of the focus at this frame", "k", do_key, NULL, 0},
    {"quiet", "Close the message", "Escape", do_quiet, "Help", 0},
    {"keys", "Show the keys", "question", do_keys, NULL, 0},
};
enum { ACTIONS = sizeof(actions) / sizeof(actions[0]) };

// What the picture does by itself, for the list of keys; they come behind the heading "Look".
static const struct {
    const char *label, *keys;
} others[] = {
    {"The input, while it is held", "b"},
    {"Focus on what is at the pointer", "Return"},
    {"Move the picture", "Left Right Up Down"},
    {"Move the line", "<Shift>Left <Shift>Right"},
};

static void on_action(GSimpleAction *a, GVariant *parameter, gpointer data)
{
    const char *name = g_action_get_name(G_ACTION(a));
    (void)parameter;
    for (int i = 0; i < ACTIONS; i++)
        if (!strcmp(actions[i].name, name) && actions[i].run)
            actions[i].run(data);
        else if (!strcmp(actions[i].name, name))
            view_window_show(data, actions[i].show);
}

// A row of the list of keys. keys: with spaces between them; NULL: a heading.
static void list_key(GtkWidget *column, const char *label, const char *keys)
{
    GtkWidget *row = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6), *what = gtk_label_new(label);
    gtk_label_set_xalign(GTK_LABEL(what), 0);
    gtk_widget_set_hexpand(what, TRUE);
    gtk_widget_set_margin_end(what, 12);
    gtk_box_append(GTK_BOX(row), what);
    gtk_box_append(GTK_BOX(column), row);
    if (!keys) {
        gtk_widget_add_css_class(what, "heading");
        gtk_widget_set_margin_top(what, 12);
        return;
    }
    char **each = g_strsplit(keys, " ", -1);
    for (int i = 0; each[i]; i++)
        gtk_box_append(GTK_BOX(row), gtk_shortcut_label_new(each[i]));
    g_strfreev(each);
}

// All keys on one page: a GtkShortcutsWindow would spread them over two.
static void do_keys(struct view_app *app)
{
    enum { COLUMNS = 3 };
    GtkWidget *dialog = g_object_new(GTK_TYPE_DIALOG, "use-header-bar", TRUE, "title", "Keys", "modal", TRUE,
                                     "transient-for", app->window, "resizable", FALSE, NULL);
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 36), *column[COLUMNS];
    int rows[COLUMNS] = {0}, to = 0;
    for (int i = 0; i < COLUMNS; i++) {
        column[i] = gtk_box_new(GTK_ORIENTATION_VERTICAL, 6);
        gtk_box_append(GTK_BOX(box), column[i]);
    }
    for (int i = 0; i < ACTIONS; i++) {
        if (actions[i].heading) {
            for (int k = 0; k < COLUMNS; k++)
                to = rows[k] < rows[to] ? k : to;
            list_key(column[to], actions[i].heading, NULL);
        }
        rows[to]++;
        list_key(column[to], actions[i].label, actions[i].keys);
        for (size_t k = 0; k < sizeof(others) / sizeof(others[0]) && !strcmp(actions[i].name, "out"); k++) {
            rows[to]++;
            list_key(column[to], others[k].label, others[k].keys);
        }
    }
    gtk_widget_add_css_class(box, "keys");
    gtk_box_append(GTK_BOX(gtk_dialog_get_content_area(GTK_DIALOG(dialog))), box);
    gtk_window_present(GTK_WINDOW(dialog));
    view_say("keys");
}

// A letter is typed into an entry when one has the focus; the keys of the picture belong to the window else.
static gboolean types(struct view_app *app, guint key)
{
    GtkWidget *focus = gtk_window_get_focus(GTK_WINDOW(app->window));
    return focus &&
           (GTK_IS_EDITABLE(focus) || (key == GDK_KEY_space && (GTK_IS_BUTTON(focus) || GTK_IS_CHECK_BUTTON(focus))));
}

static gboolean on_key(GtkEventControllerKey *keys, guint key, guint code, GdkModifierType state, gpointer data)
{
    struct view_app *app = data;
    const GdkModifierType held = state & (GDK_CONTROL_MASK | GDK_SHIFT_MASK | GDK_ALT_MASK);
    (void)keys;
    (void)code;
    if (types(app, key) && !(held & GDK_CONTROL_MASK))
        return FALSE;
    if (key == GDK_KEY_b) {
        view_canvas_set_before(canvas(app), 1);
        return TRUE;
    }
    for (int i = 0; i < ACTIONS; i++) {
        guint wanted;
        GdkModifierType with;
        gtk_accelerator_parse(actions[i].keys, &wanted, &with);
        // Shift is part of many marks ("?"), so it counts with Control only.
        const GdkModifierType mask = with ? held : held & ~(GdkModifierType)GDK_SHIFT_MASK;
        if (gdk_keyval_to_lower(key) == wanted && mask == with) {
            app->event_ms = tool_now_ms();
            g_action_group_activate_action(G_ACTION_GROUP(app->window), actions[i].name, NULL);
            return TRUE;
        }
    }
    return FALSE;
}

static void on_key_up(GtkEventControllerKey *keys, guint key, guint code, GdkModifierType state, gpointer data)
{
    struct view_app *app = data;
    (void)keys;
    (void)code;
    (void)state;
    if (key == GDK_KEY_b)
        view_canvas_set_before(canvas(app), 0);
}

static gboolean on_drop(GtkDropTarget *target, const GValue *value, double x, double y, gpointer data)
{
    GSList *list = g_value_get_boxed(value);
    GPtrArray *paths = g_ptr_array_new_with_free_func(g_free);
    (void)target;
    (void)x;
    (void)y;
    for (; list; list = list->next) {
        char *path = g_file_get_path(list->data);
        if (path)
            g_ptr_array_add(paths, path);
    }
    if (paths->len)
        view_app_open(data, (char *const *)paths->pdata, (int)paths->len);
    g_ptr_array_unref(paths);
    return TRUE;
}

static GdkDragAction on_drag(GtkDropTarget *target, double x, double y, gpointer data)
{
    (void)target;
    (void)x;
    (void)y;
    (void)data;
    view_say("over");
    return GDK_ACTION_COPY;
}

void view_actions_add(struct view_app *app)
{
    for (int i = 0; i < ACTIONS; i++) {
        GSimpleAction *a = g_simple_action_new(actions[i].name, NULL);
        g_signal_connect(a, "activate", G_CALLBACK(on_action), app);
        g_action_map_add_action(G_ACTION_MAP(app->window), G_ACTION(a));
        g_object_unref(a);
    }
    GtkEventController *keys = gtk_event_controller_key_new();
    gtk_event_controller_set_propagation_phase(keys, GTK_PHASE_CAPTURE);
    g_signal_connect(keys, "key-pressed", G_CALLBACK(on_key), app);
    g_signal_connect(keys, "key-released", G_CALLBACK(on_key_up), app);
    gtk_widget_add_controller(app->window, keys);
    GtkDropTarget *drop = gtk_drop_target_new(GDK_TYPE_FILE_LIST, GDK_ACTION_COPY);
    g_signal_connect(drop, "enter", G_CALLBACK(on_drag), app);
    g_signal_connect(drop, "drop", G_CALLBACK(on_drop), app);
    gtk_widget_add_controller(app->window, GTK_EVENT_CONTROLLER(drop));
}

GMenuModel *view_actions_menu(void)
{
    GMenu *menu = g_menu_new();
    for (int i = 0; i < ACTIONS; i++) {
        char *name = g_strdup_printf("win.%s", actions[i].name);
        g_menu_append(menu, actions[i].label, name);
        g_free(name);
    }
    return G_MENU_MODEL(menu);
}

static void enable(struct view_app *app, const char *name, int on)
{
    GAction *a = g_action_map_lookup_action(G_ACTION_MAP(app->window), name);
    if (a)
        g_simple_action_set_enabled(G_SIMPLE_ACTION(a), on);
}

void view_actions_refresh(struct view_app *app)
{
    enable(app, "undo", app->model.past_count > 0);
    enable(app, "redo", app->model.future_count > 0);
    enable(app, "save", app->picture != NULL);
    enable(app, "copy", app->picture != NULL);
    static const char *const of_shots[] = {"shot", "store", "play", "next", "previous", "key"};
    for (size_t i = 0; i < sizeof(of_shots) / sizeof(of_shots[0]); i++)
        enable(app, of_shots[i], app->shot.sequence && app->picture);
}
