// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/name.h"
#include "tools/view/panel.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/view/row.h"

struct view_panel {
    struct view_row *rows[VIEW_OPTIONS];
    int count;
    const struct view_picture *measured;  // whose distances are known
    float nearest, farthest;
};

// Options that a still picture has no use for, or that have another place in the window.
static int is_shown(const struct tool_option *o)
{
    static const char *const elsewhere[] = {"print-focus", "keys", "keys-blend", "focus-smooth", "focus-per-view"};
    for (size_t i = 0; i < sizeof(elsewhere) / sizeof(elsewhere[0]); i++)
        if (!strcmp(o->name, elsewhere[i]))
            return 0;
    // Of the files' options, those that say what is looked at.
    static const char *const files[] = {"layer", "views", "display"};
    for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++)
        if (!strcmp(o->name, files[i]))
            return 1;
    return o->group == TOOL_FOCUS || o->group == TOOL_LENS || o->group == TOOL_DEPTH || o->group == TOOL_LOOK ||
           !strcmp(o->name, "deterministic");
}

// The title of a group, without its remark in parentheses.
static GtkWidget *make_group(enum tool_group group, GtkWidget *box)
{
    char *title = g_strdup(cli_program.groups[group]);
    title[strcspn(title, "(")] = '\0';
    GtkWidget *expander = gtk_expander_new(g_strstrip(title));
    view_name(expander, title);
    g_free(title);
    gtk_expander_set_child(GTK_EXPANDER(expander), box);
    gtk_expander_set_expanded(GTK_EXPANDER(expander), group == TOOL_FOCUS || group == TOOL_LENS || group == TOOL_LOOK);
    return expander;
}

GtkWidget *view_panel_new(struct view_app *app)
{
    static const enum tool_group order[] = {TOOL_FOCUS, TOOL_LENS, TOOL_LOOK, TOOL_DEPTH, TOOL_FILES, TOOL_RUN};
    GtkWidget *column = gtk_box_new(GTK_ORIENTATION_VERTICAL, 6);
    struct view_panel *panel = g_new0(struct view_panel, 1);
    app->panel = panel;
    for (size_t g = 0; g < sizeof(order) / sizeof(order[0]); g++) {
        GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 2);
        for (int i = 0; i < view_option_count(); i++) {
            if (view_option(i)->group != order[g] || !is_shown(view_option(i)))
                continue;
            struct view_row *row = view_row_new(app, i);
            panel->rows[panel->count++] = row;
            gtk_box_append(GTK_BOX(box), view_row_widget(row));
        }
        gtk_box_append(GTK_BOX(column), make_group(order[g], box));
    }
    gtk_widget_add_css_class(column, "panel");
    GtkWidget *scrolled = gtk_scrolled_window_new();
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), column);
    gtk_scrolled_window_set_policy(GTK_SCROLLED_WINDOW(scrolled), GTK_POLICY_NEVER, GTK_POLICY_AUTOMATIC);
    gtk_widget_set_size_request(scrolled, 380, -1);
    gtk_widget_set_hexpand(scrolled, FALSE);
    return scrolled;
}

void view_panel_refresh(struct view_app *app)
{
    struct view_shown_values values = {.nearest = 1, .farthest = 100};
    struct hf_params filled = {.size = sizeof(filled)};
    if (app->picture && app->set_up) {
        const struct hf_io_view *v = view_picture_view(app->picture)->view;
        if (app->panel->measured != app->picture)
            view_picture_distances(app->picture, &app->setup.depth, &app->panel->nearest, &app->panel->farthest);
        app->panel->measured = app->picture;
        values.nearest = app->panel->nearest;
        values.farthest = app->panel->farthest;
        if (!hf_resolve(v->width, v->height, &app->setup.depth, &app->setup.params, &filled, NULL, NULL))
            values.params = &filled;
    }
    for (int i = 0; i < app->panel->count; i++)
        view_row_refresh(app->panel->rows[i], &values);
}

void view_panel_free(struct view_app *app)
{
    for (int i = 0; app->panel && i < app->panel->count; i++)
        g_free(app->panel->rows[i]);
    g_free(app->panel);
    app->panel = NULL;
}
