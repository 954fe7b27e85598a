// SPDX-License-Identifier: BSD-3-Clause
// The widget that shows the picture: zoom, pan, clicks, the divider between before and after.
#ifndef HF_VIEW_CANVAS_H
#define HF_VIEW_CANVAS_H

#include <gtk/gtk.h>

#include "tools/view/compose.h"
#include "tools/view/renderer.h"

G_DECLARE_FINAL_TYPE(ViewCanvas, view_canvas, VIEW, CANVAS, GtkWidget)

struct view_canvas_events {
    void (*click)(void *cookie, double x, double y);                // a place in the picture, full-size pixels
    void (*moved)(void *cookie);                                    // another part of the picture is seen
    void (*hover)(void *cookie, double x, double y, int inside);    // the pointer is there
    void (*drawn)(void *cookie, const struct view_result *result);  // this result is on the screen for the first time
    void (*failed)(void *cookie);                                   // there is not enough memory to draw
};

GtkWidget *view_canvas_new(const struct view_canvas_events *events, void *cookie);
// A picture to show; fit: all of it. NULL: none.
void view_canvas_set_picture(ViewCanvas *c, struct view_picture *picture, int fit);
// Takes over the result.
void view_canvas_set_result(ViewCanvas *c, struct view_result *result);
const struct view_result *view_canvas_result(ViewCanvas *c);

void view_canvas_fit(ViewCanvas *c);
// Screen pixels for a pixel of the picture, with a place of the widget that stays; at x < 0 its middle.
void view_canvas_zoom(ViewCanvas *c, double zoom, double x, double y);
double view_canvas_get_zoom(ViewCanvas *c);
// Where the picture is drawn, see compose.h.
struct view_camera view_canvas_camera(ViewCanvas *c);
void view_canvas_pan(ViewCanvas *c, double x, double y);
// The visible part, and 1/n at which it is seen. 0 if nothing is seen.
int view_canvas_seen(ViewCanvas *c, struct hf_region *seen, int *n);

// The input in place of the result; left of the divider alone where the divider is shown.
void view_canvas_set_before(ViewCanvas *c, int before);
void view_canvas_set_divider(ViewCanvas *c, int shown);
int view_canvas_get_divider(ViewCanvas *c);
void view_canvas_set_gain(ViewCanvas *c, float gain);

#endif
