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

static void do_save(struct view_app *app)
{
    view_job_save(app);
}

static void do_copy(struct view_app *app)
{
    view_job_copy(app);
}

static void do_shot(struct view_app *app)
{
    view_job_shot(app);
}

static void do_store(struct view_app *app)
{
    view_keys_store(app);
}

static void do_play(struct view_app *app)
{
    view_timeline_play(app);
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

static void do_profiler(struct view_app *app)
{
    view_profiler_toggle(app);
}

static void do_fade(struct view_app *app)
{
    view_demo_fade(app);
}

static void do_show_depth(struct view_app *app)
{
    view_window_show(app, VIEW_SHOW_DEPTH);
}

static void do_show_coc(struct view_app *app)
{
    view_window_show(app, VIEW_SHOW_COC);
}

static void do_show_peaking(struct view_app *app)
{
    view_window_show(app, VIEW_SHOW_PEAKING);
}

static void do_show_tiles(struct view_app *app)
{
    view_window_show(app, VIEW_SHOW_TILES);
}

static void do_show_buffer(struct view_app *app)
{
    view_window_show(app, VIEW_SHOW_BUFFER);
}

static void do_quit(struct view_app *app)
{
    gtk_window_close(GTK_WINDOW(app->window));
}

static void do_keys(struct view_app *app);

// name, label and key of each action; heading: where a section of the list of keys begins.
static const struct {
    const char *name, *label, *keys;
    action *run;
    const char *heading;
} actions[] = {
    {"open", "Open a picture", "<Control>o", do_open, "File"},
    {"save", "Save the picture", "<Control>s", do_save, NULL},
    {"copy", "Copy the command line", "<Control><Shift>c", do_copy, NULL},
    {"shot", "Render all frames of the shot", "<Control>r", do_shot, NULL},
    {"store", "Save the keys", "<Control>k", do_store, NULL},
    {"quit", "Quit", "<Control>q", do_quit, NULL},
    {"undo", "Undo", "<Control>z", do_undo, "Change"},
    {"redo", "Redo", "<Control><Shift>z", do_redo, NULL},
    {"brighter", "Half a stop brighter", "bracketright", do_brighter, NULL},
    {"darker", "Half a stop darker", "bracketleft", do_darker, NULL},
    {"plain", "Exposure as it is", "backslash", do_plain, NULL},
    {"fit", "All of the picture", "f", do_fit, "Look"},
    {"full", "Each pixel as it is, 1:1", "1", do_full, NULL},
    {"in", "Zoom in", "plus", do_zoom_in, NULL},
    {"out", "Zoom out", "minus", do_zoom_out, NULL},
    {"divider", "A line between before and after", "d", do_divider, NULL},
    {"depth", "Depth in colours", "2", do_show_depth, NULL},
    {"radius", "Radius of the blur in colours", "3", do_show_coc, NULL},
    {"peaking", "Mark edges in focus", "4", do_show_peaking, NULL},
    {"tiles", "What each tile needs", "5", do_show_tiles, NULL},
    {"buffers", "Buffers of the engine", "6", do_show_buffer, NULL},
    {"profiler", "Times of passes and frames", "p", do_profiler, NULL},
    {"fade", "Blur away, and back (demo)", "e", do_fade, NULL},
    {"play", "Play or pause", "space", do_play, "Shot"},
    {"next", "Next frame", "period", do_next, NULL},
    {"previous", "Frame before", "comma", do_previous, NULL},
    {"key", "Key of the focus at this frame", "k", do_key, NULL},
    {"quiet", "Close the message", "Escape", do_quiet, "Help"},
    {"keys", "Show the keys", "question", do_keys, NULL},
};
enum { ACTIONS = sizeof(actions) / sizeof(actions[0]) };

static void on_action(GSimpleAction *a, GVariant *parameter, gpointer data)
{
    const char *name = g_action_get_name(G_ACTION(a));
    (void)parameter;
    for (int i = 0; i < ACTIONS; i++)
        if (!strcmp(actions[i].name, name))
            actions[i].run(data);
}

static void do_keys(struct view_app *app)
{
    GString *xml = g_string_new("<interface><object class=\"GtkShortcutsWindow\" id=\"keys\"><property name=\"modal\">1"
                                "</property><child><object class=\"GtkShortcutsSection\">");
    for (int i = 0; i < ACTIONS; i++) {
        if (actions[i].heading)
            g_string_append_printf(
                xml, "%s<child><object class=\"GtkShortcutsGroup\"><property name=\"title\">%s</property>",
                i ? "</object></child>" : "", actions[i].heading);
        char *keys = g_markup_escape_text(actions[i].keys, -1);
        g_string_append_printf(
            xml,
            "<child><object class=\"GtkShortcutsShortcut\"><property name=\"accelerator\">%s</property>"
            "<property name=\"title\">%s</property></object></child>",
            keys, actions[i].label);
        g_free(keys);
    }
    g_string_append(xml, "</object></child></object></child></object></interface>");
    GtkBuilder *builder = gtk_builder_new_from_string(xml->str, -1);
    GtkWidget *keys = GTK_WIDGET(gtk_builder_get_object(builder, "keys"));
    gtk_window_set_transient_for(GTK_WINDOW(keys), GTK_WINDOW(app->window));
    gtk_window_present(GTK_WINDOW(keys));
    g_object_unref(builder);
    g_string_free(xml, TRUE);
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
