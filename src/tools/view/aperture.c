// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/aperture.h"
#include "tools/view/name.h"

#include <math.h>

enum { SIZE = 32 };

// A polygon whose sides bend towards the circle around it, or a disc.
static void trace(cairo_t *c, const struct hf_aperture_params *a, double radius)
{
    enum { STEPS = 180 };
    for (int i = 0; i < STEPS; i++) {
        const double angle = 2 * M_PI * i / STEPS;
        double r = radius;
        if (a->blades >= 3) {
            const double half = M_PI / a->blades;
            const double turned = angle - a->rotation * M_PI / 180;
            const double beside = turned - 2 * half * round(turned / (2 * half));
            const double flat = cos(half) / cos(beside);
            r *= flat + (1 - flat) * a->roundness;
        }
        cairo_line_to(c, r * cos(angle), r * sin(angle));
    }
    cairo_close_path(c);
}

static void draw_picture(cairo_t *c, const struct hf_image *image, double radius)
{
    const double step = 2 * radius / SIZE;
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++) {
            const int u = x * image->width / SIZE, v = y * image->height / SIZE;
            double rgb[3];
            for (int k = 0; k < 3; k++)
                rgb[k] = ((const float *)((const char *)image->data[k] + v * image->stride[k]))[u];
            cairo_set_source_rgb(c, rgb[0], rgb[1], rgb[2]);
            cairo_rectangle(c, x * step - radius, y * step - radius, step, step);
            cairo_fill(c);
        }
}

static void draw(GtkDrawingArea *area, cairo_t *c, int width, int height, gpointer data)
{
    const struct hf_aperture_params *a = g_object_get_data(G_OBJECT(area), "aperture");
    const double radius = (width < height ? width : height) / 2.0 - 2;
    GdkRGBA colour;
    (void)data;
    if (!a)
        return;
    cairo_translate(c, width / 2.0, height / 2.0);
    cairo_scale(c, a->squeeze > 1 ? 1 / a->squeeze : 1, a->squeeze < 1 ? a->squeeze : 1);
    if (a->picture) {
        draw_picture(c, a->picture, radius);
        return;
    }
    gtk_style_context_get_color(gtk_widget_get_style_context(GTK_WIDGET(area)), &colour);
    gdk_cairo_set_source_rgba(c, &colour);
    cairo_set_fill_rule(c, CAIRO_FILL_RULE_EVEN_ODD);
    trace(c, a, radius);
    if (a->ring > 0)
        trace(c, a, radius * a->ring);
    cairo_fill(c);
}

GtkWidget *view_aperture_new(void)
{
    GtkWidget *area = view_drawing();
    gtk_drawing_area_set_content_width(GTK_DRAWING_AREA(area), SIZE);
    gtk_drawing_area_set_content_height(GTK_DRAWING_AREA(area), SIZE);
    gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(area), draw, NULL, NULL);
    gtk_widget_set_valign(area, GTK_ALIGN_CENTER);
    view_name(area, "Shape of the aperture");
    return area;
}

void view_aperture_set(GtkWidget *widget, const struct hf_aperture_params *aperture)
{
    g_object_set_data_full(G_OBJECT(widget), "aperture", aperture ? g_memdup2(aperture, sizeof(*aperture)) : NULL,
                           g_free);
    gtk_widget_queue_draw(widget);
}
