// SPDX-License-Identifier: BSD-3-Clause
// The passes of the last frame as bars, and the times of the last frames as a curve.
#ifndef HF_VIEW_PROFILER_H
#define HF_VIEW_PROFILER_H

#include "tools/view/app.h"

GtkWidget *view_profiler_new(struct view_app *app);
void view_profiler_toggle(struct view_app *app);
// There is a new frame.
void view_profiler_refresh(struct view_app *app);

#endif
