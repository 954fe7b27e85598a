// SPDX-License-Identifier: BSD-3-Clause
// The side panel: a row for each option of the command's table that changes the picture.
#ifndef HF_VIEW_PANEL_H
#define HF_VIEW_PANEL_H

#include "tools/view/app.h"

// The panel's widget, in a scrolled window.
GtkWidget *view_panel_new(struct view_app *app);
// Show the model's values, and the derived ones.
void view_panel_refresh(struct view_app *app);
void view_panel_free(struct view_app *app);

#endif
