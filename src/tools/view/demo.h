// SPDX-License-Identifier: BSD-3-Clause
// --demo: a moving scene in real time, with the focus on the middle of the picture.
#ifndef HF_VIEW_DEMO_H
#define HF_VIEW_DEMO_H

#include "tools/view/app.h"

// Begin; frames: how many until the program ends, 0: until the user ends it.
void view_demo_begin(struct view_app *app, int frames);
void view_demo_end(struct view_app *app);
// 1 if all frames that were asked for have been on the screen.
int view_demo_done(const struct view_app *app);
// A frame is on the screen.
void view_demo_drawn(struct view_app *app);
// The blur goes away, or comes back, gradually.
void view_demo_fade(struct view_app *app);

// A picture of the scene. NULL without memory.
struct view_picture *view_scene_picture(int width, int height, double seconds);

#endif
