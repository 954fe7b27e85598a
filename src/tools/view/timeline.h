// SPDX-License-Identifier: BSD-3-Clause
// The frames of a shot and the keys of its values.
#ifndef HF_VIEW_TIMELINE_H
#define HF_VIEW_TIMELINE_H

#include "tools/view/app.h"

// An option that may have keys: 1 there is one at this frame, 0 there is none, -1 it can have none, as there is no shot.
int view_timeline_key_state(struct view_app *app, const char *option);
// Set a key of an option's value at this frame, or take it away.
void view_timeline_toggle(struct view_app *app, const char *option);
// An option was given another value: where it has keys, the key of this frame gets it.
void view_timeline_follow(struct view_app *app, const char *option);

#endif
