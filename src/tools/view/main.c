// SPDX-License-Identifier: BSD-3-Clause
// hyperfocal-view: focus, lens and look are turned while the picture answers.
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tools/common/standard.h"
#include "tools/view/app.h"
#include "tools/view/bench.h"
#include "tools/view/demo.h"
#include "tools/view/keys_file.h"
#include "tools/view/panel.h"
#include "tools/view/timeline.h"

struct start {
    struct view_app *app;
    struct tool_error error;
    int status;
};

static void begin(struct view_app *app)
{
    const char *frames = view_model_get(&app->model, view_option_place("frames"));
    if (app->own.bench)
        view_bench_begin(app);
    else if (app->model.input_count)
        view_app_open(app, NULL, 0);
    else
        view_demo_begin(app, app->own.demo && frames ? atoi(frames) : 0);
}

static void on_activate(GtkApplication *application, gpointer data)
{
    struct start *s = data;
    if (s->app->window)
        return;
    s->app->application = application;
    s->status = view_window_make(s->app, &s->error);
    if (!s->status)
        begin(s->app);
}

// What the window must not outlive.
static void end(struct view_app *app)
{
    if (app->bench)
        view_bench_free(app);
    view_demo_end(app);
    view_renderer_close(app->renderer);
    if (app->reload)
        g_source_remove(app->reload);
    g_clear_object(&app->monitor);
    view_frames_close(&app->frames);
    view_picture_unref(app->picture);
    if (app->apertures)
        g_ptr_array_unref(app->apertures);
    cli_shot_free(&app->shot);
    view_panel_free(app);
    view_timeline_free(app);
    g_free(app->loaded_by);
    g_free(app->keys_path);
    view_keys_release(app);
}

static int run_window(struct view_app *app, struct tool_error *error)
{
    struct start start = {.app = app};
    if (!gtk_init_check())
        return tool_fail(error, CLI_BAD_ARGUMENTS, "there is no display to open a window on");
    GtkApplication *application = gtk_application_new("org.hyperfocal.View", G_APPLICATION_NON_UNIQUE);
    g_signal_connect(application, "activate", G_CALLBACK(on_activate), &start);
    g_application_run(G_APPLICATION(application), 0, NULL);
    g_object_unref(application);
    end(app);
    if (!start.status && app->own.profile && view_profile_write(&app->profile, app->own.profile, error))
        start.status = tool_fail(&start.error, -1, "%s", error->text);
    view_profile_free(&app->profile);
    if (start.status)
        return tool_fail(error, CLI_BAD_ARGUMENTS, "%s", start.error.text);
    return 0;
}

static int run(int argc, char **argv, struct tool_error *error)
{
    static struct view_app app;
    int help = 0;
    int status = view_model_open(&app.model, &app.own, argc, argv, &help, error) ? CLI_BAD_ARGUMENTS : 0;
    if (!status && help > 2)
        tool_print_man(view_program());
    else if (!status && help)
        tool_print_help(view_program(), NULL, help > 1);
    else if (!status && app.own.cli.version)
        printf("hyperfocal-view %s\n", hf_version());
    else if (!status)
        status = run_window(&app, error);
    view_model_close(&app.model);
    return status;
}

// GTK draws by OpenGL. Where there is no GPU that is llvmpipe, which takes the cores that the picture needs: on two of them, 240 ms
// pass from an event to its pixels at 1080p, and 32 ms with cairo (`hyperfocal-view --bench`).
static void draw_without_gpu(void)
{
    if (access("/dev/dri/renderD128", F_OK))
        g_setenv("GSK_RENDERER", "cairo", FALSE);
}

int main(int argc, char **argv)
{
    struct tool_error error = {""};
    // Each frame takes and gives back pictures of the window's size: they are not given back to the system, which would clear them
    // before the next.
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 256 << 20);
    draw_without_gpu();
    tool_open_standard();
    tool_program = "hyperfocal-view";
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    const int status = run(argc, argv, &error);
    return tool_end(status, CLI_ALL_FAILED, &error);
}
