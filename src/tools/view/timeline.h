// SPDX-License-Identifier: BSD-3-Clause
// The frames of a shot and the keys of its values.
#ifndef HF_VIEW_TIMELINE_H
#define HF_VIEW_TIMELINE_H

#include "tools/view/app.h"

GtkWidget *view_timeline_new(struct view_app *app);
void view_timeline_free(struct view_app *app);
void view_timeline_refresh(struct view_app *app);
// Go to a place in the shot.
void view_timeline_go(struct view_app *app, int place);
void view_timeline_play(struct view_app *app);

// An option that may have keys: 1 there is one at this frame, 0 there is none, -1 it can have none, as there is no shot.
int view_timeline_key_state(struct view_app *app, const char *option);
// Set a key of an option's value at this frame, or take it away.
void view_timeline_toggle(struct view_app *app, const char *option);
// An option was given another value: where it has keys, the key of this frame gets it, in the same step of undo.
void view_timeline_follow(struct view_app *app, const char *option);
// A click at a distance: if the focus has keys, that of this frame becomes it. Returns 1, else 0.
int view_timeline_focus(struct view_app *app, float distance);
// The number of the frame that is shown.
double view_timeline_frame(const struct view_app *app);

#endif
