// SPDX-License-Identifier: BSD-3-Clause
// One window with all that belongs to it, for the files that make its parts.
#ifndef HF_VIEW_APP_H
#define HF_VIEW_APP_H

#include <gtk/gtk.h>

#include "tools/cli/aperture.h"
#include "tools/cli/shot.h"
#include "tools/view/canvas.h"
#include "tools/view/frames.h"
#include "tools/view/model.h"
#include "tools/view/picture.h"
#include "tools/view/profile.h"
#include "tools/view/renderer.h"

struct view_panel;
struct view_timeline;
struct view_demo;
struct view_bench;
struct job;

// A picture of an aperture. The renderer may look at it until the window is closed.
struct view_aperture {
    char *path;
    struct cli_aperture read;
};

struct view_app {
    GtkApplication *application;
    GtkWidget *window;  // NULL: closed; what was under way may end after that
    GtkWidget *canvas, *notice, *notice_text, *value, *state, *zoom, *exposure, *progress, *shows, *buffers, *views;
    struct view_panel *panel;
    struct view_timeline *timeline;
    GtkWidget *profiler;
    struct view_profile profile;
    struct view_demo *demo;    // NULL: a picture is shown
    struct view_bench *bench;  // NULL: none runs
    unsigned serial;           // of the last request
    struct view_args own;      // what the command line asks for beyond the model
    struct view_model model;
    struct view_renderer *renderer;
    struct view_picture *picture;  // NULL: none
    GPtrArray *apertures;          // struct view_aperture: all that were ever read
    struct cli_setup setup;        // valid if set_up
    int set_up;
    enum view_show show;
    char buffer[VIEW_BUFFER];
    int loading;       // number of the load that counts; older ones are dropped
    int view;          // of the file, which is shown
    int load_pending;  // one runs
    char *loaded_by;   // the options that made the picture what it is
    double event_ms;   // of the event that the next request answers
    // A shot.
    struct cli_shot shot;
    int frame;  // place in shot.jobs
    // The focus glides from one distance to another.
    float glide_from, glide_to;
    double glide_start;
    guint glide_tick;
    struct job *job;   // a command that runs; NULL: none
    char *keys_path;   // where the keys were read from or saved
    int keys_unsaved;  // they have changed since
    char *spare;       // the copy of the keys for a crash; NULL: none
    int spare_lock;    // the file with its lock
    int quiet;         // the window itself changes its controls
    int closing;       // the window closes once they are saved
    struct view_frames frames;
    int playing, reading_ahead;
    int shots;  // how many were opened
    GFileMonitor *monitor;
    guint reload;
};

// session.c

// The model has changed: load what must be loaded, and ask for the picture.
void view_app_apply(struct view_app *app);
// The same, with the focus gliding from where it was.
void view_app_glide(struct view_app *app, float from);
// Ask for the picture as it is set up; moving: more will follow.
void view_app_ask(struct view_app *app, int moving);
// Load the file or the frame that is chosen.
void view_app_load(struct view_app *app);
// Show a picture that no file holds.
void view_app_use(struct view_app *app, struct view_picture *picture);
// Open other files.
void view_app_open(struct view_app *app, char *const *names, int count);
// Set an option; the result, an error too, is shown. Returns 0 or -1.
int view_app_set(struct view_app *app, int option, const char *value, int merge);
// A click: focus there.
void view_app_focus_at(struct view_app *app, double x, double y);
void view_app_undo(struct view_app *app, int redo);
// Show a sentence in the window; NULL: none.
void view_app_tell(struct view_app *app, const char *format, ...) __attribute__((format(printf, 2, 3)));

// window.c

// Make the window. Returns 0, or -1 with *error filled.
int view_window_make(struct view_app *app, struct tool_error *error);
// Show the model's and the picture's state.
void view_window_refresh(struct view_app *app);
// Close the window, from an idle source.
gboolean view_window_close(gpointer app);
// What is shown was replaced.
void view_window_drawn(struct view_app *app, const struct view_result *result);
// Show something in place of the picture; the picture again if that is shown.
void view_window_show(struct view_app *app, enum view_show show);
// Of the engine's buffers, if they are shown.
void view_window_next_buffer(struct view_app *app);
void view_window_hover(struct view_app *app, double x, double y, int inside);

#endif
