// SPDX-License-Identifier: BSD-3-Clause
// Names of controls, for those who do not see them.
#ifndef HF_VIEW_NAME_H
#define HF_VIEW_NAME_H

#include <gtk/gtk.h>

// An area to draw on, which counts as a picture.
GtkWidget *view_drawing(void);
void view_name(GtkWidget *widget, const char *name);
// The name of a choice, and of the button that opens it.
void view_name_choice(GtkWidget *down, const char *name);

#endif
