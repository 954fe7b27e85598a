// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/name.h"
#include "tools/view/profiler.h"

#include <math.h>

#include "tools/view/say.h"

enum { ROW = 15, CURVE = 260, NAMES = 150, NUMBERS = 64, MARGIN = 8 };

static void text(cairo_t *c, double x, double y, const char *words)
{
    cairo_move_to(c, x, y);
    cairo_show_text(c, words);
}

static void draw_bars(cairo_t *c, const struct tool_report *r, double width, const GdkRGBA *ink)
{
    char number[32];
    double most = 0.01;
    for (int i = 0; i < r->inner.passes && i < TOOL_PASSES; i++)
        most = fmax(most, r->pass[i].ms);
    for (int i = 0; i < r->inner.passes && i < TOOL_PASSES; i++) {
        const double y = MARGIN + i * ROW;
        const double room = fmax(10, width - NAMES - NUMBERS);
        gdk_cairo_set_source_rgba(c, ink);
        text(c, 0, y + 11, r->pass[i].name ? r->pass[i].name : "");
        g_snprintf(number, sizeof(number), "%.2f ms", r->pass[i].ms);
        text(c, NAMES + room + 6, y + 11, number);
        cairo_set_source_rgb(c, 0.2, 0.52, 0.89);
        cairo_rectangle(c, NAMES, y + 2, room * r->pass[i].ms / most, ROW - 4);
        cairo_fill(c);
    }
}

// Lines stand at 60 and at 30 frames a second.
static void draw_curve(cairo_t *c, const struct view_profile *p, double x, double width, double height,
                       const GdkRGBA *ink)
{
    const int n = MIN(p->count, PROFILE_SHOWN);
    double most = 40;
    char words[64];
    for (int i = 0; i < n; i++)
        most = fmax(most, p->last[i]);
    for (int i = 1; i <= 2; i++) {
        const double y = height - MARGIN - 1000.0 / 60 * i / most * (height - 2 * MARGIN - 14);
        cairo_set_source_rgba(c, ink->red, ink->green, ink->blue, 0.3);
        cairo_rectangle(c, x, y, width, 1);
        cairo_fill(c);
        gdk_cairo_set_source_rgba(c, ink);
        g_snprintf(words, sizeof(words), "%d a second", 60 / i);
        if (most < 240)  // else they would stand on each other
            text(c, x + width - 76, y - 3, words);
    }
    cairo_new_path(c);  // text has moved the pen
    cairo_set_source_rgb(c, 0.9, 0.35, 0.1);
    cairo_set_line_width(c, 1.5);
    for (int i = 0; i < n; i++)
        cairo_line_to(c, x + width * i / (PROFILE_SHOWN - 1),
                      height - MARGIN -
                          p->last[(p->count - n + i) % PROFILE_SHOWN] / most * (height - 2 * MARGIN - 14));
    cairo_stroke(c);
    gdk_cairo_set_source_rgba(c, ink);
    g_snprintf(words, sizeof(words), "frame %d: %.1f ms", p->count, n ? p->last[(p->count - 1) % PROFILE_SHOWN] : 0.0);
    text(c, x, MARGIN + 8, words);
}

static void draw(GtkDrawingArea *area, cairo_t *c, int width, int height, gpointer data)
{
    struct view_app *app = data;
    GdkRGBA ink;
    gtk_style_context_get_color(gtk_widget_get_style_context(GTK_WIDGET(area)), &ink);
    cairo_set_font_size(c, 11);
    draw_bars(c, &app->profile.report, fmax(200, width - CURVE - 24), &ink);
    draw_curve(c, &app->profile, fmax(224, width - CURVE), CURVE, height, &ink);
}

GtkWidget *view_profiler_new(struct view_app *app)
{
    app->profiler = view_drawing();
    gtk_drawing_area_set_content_height(GTK_DRAWING_AREA(app->profiler), 2 * MARGIN + 11 * ROW);
    gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(app->profiler), draw, app, NULL);
    view_name(app->profiler, "Times of passes and frames");
    gtk_widget_add_css_class(app->profiler, "status");
    gtk_widget_set_visible(app->profiler, FALSE);
    return app->profiler;
}

void view_profiler_toggle(struct view_app *app)
{
    gtk_widget_set_visible(app->profiler, !gtk_widget_get_visible(app->profiler));
    view_say("profiler %d", gtk_widget_get_visible(app->profiler));
}

void view_profiler_refresh(struct view_app *app)
{
    if (gtk_widget_get_visible(app->profiler))
        gtk_widget_queue_draw(app->profiler);
}
