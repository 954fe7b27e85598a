// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/keys_file.h"

#include <string.h>
#include <unistd.h>

#include "tools/view/model_keys.h"
#include "tools/view/say.h"

// One file for each shot: its name is a hash of the inputs and of the folder that they are named from.
static char *spare_path(const struct view_app *app)
{
    GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA1);
    char *folder = g_get_current_dir();
    g_checksum_update(sum, (const guchar *)folder, -1);
    for (int i = 0; i < app->model.input_count; i++)
        g_checksum_update(sum, (const guchar *)app->model.inputs[i], (gssize)strlen(app->model.inputs[i]) + 1);
    char *name = g_strdup_printf("%s.csv", g_checksum_get_string(sum));
    char *path = g_build_filename(g_get_user_state_dir(), "hyperfocal", name, NULL);
    g_free(name);
    g_free(folder);
    g_checksum_free(sum);
    return path;
}

static void remove_spare(const struct view_app *app)
{
    char *path = spare_path(app);
    unlink(path);
    g_free(path);
}

void view_keys_changed(struct view_app *app)
{
    struct tool_error error;
    char *path = spare_path(app), *folder = g_path_get_dirname(path);
    app->keys_unsaved = 1;
    if (!view_keys_any(&app->model.now.keys))
        unlink(path);
    else if (g_mkdir_with_parents(folder, 0700) || view_keys_save(&app->model.now.keys, path, &error))
        view_app_tell(app, "%s cannot be written: a crash would lose keys that are not saved.", path);
    g_free(folder);
    g_free(path);
}

int view_keys_store_as(struct view_app *app, const char *name)
{
    struct tool_error error;
    char *path = g_strdup(name);
    if (view_keys_save(&app->model.now.keys, path, &error)) {
        view_app_tell(app, "%s", error.text);
        g_free(path);
        return -1;
    }
    g_free(app->keys_path);
    app->keys_path = path;
    app->keys_unsaved = 0;
    remove_spare(app);
    view_app_tell(app, "The keys are saved as %s.", path);
    view_say("keys saved %s", path);
    return 0;
}

static void on_name(GtkNativeDialog *dialog, int response, gpointer data)
{
    struct view_app *app = data;
    GFile *file = response == GTK_RESPONSE_ACCEPT ? gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog)) : NULL;
    char *path = file ? g_file_get_path(file) : NULL;
    if (path && !view_keys_store_as(app, path) && app->closing)
        gtk_window_destroy(GTK_WINDOW(app->window));
    app->closing = 0;
    g_free(path);
    g_clear_object(&file);
    g_object_unref(dialog);
}

void view_keys_store(struct view_app *app)
{
    if (app->keys_path) {
        if (!view_keys_store_as(app, app->keys_path) && app->closing)
            gtk_window_destroy(GTK_WINDOW(app->window));
        return;
    }
    GtkFileChooserNative *dialog = gtk_file_chooser_native_new("Save the keys", GTK_WINDOW(app->window),
                                                               GTK_FILE_CHOOSER_ACTION_SAVE, "Save", "Cancel");
    gtk_file_chooser_set_current_name(GTK_FILE_CHOOSER(dialog), "keys.csv");
    g_signal_connect(dialog, "response", G_CALLBACK(on_name), app);
    gtk_native_dialog_show(GTK_NATIVE_DIALOG(dialog));
}

static void take(struct view_app *app, struct cli_keys *keys)
{
    const char *unit = view_model_get(&app->model, view_option_place("world-unit"));
    const double metres = unit ? g_ascii_strtod(unit, NULL) : 1;
    cli_keys_scale(keys, metres > 0 ? metres : 1);
    cli_keys_free(&app->model.now.keys);
    app->model.now.keys = *keys;
}

void view_keys_begin(struct view_app *app)
{
    struct tool_error error;
    struct cli_keys keys;
    const char *given = view_model_get(&app->model, view_option_place("keys"));
    const char *blend = view_model_get(&app->model, view_option_place("keys-blend"));
    const int smooth = blend && !strcmp(blend, "smooth");
    char *spare = spare_path(app);
    if (!app->shot.sequence) {
        g_free(spare);
        return;
    }
    if (given && !view_keys_any(&app->model.now.keys)) {
        if (cli_keys_load(&keys, given, smooth, &error))
            view_app_tell(app, "%s", error.text);
        else {
            take(app, &keys);
            g_free(app->keys_path);
            app->keys_path = g_strdup(given);
        }
    }
    if (!access(spare, R_OK) && !cli_keys_load(&keys, spare, smooth, &error) && !view_model_keep(&app->model, 0)) {
        take(app, &keys);
        app->keys_unsaved = 1;
        view_app_tell(app,
                      "Keys were recovered that were not saved when the window was last open. Ctrl+Z takes them back.");
    }
    g_free(spare);
}

static void on_answer(GtkDialog *dialog, int response, gpointer data)
{
    struct view_app *app = data;
    gtk_window_destroy(GTK_WINDOW(dialog));
    if (response == GTK_RESPONSE_ACCEPT) {
        app->closing = 1;
        view_keys_store(app);
    } else if (response == GTK_RESPONSE_REJECT) {
        remove_spare(app);
        app->keys_unsaved = 0;
        gtk_window_destroy(GTK_WINDOW(app->window));
    }
}

int view_keys_end(struct view_app *app)
{
    if (!app->keys_unsaved || !view_keys_any(&app->model.now.keys)) {
        if (app->shot.sequence)
            remove_spare(app);
        return 1;
    }
    GtkWidget *dialog =
        gtk_message_dialog_new(GTK_WINDOW(app->window), GTK_DIALOG_MODAL | GTK_DIALOG_DESTROY_WITH_PARENT,
                               GTK_MESSAGE_QUESTION, GTK_BUTTONS_NONE, "The keys of this shot are not saved.");
    gtk_dialog_add_buttons(GTK_DIALOG(dialog), "Discard", GTK_RESPONSE_REJECT, "Cancel", GTK_RESPONSE_CANCEL, "Save",
                           GTK_RESPONSE_ACCEPT, NULL);
    gtk_dialog_set_default_response(GTK_DIALOG(dialog), GTK_RESPONSE_ACCEPT);
    g_signal_connect(dialog, "response", G_CALLBACK(on_answer), app);
    gtk_window_present(GTK_WINDOW(dialog));
    view_say("ask unsaved keys");
    return 0;
}
