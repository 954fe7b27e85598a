// SPDX-License-Identifier: BSD-3-Clause
// The file of a shot's keys, and the copy that a crash leaves.
#ifndef HF_VIEW_KEYS_FILE_H
#define HF_VIEW_KEYS_FILE_H

#include "tools/view/app.h"

// The keys have changed: keep a copy in the user's state folder until they are saved.
void view_keys_changed(struct view_app *app);
// Save them; ask for a name if they have none.
void view_keys_store(struct view_app *app);
// Save them as a file. Returns 0, or -1 with a sentence in the window.
int view_keys_store_as(struct view_app *app, const char *path);
// On opening a shot: read --keys FILE, or what a session that crashed has left.
void view_keys_begin(struct view_app *app);
// Let go of the copy, which stays where it is.
void view_keys_release(struct view_app *app);
// On closing the window: 1 if it may be closed now; else the user is asked.
int view_keys_end(struct view_app *app);

#endif
