// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/job.h"
#include "tools/view/name.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tools/view/say.h"

// A command that runs.
struct job {
    struct view_app *app;
    GSubprocess *process;
    GDataInputStream *lines;  // what it prints on stderr
    char *output, *keys;      // keys: a temporary file, or NULL
    char *last;               // line
};

// The command: beside this program, where a build puts it, or in the path.
static char *find_command(void)
{
    static const char *const places[] = {"hyperfocal", "../cli/hyperfocal"};
    char *self = g_file_read_link("/proc/self/exe", NULL), *found = NULL;
    char *folder = self ? g_path_get_dirname(self) : NULL;
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]) && folder && !found; i++) {
        char *path = g_build_filename(folder, places[i], NULL);
        if (g_file_test(path, G_FILE_TEST_IS_EXECUTABLE) && !g_file_test(path, G_FILE_TEST_IS_DIR))
            found = path;
        else
            g_free(path);
    }
    g_free(folder);
    g_free(self);
    return found ? found : g_strdup("hyperfocal");
}

// shot.exr as shot.dof.exr; a shot's pattern likewise, before its number.
char *view_job_output(const struct view_app *app)
{
    const char *given = view_model_get(&app->model, view_option_place("output"));
    if (given)
        return g_strdup(given);
    const char *input = app->model.input_count ? app->model.inputs[0] : "picture.exr";
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    const size_t stem = strcspn(base, ".");
    return g_strdup_printf("%.*s.dof%s", (int)(base - input + (ptrdiff_t)stem), input,
                           base[stem] ? base + stem : ".exr");
}

void view_job_copy(struct view_app *app)
{
    struct view_words words;
    const char *keys = NULL;
    if (view_keys_any(&app->model.now.keys)) {
        if (!app->keys_path || app->keys_unsaved) {
            view_app_tell(app, "The keys must be saved first (Ctrl+K), as the command reads them from a file.");
            return;
        }
        keys = app->keys_path;
    }
    char *output = view_job_output(app);
    if (!view_model_words(&app->model, output, keys, &words)) {
        char *line = view_words_line(&words);
        if (line) {
            gdk_clipboard_set_text(gtk_widget_get_clipboard(app->window), line);
            view_say("copied %s", line);
            view_app_tell(app, "Copied: %s", line);
        }
        free(line);
    }
    view_words_free(&words);
    g_free(output);
}

static void free_job(struct job *job)
{
    if (job->keys)
        unlink(job->keys);
    g_clear_object(&job->lines);
    g_clear_object(&job->process);
    g_free(job->keys);
    g_free(job->output);
    g_free(job->last);
    g_free(job);
}

static void on_end(GObject *source, GAsyncResult *result, gpointer data)
{
    struct job *job = data;
    struct view_app *app = job->app;
    g_subprocess_wait_finish(G_SUBPROCESS(source), result, NULL);
    const int done = g_subprocess_get_if_exited(job->process) && g_subprocess_get_exit_status(job->process) == 0;
    app->job = app->job == job ? NULL : app->job;
    if (done)
        view_app_tell(app, "%s is written.%s%s", job->output, job->last ? " " : "", job->last ? job->last : "");
    else if (g_subprocess_get_if_exited(job->process))
        view_app_tell(app, "%s", job->last ? job->last : "the command failed");
    else
        view_app_tell(app, "%s was given up; frames that were finished stay.", job->output);
    view_say("job %s", done ? "done" : g_subprocess_get_if_exited(job->process) ? "failed" : "cancelled");
    view_job_show(app, NULL, 0);
    free_job(job);
}

// "hyperfocal: 3/8 NAME: ..." tells how far a shot is.
static void follow(struct job *job)
{
    int done, all;
    if (job->last && sscanf(job->last, "hyperfocal: %d/%d ", &done, &all) == 2 && all > 0)
        view_job_show(job->app, job->last, (double)done / all);
}

static void on_line(GObject *source, GAsyncResult *result, gpointer data)
{
    struct job *job = data;
    char *line = g_data_input_stream_read_line_finish_utf8(G_DATA_INPUT_STREAM(source), result, NULL, NULL);
    if (!line) {
        g_subprocess_wait_async(job->process, NULL, on_end, job);
        return;
    }
    g_free(job->last);
    job->last = line;
    follow(job);
    g_data_input_stream_read_line_async(job->lines, G_PRIORITY_DEFAULT, NULL, on_line, job);
}

static char *temporary_keys(struct view_app *app, struct tool_error *error)
{
    char *path = NULL;
    const int file = g_file_open_tmp("hyperfocal-keys-XXXXXX.csv", &path, NULL);
    if (file < 0) {
        tool_fail(error, -1, "the keys could not be written to the folder for temporary files");
        return NULL;
    }
    close(file);
    if (!view_keys_save(&app->model.now.keys, path, error))
        return path;
    unlink(path);
    g_free(path);
    return NULL;
}

// Run the command. input: one frame of a shot, in place of all.
static void run(struct view_app *app, const char *output, const char *input)
{
    struct tool_error error = {""};
    struct view_words words = {0};
    GError *why = NULL;
    struct job *job = g_new0(struct job, 1);
    job->app = app;
    job->output = g_strdup(output);
    if (view_keys_any(&app->model.now.keys) && !(job->keys = temporary_keys(app, &error))) {
        view_app_tell(app, "%s", error.text);
        free_job(job);
        return;
    }
    if (view_model_words(&app->model, output, job->keys, &words)) {
        view_app_tell(app, "out of memory");
        free_job(job);
        return;
    }
    GPtrArray *argv = g_ptr_array_new_with_free_func(g_free);
    g_ptr_array_add(argv, find_command());
    if (!input)
        g_ptr_array_add(argv, g_strdup("--verbose"));
    const int kept = input ? words.count - app->model.input_count : words.count;
    for (int i = 0; i < kept; i++)
        g_ptr_array_add(argv, g_strdup(words.list[i]));
    if (input)
        g_ptr_array_add(argv, g_strdup(input));
    g_ptr_array_add(argv, NULL);
    job->process = g_subprocess_newv((const char *const *)argv->pdata,
                                     G_SUBPROCESS_FLAGS_STDERR_PIPE | G_SUBPROCESS_FLAGS_STDOUT_SILENCE, &why);
    if (job->process) {
        app->job = job;
        job->lines = g_data_input_stream_new(g_subprocess_get_stderr_pipe(job->process));
        g_data_input_stream_read_line_async(job->lines, G_PRIORITY_DEFAULT, NULL, on_line, job);
        view_job_show(app, output, 0);
    } else {
        view_app_tell(app, "%s: %s", (const char *)argv->pdata[0], why->message);
        g_clear_error(&why);
        free_job(job);
    }
    g_ptr_array_unref(argv);
    view_words_free(&words);
}

int view_job_runs(struct view_app *app)
{
    if (app->job)
        view_app_tell(app, "%s is being written; wait for it or cancel it first.", app->job->output);
    return app->job != NULL;
}

void view_job_save_as(struct view_app *app, const char *path)
{
    if (!view_job_runs(app) && app->picture)
        run(app, path, app->picture->args.input);
}

static void on_save(GtkNativeDialog *dialog, int response, gpointer data)
{
    GFile *file = response == GTK_RESPONSE_ACCEPT ? gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog)) : NULL;
    char *path = file ? g_file_get_path(file) : NULL;
    if (path && g_object_get_data(G_OBJECT(dialog), "shot"))
        view_job_shot_as(data, path);
    else if (path)
        view_job_save_as(data, path);
    g_free(path);
    g_clear_object(&file);
    g_object_unref(dialog);
}

static void ask(struct view_app *app, const char *title, const char *suggested, int shot)
{
    GtkFileChooserNative *dialog =
        gtk_file_chooser_native_new(title, GTK_WINDOW(app->window), GTK_FILE_CHOOSER_ACTION_SAVE, "Save", "Cancel");
    char *base = g_path_get_basename(suggested);
    gtk_file_chooser_set_current_name(GTK_FILE_CHOOSER(dialog), base);
    g_object_set_data(G_OBJECT(dialog), "shot", GINT_TO_POINTER(shot));
    g_signal_connect(dialog, "response", G_CALLBACK(on_save), app);
    gtk_native_dialog_show(GTK_NATIVE_DIALOG(dialog));
    g_free(base);
}

// With an output on the command line nothing has to be asked.
void view_job_save(struct view_app *app)
{
    const char *given = view_model_get(&app->model, view_option_place("output"));
    if (given && !app->shot.sequence) {
        view_job_save_as(app, given);
        return;
    }
    char *output = app->picture ? view_job_output(app) : NULL;
    if (app->shot.sequence && app->picture) {
        char *frame = g_path_get_basename(app->picture->args.input);
        g_free(output);
        output = g_strdup_printf("dof.%s", frame);
        g_free(frame);
    }
    if (output)
        ask(app, "Save the picture", output, 0);
    g_free(output);
}

void view_job_shot_as(struct view_app *app, const char *pattern)
{
    if (!view_job_runs(app) && app->shot.jobs.count)
        run(app, pattern, NULL);
}

void view_job_shot(struct view_app *app)
{
    const char *given = view_model_get(&app->model, view_option_place("output"));
    char *output = view_job_output(app);
    if (given)
        view_job_shot_as(app, given);
    else
        ask(app, "Render all frames", output, 1);
    g_free(output);
}

void view_job_pause(struct view_app *app, int paused)
{
    if (!app->job)
        return;
    g_subprocess_send_signal(app->job->process, paused ? SIGSTOP : SIGCONT);
    view_say("%s %s", paused ? "paused" : "resumed", g_subprocess_get_identifier(app->job->process));
}

void view_job_cancel(struct view_app *app)
{
    if (!app->job)
        return;
    g_subprocess_send_signal(app->job->process, SIGTERM);
    g_subprocess_send_signal(app->job->process, SIGCONT);
}

// The bar.

static void on_pause(GtkToggleButton *button, gpointer data)
{
    view_job_pause(data, gtk_toggle_button_get_active(button));
}

static void on_cancel(GtkButton *button, gpointer data)
{
    (void)button;
    view_job_cancel(data);
}

GtkWidget *view_job_bar(struct view_app *app)
{
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
    GtkWidget *bar = gtk_progress_bar_new(), *pause = gtk_toggle_button_new_with_label("Pause");
    GtkWidget *cancel = gtk_button_new_with_label("Cancel");
    gtk_progress_bar_set_show_text(GTK_PROGRESS_BAR(bar), TRUE);
    gtk_progress_bar_set_ellipsize(GTK_PROGRESS_BAR(bar), PANGO_ELLIPSIZE_MIDDLE);
    gtk_widget_set_hexpand(bar, TRUE);
    gtk_widget_set_valign(bar, GTK_ALIGN_CENTER);
    view_name(bar, "Frames written");
    g_signal_connect(pause, "toggled", G_CALLBACK(on_pause), app);
    g_signal_connect(cancel, "clicked", G_CALLBACK(on_cancel), app);
    gtk_box_append(GTK_BOX(box), bar);
    gtk_box_append(GTK_BOX(box), pause);
    gtk_box_append(GTK_BOX(box), cancel);
    gtk_widget_add_css_class(box, "status");
    gtk_widget_set_visible(box, FALSE);
    g_object_set_data(G_OBJECT(box), "bar", bar);
    g_object_set_data(G_OBJECT(box), "pause", pause);
    app->progress = box;
    return box;
}

void view_job_show(struct view_app *app, const char *text, double done)
{
    GtkProgressBar *bar = g_object_get_data(G_OBJECT(app->progress), "bar");
    gtk_widget_set_visible(app->progress, text != NULL);
    gtk_progress_bar_set_fraction(bar, done);
    gtk_progress_bar_set_text(bar, text ? text : "");
    if (!text)
        gtk_toggle_button_set_active(g_object_get_data(G_OBJECT(app->progress), "pause"), FALSE);
    else if (done > 0)
        view_say("progress %.3f", done);
}
