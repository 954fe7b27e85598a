// SPDX-License-Identifier: BSD-3-Clause
// One option in the side panel: its name, and a control for its kind of value.
#ifndef HF_VIEW_ROW_H
#define HF_VIEW_ROW_H

#include "tools/view/app.h"

// What rows show beside the model.
struct view_shown_values {
    const struct hf_params *params;  // in effect; NULL: not known
    double nearest, farthest;        // surfaces of the picture
};

struct view_row;
// To be freed with g_free once its widgets are gone.
struct view_row *view_row_new(struct view_app *app, int option);
GtkWidget *view_row_widget(struct view_row *row);
void view_row_refresh(struct view_row *row, const struct view_shown_values *values);

#endif
