// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/keys_file.h"

#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "tools/view/model_keys.h"
#include "tools/view/say.h"

// The copies of a shot's keys begin so: with a hash of the inputs and of the folder that they are named from.
static char *spare_stem(const struct view_app *app)
{
    GChecksum *sum = g_checksum_new(G_CHECKSUM_SHA1);
    char *folder = g_get_current_dir();
    g_checksum_update(sum, (const guchar *)folder, -1);
    for (int i = 0; i < app->model.input_count; i++)
        g_checksum_update(sum, (const guchar *)app->model.inputs[i], (gssize)strlen(app->model.inputs[i]) + 1);
    char *stem = g_build_filename(g_get_user_state_dir(), "hyperfocal", g_checksum_get_string(sum), NULL);
    g_free(folder);
    g_checksum_free(sum);
    return stem;
}

// Each window has a copy of its own, and locks it as long as it lives. Returns the file, or -1 if another window has it.
static int lock(const char *path)
{
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file >= 0 && !flock(file, LOCK_EX | LOCK_NB))
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

void view_keys_release(struct view_app *app)
{
    if (app->spare && app->spare_lock >= 0)
        close(app->spare_lock);
    g_clear_pointer(&app->spare, g_free);
}

static void remove_spare(struct view_app *app)
{
    if (app->spare)
        unlink(app->spare);
    view_keys_release(app);
}

// A copy that no window has: one that crashed left it.
static int find_spare(struct view_app *app)
{
    char *stem = spare_stem(app), *folder = g_path_get_dirname(stem), *begin = g_path_get_basename(stem);
    GDir *files = g_dir_open(folder, 0, NULL);
    const char *name;
    while (files && !app->spare && (name = g_dir_read_name(files))) {
        if (!g_str_has_prefix(name, begin) || !g_str_has_suffix(name, ".csv"))
            continue;
        app->spare = g_build_filename(folder, name, NULL);
        app->spare_lock = lock(app->spare);
        if (app->spare_lock < 0)
            view_keys_release(app);
    }
    if (files)
        g_dir_close(files);
    g_free(begin);
    g_free(folder);
    g_free(stem);
    return app->spare != NULL;
}

void view_keys_changed(struct view_app *app)
{
    struct tool_error error;
    app->keys_unsaved = 1;
    if (!view_keys_any(&app->model.now.keys)) {
        remove_spare(app);
        return;
    }
    char *stem = spare_stem(app);
    char *path = app->spare ? g_strdup(app->spare) : g_strdup_printf("%s-%d.csv", stem, (int)getpid());
    char *folder = g_path_get_dirname(path);
    view_keys_release(app);  // saving replaces the file
    if (g_mkdir_with_parents(folder, 0700) || view_keys_save(&app->model.now.keys, path, &error)) {
        view_app_tell(app, "%s cannot be written: a crash would lose keys that are not saved.", path);
    } else {
        app->spare = g_strdup(path);
        app->spare_lock = lock(path);
    }
    g_free(folder);
    g_free(path);
    g_free(stem);
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
    view_keys_release(app);
    if (!app->shot.sequence)
        return;
    if (given && !view_keys_any(&app->model.now.keys)) {
        if (cli_keys_load(&keys, given, smooth, &error))
            view_app_tell(app, "%s", error.text);
        else {
            take(app, &keys);
            g_free(app->keys_path);
            app->keys_path = g_strdup(given);
        }
    }
    if (find_spare(app) && !cli_keys_load(&keys, app->spare, smooth, &error) && !view_model_keep(&app->model, 0)) {
        take(app, &keys);
        app->keys_unsaved = 1;
        view_app_tell(app,
                      "Keys were recovered that were not saved when the window was last open. Ctrl+Z takes them back.");
    }
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
