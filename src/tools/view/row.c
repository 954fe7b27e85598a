// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/row.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "tools/common/machine.h"
#include "tools/view/aperture.h"
#include "tools/view/derived.h"
#include "tools/view/name.h"
#include "tools/view/timeline.h"

struct view_row {
    struct view_app *app;
    int option;
    enum view_kind kind;
    struct view_scale slider;
    GtkWidget *box, *name, *control, *scale, *key, *picture;
    int quiet;  // the row itself changes its controls
};

GtkWidget *view_row_widget(struct view_row *row)
{
    return row->box;
}

static const struct tool_option *option_of(const struct view_row *row)
{
    return view_option(row->option);
}

static void set(struct view_row *row, const char *value, int merge)
{
    const char *now = view_model_get(&row->app->model, row->option);
    row->app->event_ms = tool_now_ms();
    if ((!value && !now) || (value && now && !strcmp(value, now)))
        return;
    if (!view_app_set(row->app, row->option, value, merge)) {
        view_timeline_follow(row->app, option_of(row)->name);
        view_app_apply(row->app);
    }
}

static void on_slider(GtkRange *range, gpointer data)
{
    struct view_row *row = data;
    char value[VIEW_VALUE];
    if (row->quiet)
        return;
    g_snprintf(value, sizeof(value), "%.4g", view_scale_value(&row->slider, gtk_range_get_value(range)));
    set(row, value, 1);
}

static void take_entry(struct view_row *row)
{
    const char *text = gtk_editable_get_text(GTK_EDITABLE(row->control));
    if (!row->quiet)
        set(row, text[0] ? text : NULL, 0);
}

static void on_entry(GtkEntry *entry, gpointer data)
{
    (void)entry;
    take_entry(data);
}

static void on_leave(GtkEventControllerFocus *focus, gpointer data)
{
    (void)focus;
    take_entry(data);
}

static void on_flag(GtkCheckButton *check, gpointer data)
{
    struct view_row *row = data;
    if (!row->quiet)
        set(row, gtk_check_button_get_active(check) ? "" : NULL, 0);
}

static void on_choice(GtkDropDown *down, GParamSpec *spec, gpointer data)
{
    struct view_row *row = data;
    const guint i = gtk_drop_down_get_selected(down);
    GtkStringObject *item = gtk_drop_down_get_selected_item(down);
    (void)spec;
    if (!row->quiet && item)
        set(row, i ? gtk_string_object_get_string(item) : NULL, 0);
}

static void on_name(GtkGestureClick *click, int presses, double x, double y, gpointer data)
{
    (void)click;
    (void)x;
    (void)y;
    if (presses == 2)
        set(data, NULL, 0);
}

// Ctrl and Backspace: the default.
static gboolean on_key(GtkEventControllerKey *keys, guint key, guint code, GdkModifierType state, gpointer data)
{
    (void)keys;
    (void)code;
    if (key != GDK_KEY_BackSpace || !(state & GDK_CONTROL_MASK))
        return FALSE;
    set(data, NULL, 0);
    return TRUE;
}

static void on_diamond(GtkButton *button, gpointer data)
{
    struct view_row *row = data;
    (void)button;
    view_timeline_toggle(row->app, option_of(row)->name);
}

// "max-radius" as "Max radius".
static char *title_of(const char *name)
{
    char *title = g_strdup(name);
    for (char *c = title; *c; c++)
        *c = *c == '-' ? ' ' : *c;
    title[0] = (char)toupper((unsigned char)title[0]);
    return title;
}

// "Max radius" with its unit, where that is not the scene's: "Max radius, px".
static char *title_with_unit(const char *title, const struct tool_option *o)
{
    static const char *const units[][2] = {{"PX", "px"}, {"MM", "mm"}, {"M", "m"}, {"MS", "ms"}};
    for (size_t i = 0; o->placeholder && i < sizeof(units) / sizeof(units[0]); i++)
        if (!strcmp(o->placeholder, units[i][0]))
            return g_strdup_printf("%s, %s", title, units[i][1]);
    return g_strdup(title);
}

static GtkWidget *choices_of(const struct tool_option *o)
{
    char **words = g_strsplit(o->placeholder, "|", -1);
    GtkStringList *list = gtk_string_list_new(NULL);
    gtk_string_list_append(list, "default");
    for (char **w = words; *w; w++)
        gtk_string_list_append(list, *w);
    g_strfreev(words);
    return gtk_drop_down_new(G_LIST_MODEL(list), NULL);
}

static void describe(GtkWidget *widget, const char *title, const struct tool_option *o)
{
    char *tip = g_strdup_printf("--%s%s%s\n%s", o->name, o->placeholder ? " " : "",
                                o->placeholder ? o->placeholder : "", o->help);
    gtk_widget_set_tooltip_text(widget, tip);
    gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL, title,
                                   GTK_ACCESSIBLE_PROPERTY_DESCRIPTION, o->help, -1);
    g_free(tip);
}

static void add_slider(struct view_row *row, const char *title)
{
    row->scale = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 1, 0.005);
    gtk_scale_set_draw_value(GTK_SCALE(row->scale), FALSE);
    gtk_widget_set_hexpand(row->scale, TRUE);
    describe(row->scale, title, option_of(row));
    g_signal_connect(row->scale, "value-changed", G_CALLBACK(on_slider), row);
    gtk_box_append(GTK_BOX(row->box), row->scale);
}

static void add_entry(struct view_row *row)
{
    row->control = gtk_entry_new();
    gtk_editable_set_width_chars(GTK_EDITABLE(row->control), row->kind == VIEW_NUMBER ? 6 : 10);
    gtk_editable_set_max_width_chars(GTK_EDITABLE(row->control), row->kind == VIEW_NUMBER ? 6 : 24);
    gtk_widget_set_hexpand(row->control, !row->scale);
    g_signal_connect(row->control, "activate", G_CALLBACK(on_entry), row);
    GtkEventController *focus = gtk_event_controller_focus_new();
    g_signal_connect(focus, "leave", G_CALLBACK(on_leave), row);
    gtk_widget_add_controller(row->control, focus);
}

static void add_key(struct view_row *row, const char *title)
{
    char *label = g_strdup_printf("Key for %s at this frame", title);
    row->key = gtk_button_new_with_label("◇");
    gtk_button_set_has_frame(GTK_BUTTON(row->key), FALSE);
    gtk_widget_add_css_class(row->key, "key");
    gtk_widget_set_tooltip_text(row->key, label);
    g_free(label);
    g_signal_connect(row->key, "clicked", G_CALLBACK(on_diamond), row);
    gtk_box_append(GTK_BOX(row->box), row->key);
}

static void add_control(struct view_row *row, const char *title)
{
    const struct tool_option *o = option_of(row);
    switch (row->kind) {
    case VIEW_FLAG:
        row->control = gtk_check_button_new();
        g_signal_connect(row->control, "toggled", G_CALLBACK(on_flag), row);
        break;
    case VIEW_CHOICE:
        row->control = choices_of(o);
        gtk_widget_set_hexpand(row->control, TRUE);
        g_signal_connect(row->control, "notify::selected", G_CALLBACK(on_choice), row);
        break;
    case VIEW_NUMBER:
    case VIEW_TEXT:
        row->slider = view_scale(o, 1, 100);
        if (row->slider.kind != VIEW_SCALE_NONE)
            add_slider(row, title);
        add_entry(row);
        break;
    }
    if (row->kind == VIEW_CHOICE)
        view_name_choice(row->control, title);
    describe(row->control, title, o);
    gtk_box_append(GTK_BOX(row->box), row->control);
}

struct view_row *view_row_new(struct view_app *app, int option)
{
    struct view_row *row = g_new0(struct view_row, 1);
    const struct tool_option *o = view_option(option);
    char *title = title_of(o->name);
    row->app = app;
    row->option = option;
    row->kind = view_kind(o);
    row->box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 6);
    char *words = title_with_unit(title, o);
    row->name = gtk_label_new(words);
    g_free(words);
    gtk_label_set_xalign(GTK_LABEL(row->name), 0);
    gtk_label_set_width_chars(GTK_LABEL(row->name), 16);
    gtk_label_set_ellipsize(GTK_LABEL(row->name), PANGO_ELLIPSIZE_END);
    gtk_label_set_max_width_chars(GTK_LABEL(row->name), 18);
    gtk_widget_set_tooltip_text(row->name, "Double click: the default");
    GtkGesture *click = gtk_gesture_click_new();
    g_signal_connect(click, "pressed", G_CALLBACK(on_name), row);
    gtk_widget_add_controller(row->name, GTK_EVENT_CONTROLLER(click));
    gtk_box_append(GTK_BOX(row->box), row->name);
    add_control(row, title);
    if (!strcmp(o->name, "aperture")) {
        row->picture = view_aperture_new();
        gtk_box_append(GTK_BOX(row->box), row->picture);
    }
    if (view_keys_column(o->name) >= 0)
        add_key(row, title);
    GtkEventController *keys = gtk_event_controller_key_new();
    gtk_event_controller_set_propagation_phase(keys, GTK_PHASE_CAPTURE);
    g_signal_connect(keys, "key-pressed", G_CALLBACK(on_key), row);
    gtk_widget_add_controller(row->box, keys);
    g_free(title);
    return row;
}

static void refresh_choice(struct view_row *row, const char *given, const char *derived)
{
    GListModel *list = gtk_drop_down_get_model(GTK_DROP_DOWN(row->control));
    guint selected = 0;
    for (guint i = 1; given && i < g_list_model_get_n_items(list); i++)
        if (!strcmp(gtk_string_list_get_string(GTK_STRING_LIST(list), i), given))
            selected = i;
    // The first word says what the default is at the moment.
    char *word = derived[0] ? g_strdup_printf("default (%s)", derived) : g_strdup("default");
    if (strcmp(gtk_string_list_get_string(GTK_STRING_LIST(list), 0), word)) {
        const char *const words[] = {word, NULL};
        gtk_string_list_splice(GTK_STRING_LIST(list), 0, 1, words);
    }
    g_free(word);
    gtk_drop_down_set_selected(GTK_DROP_DOWN(row->control), selected);
}

static void refresh_number(struct view_row *row, const char *given, const char *derived, int known, double number)
{
    gtk_entry_set_placeholder_text(GTK_ENTRY(row->control), derived);
    if (strcmp(gtk_editable_get_text(GTK_EDITABLE(row->control)), given ? given : ""))
        gtk_editable_set_text(GTK_EDITABLE(row->control), given ? given : "");
    if (row->scale && known && isfinite(number))
        gtk_range_set_value(GTK_RANGE(row->scale), view_scale_place(&row->slider, number));
}

static void refresh_key(struct view_row *row)
{
    const int state = view_timeline_key_state(row->app, option_of(row)->name);
    gtk_widget_set_visible(row->key, state >= 0);
    gtk_button_set_label(GTK_BUTTON(row->key), state > 0 ? "◆" : "◇");
    view_name(row->key, gtk_widget_get_tooltip_text(row->key));  // the label became its name
}

void view_row_refresh(struct view_row *row, const struct view_shown_values *values)
{
    const struct tool_option *o = option_of(row);
    const char *given = view_model_get(&row->app->model, row->option);
    char derived[VIEW_VALUE] = "";
    double number = 0;
    const int known = values->params && view_derived(o, values->params, derived, &number);
    const enum hf_engine engine = values->params ? values->params->engine : HF_ENGINE_LAYERS;
    row->quiet = 1;
    gtk_widget_set_visible(row->box, given || !o->engines || tool_has_word(o->engines, hf_engine_name(engine)));
    if (given)
        gtk_widget_add_css_class(row->name, "given");
    else
        gtk_widget_remove_css_class(row->name, "given");
    if (row->kind == VIEW_FLAG)
        gtk_check_button_set_active(GTK_CHECK_BUTTON(row->control), given != NULL);
    else if (row->kind == VIEW_CHOICE)
        refresh_choice(row, given, derived);
    else {
        const struct view_scale now = view_scale(o, values->nearest, values->farthest);
        row->slider = now;
        refresh_number(row, given, derived, known, number);
    }
    if (row->picture)
        view_aperture_set(row->picture, values->params ? &values->params->aperture : NULL);
    if (row->key)
        refresh_key(row);
    row->quiet = 0;
}
