// SPDX-License-Identifier: BSD-3-Clause
// A small drawing of the aperture: what a highlight becomes.
#ifndef HF_VIEW_APERTURE_H
#define HF_VIEW_APERTURE_H

#include <gtk/gtk.h>

#include "hyperfocal/hyperfocal.h"

GtkWidget *view_aperture_new(void);
// NULL: nothing. A picture must live as long as the widget.
void view_aperture_set(GtkWidget *widget, const struct hf_aperture_params *aperture);

#endif
