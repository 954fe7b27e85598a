// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/canvas.h"

#include <math.h>
#include <string.h>

#include "tools/view/look.h"
#include "tools/view/name.h"
#include "tools/view/say.h"

struct _ViewCanvas {
    GtkWidget parent;
    struct view_canvas_events events;
    void *cookie;
    struct view_picture *picture;
    struct view_result *whole, *now;  // the newest that shows all of the picture; the newest. They may be the same
    int unseen;                       // `now` has not been drawn yet
    int said;                         // before or divider is told when it is on the screen
    uint32_t *before;                 // all of the input at 1/before_n
    int before_n;
    // What is drawn, and what was drawn before: GTK keeps the last until the next is on the screen.
    cairo_surface_t *screen[2];
    int turn, failed;  // failed: there was no memory to draw, and that was told
    float gain, before_gain;
    struct view_camera camera;
    int fitted;  // the camera follows the size of the widget
    int show_before, divider;
    double divided;               // place of the divider, part of the width
    double pointer_x, pointer_y;  // of the widget; -1: not over it
    double start_x, start_y, camera_x, camera_y;
    enum { DRAG_NONE, DRAG_CLICK, DRAG_PAN, DRAG_DIVIDER } drag;
};

G_DEFINE_TYPE(ViewCanvas, view_canvas, GTK_TYPE_WIDGET)

enum { SLACK = 4, GRIP = 8, KEY_STEP = 64 };  // pixels that a click may move; around the divider; of an arrow key

static int factor(ViewCanvas *c)
{
    return MAX(1, gtk_widget_get_scale_factor(GTK_WIDGET(c)));
}

static struct view_screen screen_of(ViewCanvas *c)
{
    GtkWidget *w = GTK_WIDGET(c);
    return (struct view_screen){NULL, gtk_widget_get_width(w) * factor(c), gtk_widget_get_height(w) * factor(c)};
}

static void forget(ViewCanvas *c)
{
    if (c->whole != c->now)
        view_result_free(c->whole);
    view_result_free(c->now);
    c->whole = c->now = NULL;
    free(c->before);
    c->before = NULL;
}

static const struct hf_io_view *size_of(ViewCanvas *c)
{
    return c->picture ? view_picture_view(c->picture)->view : NULL;
}

// Keep the picture in sight.
static void hold(ViewCanvas *c)
{
    const struct view_screen s = screen_of(c);
    const struct hf_io_view *v = size_of(c);
    if (!v)
        return;
    const double w = v->width * c->camera.zoom * c->camera.aspect, h = v->height * c->camera.zoom;
    c->camera.x = w <= s.width ? (s.width - w) / 2 : CLAMP(c->camera.x, s.width - w, 0);
    c->camera.y = h <= s.height ? (s.height - h) / 2 : CLAMP(c->camera.y, s.height - h, 0);
}

static void changed(ViewCanvas *c)
{
    hold(c);
    gtk_widget_queue_draw(GTK_WIDGET(c));
    if (c->events.moved && c->picture)
        c->events.moved(c->cookie);
}

static void fit(ViewCanvas *c)
{
    const struct view_screen s = screen_of(c);
    const struct hf_io_view *v = size_of(c);
    if (v && s.width > 0 && s.height > 0)
        c->camera.zoom = fmin(1, fmin(s.width / (v->width * c->camera.aspect), (double)s.height / v->height));
}

void view_canvas_fit(ViewCanvas *c)
{
    c->fitted = 1;
    fit(c);
    changed(c);
}

void view_canvas_zoom(ViewCanvas *c, double zoom, double x, double y)
{
    const struct view_screen s = screen_of(c);
    const double least = size_of(c) ? fmin(1, 32.0 / MAX(size_of(c)->width, size_of(c)->height)) : 1;
    const double at_x = x < 0 ? s.width / 2.0 : x * factor(c), at_y = x < 0 ? s.height / 2.0 : y * factor(c);
    zoom = CLAMP(zoom, least, 32);
    // Above 1 whole numbers, so that all pixels are equally large.
    if (zoom > 1)
        zoom = round(zoom);
    c->camera.x = at_x - (at_x - c->camera.x) * zoom / c->camera.zoom;
    c->camera.y = at_y - (at_y - c->camera.y) * zoom / c->camera.zoom;
    c->camera.zoom = zoom;
    c->fitted = 0;
    changed(c);
}

double view_canvas_get_zoom(ViewCanvas *c)
{
    return c->camera.zoom;
}

struct view_camera view_canvas_camera(ViewCanvas *c)
{
    return view_camera_drawn(&c->camera);
}

void view_canvas_pan(ViewCanvas *c, double x, double y)
{
    c->camera.x += x * factor(c);
    c->camera.y += y * factor(c);
    c->fitted = 0;
    changed(c);
}

static void to_picture(ViewCanvas *c, double x, double y, double *px, double *py)
{
    const struct view_camera d = view_camera_drawn(&c->camera);
    *px = (x * factor(c) - d.x) / (d.zoom * d.aspect);
    *py = (y * factor(c) - d.y) / d.zoom;
}

int view_canvas_seen(ViewCanvas *c, struct hf_region *seen, int *n)
{
    const struct view_screen s = screen_of(c);
    const struct hf_io_view *v = size_of(c);
    double x0, y0, x1, y1;
    if (!v || s.width <= 0 || s.height <= 0)
        return 0;
    to_picture(c, 0, 0, &x0, &y0);
    to_picture(c, (double)s.width / factor(c), (double)s.height / factor(c), &x1, &y1);
    const int left = CLAMP((int)floor(x0), 0, v->width - 1), top = CLAMP((int)floor(y0), 0, v->height - 1);
    const int right = CLAMP((int)ceil(x1), left + 1, v->width), bottom = CLAMP((int)ceil(y1), top + 1, v->height);
    *seen = (struct hf_region){sizeof(*seen), left, top, right - left, bottom - top};
    *n = CLAMP((int)(1 / c->camera.zoom + 1e-6), 1, VIEW_REDUCTIONS);
    return 1;
}

// The input, encoded for the display, at the size that is seen.
static int make_before(ViewCanvas *c)
{
    struct hf_region seen;
    int n;
    if (!view_canvas_seen(c, &seen, &n))
        return 0;
    if (c->before && c->before_n == n && c->before_gain == c->gain)
        return 1;
    const struct view_pixels *p = view_picture_at(c->picture, n);
    free(c->before);
    c->before = p ? malloc((size_t)p->width * (size_t)p->height * sizeof(*c->before)) : NULL;
    c->before_n = n;
    c->before_gain = c->gain;
    if (c->before)
        view_look_row(p->plane[0], p->plane[1], p->plane[2], c->gain, c->before, p->width * p->height);
    return c->before != NULL;
}

static struct view_layer layer_of(const struct view_screen *s, const struct view_result *r)
{
    return (struct view_layer){r->pixels, r->at.x, r->at.y, r->at.width, r->at.height, r->n, 0, s->width};
}

static int draw_before(const struct view_screen *s, ViewCanvas *c)
{
    const struct view_pixels *p = make_before(c) ? view_picture_at(c->picture, c->before_n) : NULL;
    const int to = c->show_before ? s->width : (int)(c->divided * s->width);
    if (!p)
        return -1;
    const struct view_layer layer = {c->before, 0, 0, p->width, p->height, c->before_n, 0, to};
    return view_compose(s, &c->camera, &layer);
}

static void draw_divider(const struct view_screen *s, ViewCanvas *c)
{
    for (int y = 0; y < s->height; y++)
        for (int x = 0; x < factor(c); x++)
            s->pixels[(size_t)y * (size_t)s->width + (size_t)MIN(s->width - 1, (int)(c->divided * s->width) + x)] =
                0xffffffffu;
}

static int compose(ViewCanvas *c, const struct view_screen *s)
{
    const struct view_layer now = c->now ? layer_of(s, c->now) : (struct view_layer){0};
    int status = 0;
    if (!c->now || !view_compose_covers(s, &c->camera, &now)) {
        const struct view_layer whole = c->whole ? layer_of(s, c->whole) : now;
        view_compose_clear(s, 0xff1e1e1eu);
        if (c->whole && c->whole != c->now)
            status |= view_compose(s, &c->camera, &whole);
    }
    if (c->now)
        status |= view_compose(s, &c->camera, &now);
    if (c->picture && (c->show_before || c->divider))
        status |= draw_before(s, c);
    if (c->divider && !c->show_before)
        draw_divider(s, c);
    return status;
}

static const cairo_user_data_key_t pixels_key;

// A picture without alpha, which GTK's software drawing copies; a texture's pixels are converted one by one.
static cairo_surface_t *make_screen(const struct view_screen *s, int factor)
{
    uint32_t *pixels = malloc((size_t)s->width * (size_t)s->height * sizeof(*pixels));
    if (!pixels)
        return NULL;
    cairo_surface_t *made = cairo_image_surface_create_for_data((unsigned char *)pixels, CAIRO_FORMAT_RGB24, s->width,
                                                                s->height, s->width * 4);
    if (cairo_surface_set_user_data(made, &pixels_key, pixels, free)) {
        cairo_surface_destroy(made);
        free(pixels);
        return NULL;
    }
    cairo_surface_set_device_scale(made, factor, factor);
    return made;
}

// What the canvas shows; NULL: there is not enough memory. The two screens take turns: GTK looks at the last one until the next is
// drawn, and at none before that. So nothing has to be copied before it is drawn over, as cairo_surface_flush would do.
static cairo_surface_t *draw(ViewCanvas *c)
{
    struct view_screen s = screen_of(c);
    cairo_surface_t **to = &c->screen[c->turn ^= 1];
    if (*to && (cairo_image_surface_get_width(*to) != s.width || cairo_image_surface_get_height(*to) != s.height))
        g_clear_pointer(to, cairo_surface_destroy);
    if (!*to)
        *to = make_screen(&s, factor(c));
    if (!*to)
        return NULL;
    s.pixels = cairo_surface_get_user_data(*to, &pixels_key);
    return compose(c, &s) ? NULL : *to;
}

static gboolean tell_failure(gpointer data)
{
    ViewCanvas *c = data;
    if (c->events.failed)
        c->events.failed(c->cookie);
    g_object_unref(c);
    return G_SOURCE_REMOVE;
}

static void after_paint(GdkFrameClock *clock, gpointer data)
{
    ViewCanvas *c = data;
    g_signal_handlers_disconnect_by_func(clock, after_paint, data);
    if (c->said)
        view_say("before %d\ndivider %d at %g", c->show_before, c->divider, c->divided);
    c->said = 0;
    if (c->unseen != 2 || !c->now)
        return;
    c->unseen = 0;
    if (c->events.drawn)
        c->events.drawn(c->cookie, c->now);
}

static void snapshot(GtkWidget *widget, GtkSnapshot *to)
{
    ViewCanvas *c = VIEW_CANVAS(widget);
    const int width = gtk_widget_get_width(widget), height = gtk_widget_get_height(widget);
    if (width <= 0 || height <= 0)
        return;
    cairo_surface_t *surface = draw(c);
    if (!surface && !c->failed)
        g_idle_add(tell_failure, g_object_ref(c));
    c->failed = !surface;
    if (!surface)
        return;
    cairo_t *to_cairo = gtk_snapshot_append_cairo(to, &GRAPHENE_RECT_INIT(0, 0, (float)width, (float)height));
    cairo_set_source_surface(to_cairo, surface, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(to_cairo), CAIRO_FILTER_NEAREST);
    cairo_set_operator(to_cairo, CAIRO_OPERATOR_SOURCE);
    cairo_paint(to_cairo);
    cairo_destroy(to_cairo);
    if (c->unseen == 1 || c->said) {
        c->unseen = c->unseen ? 2 : 0;
        g_signal_connect(gtk_widget_get_frame_clock(widget), "after-paint", G_CALLBACK(after_paint), c);
    }
}

static void size_allocate(GtkWidget *widget, int width, int height, int baseline)
{
    ViewCanvas *c = VIEW_CANVAS(widget);
    (void)width;
    (void)height;
    (void)baseline;
    if (c->fitted)
        fit(c);
    changed(c);
}

void view_canvas_set_picture(ViewCanvas *c, struct view_picture *picture, int fit_it)
{
    const struct hf_io_view *old = size_of(c);
    const struct hf_io_view *now = picture ? view_picture_view(picture)->view : NULL;
    // The next frame of a shot: the last one stays on the screen until the new one is there.
    if (!old || !now || old->width != now->width || old->height != now->height)
        forget(c);
    free(c->before);
    c->before = NULL;
    view_picture_unref(c->picture);
    c->picture = picture ? view_picture_ref(picture) : NULL;
    c->camera.aspect = now && now->pixel_aspect >= 0.1f && now->pixel_aspect <= 10 ? now->pixel_aspect : 1;
    c->fitted |= fit_it;
    if (c->fitted)
        fit(c);
    hold(c);
    gtk_widget_queue_draw(GTK_WIDGET(c));
}

static int is_whole(const struct view_result *r)
{
    return r->at.x == 0 && r->at.y == 0 && r->at.width == r->width;
}

void view_canvas_set_result(ViewCanvas *c, struct view_result *r)
{
    if (r->picture != c->picture) {
        view_result_free(r);
        return;
    }
    if (c->now != c->whole)
        view_result_free(c->now);
    c->now = r;
    if (is_whole(r)) {
        view_result_free(c->whole);
        c->whole = r;
    }
    c->unseen = 1;
    gtk_widget_queue_draw(GTK_WIDGET(c));
}

const struct view_result *view_canvas_result(ViewCanvas *c)
{
    return c->now;
}

// Something other than the result is shown.
static void changed_alone(ViewCanvas *c)
{
    c->said = 1;
    gtk_widget_queue_draw(GTK_WIDGET(c));
}

void view_canvas_set_before(ViewCanvas *c, int before)
{
    if (c->show_before == before)
        return;
    c->show_before = before;
    changed_alone(c);
}

void view_canvas_set_divider(ViewCanvas *c, int shown)
{
    c->divider = shown;
    changed_alone(c);
}

int view_canvas_get_divider(ViewCanvas *c)
{
    return c->divider;
}

void view_canvas_set_gain(ViewCanvas *c, float gain)
{
    c->gain = gain;
}

static void move_divider(ViewCanvas *c, double divided)
{
    c->divided = CLAMP(divided, 0, 1);
    changed_alone(c);
}

// Events.

static void on_drag_begin(GtkGestureDrag *g, double x, double y, gpointer data)
{
    ViewCanvas *c = data;
    (void)g;
    gtk_widget_grab_focus(GTK_WIDGET(c));
    c->start_x = x;
    c->start_y = y;
    c->camera_x = c->camera.x;
    c->camera_y = c->camera.y;
    c->drag =
        c->divider && fabs(x - c->divided * gtk_widget_get_width(GTK_WIDGET(c))) < GRIP ? DRAG_DIVIDER : DRAG_CLICK;
}

static void on_drag_update(GtkGestureDrag *g, double x, double y, gpointer data)
{
    ViewCanvas *c = data;
    (void)g;
    if (c->drag == DRAG_DIVIDER) {
        move_divider(c, (c->start_x + x) / MAX(1, gtk_widget_get_width(GTK_WIDGET(c))));
        return;
    }
    if (c->drag == DRAG_CLICK && fabs(x) + fabs(y) > SLACK)
        c->drag = DRAG_PAN;
    if (c->drag != DRAG_PAN)
        return;
    c->camera.x = c->camera_x + x * factor(c);
    c->camera.y = c->camera_y + y * factor(c);
    changed(c);
}

static void focus_at(ViewCanvas *c, double x, double y)
{
    double px, py;
    to_picture(c, x, y, &px, &py);
    if (c->picture && c->events.click)
        c->events.click(c->cookie, px, py);
}

static void on_drag_end(GtkGestureDrag *g, double x, double y, gpointer data)
{
    ViewCanvas *c = data;
    (void)g;
    (void)x;
    (void)y;
    if (c->drag == DRAG_CLICK)
        focus_at(c, c->start_x, c->start_y);
    c->drag = DRAG_NONE;
}

// What the mouse does, by keys: the arrows move the picture, with Shift the divider; Return focuses.
static gboolean on_key(GtkEventControllerKey *keys, guint key, guint code, GdkModifierType state, gpointer data)
{
    ViewCanvas *c = data;
    GtkWidget *w = GTK_WIDGET(c);
    const int x = (key == GDK_KEY_Right) - (key == GDK_KEY_Left), y = (key == GDK_KEY_Down) - (key == GDK_KEY_Up);
    (void)keys;
    (void)code;
    if (state & (GDK_CONTROL_MASK | GDK_ALT_MASK))
        return FALSE;
    if (key == GDK_KEY_Return || key == GDK_KEY_KP_Enter) {
        const int over = c->pointer_x >= 0;
        focus_at(c, over ? c->pointer_x : gtk_widget_get_width(w) / 2.0,
                 over ? c->pointer_y : gtk_widget_get_height(w) / 2.0);
    } else if (x && state & GDK_SHIFT_MASK && c->divider) {
        move_divider(c, c->divided + x / 32.0);
    } else if (x || y) {
        view_canvas_pan(c, -x * KEY_STEP, -y * KEY_STEP);
    } else {
        return FALSE;
    }
    return TRUE;
}

static gboolean on_scroll(GtkEventControllerScroll *s, double dx, double dy, gpointer data)
{
    ViewCanvas *c = data;
    (void)s;
    (void)dx;
    const double zoom = c->camera.zoom;
    // Steps of a half below 1:1, whole numbers above.
    const double next = dy < 0 ? (zoom >= 1 ? fmax(zoom + 1, round(zoom * 1.25)) : fmin(1, zoom * 1.25))
                               : (zoom > 1 ? fmin(zoom - 1, round(zoom / 1.25)) : zoom / 1.25);
    view_canvas_zoom(c, next, c->pointer_x, c->pointer_y);
    return TRUE;
}

static void on_motion(GtkEventControllerMotion *m, double x, double y, gpointer data)
{
    ViewCanvas *c = data;
    const struct hf_io_view *v = size_of(c);
    double px, py;
    (void)m;
    c->pointer_x = x;
    c->pointer_y = y;
    to_picture(c, x, y, &px, &py);
    if (v && c->events.hover)
        c->events.hover(c->cookie, px, py, px >= 0 && py >= 0 && px < v->width && py < v->height);
}

static void on_leave(GtkEventControllerMotion *m, gpointer data)
{
    ViewCanvas *c = data;
    (void)m;
    c->pointer_x = -1;
    if (c->events.hover)
        c->events.hover(c->cookie, 0, 0, 0);
}

static void dispose(GObject *object)
{
    ViewCanvas *c = VIEW_CANVAS(object);
    forget(c);
    view_picture_unref(c->picture);
    c->picture = NULL;
    for (int i = 0; i < 2; i++)
        g_clear_pointer(&c->screen[i], cairo_surface_destroy);
    G_OBJECT_CLASS(view_canvas_parent_class)->dispose(object);
}

static void view_canvas_class_init(ViewCanvasClass *class)
{
    GtkWidgetClass *widget = GTK_WIDGET_CLASS(class);
    G_OBJECT_CLASS(class)->dispose = dispose;
    widget->snapshot = snapshot;
    widget->size_allocate = size_allocate;
    gtk_widget_class_set_css_name(widget, "canvas");
    gtk_widget_class_set_accessible_role(widget, GTK_ACCESSIBLE_ROLE_IMG);
}

static void view_canvas_init(ViewCanvas *c)
{
    c->camera = (struct view_camera){1, 1, 0, 0};
    c->gain = 1;
    c->divided = 0.5;
    c->fitted = 1;
    c->pointer_x = -1;
}

GtkWidget *view_canvas_new(const struct view_canvas_events *events, void *cookie)
{
    ViewCanvas *c = g_object_new(view_canvas_get_type(), NULL);
    GtkWidget *w = GTK_WIDGET(c);
    c->events = *events;
    c->cookie = cookie;
    GtkGesture *drag = gtk_gesture_drag_new();
    g_signal_connect(drag, "drag-begin", G_CALLBACK(on_drag_begin), c);
    g_signal_connect(drag, "drag-update", G_CALLBACK(on_drag_update), c);
    g_signal_connect(drag, "drag-end", G_CALLBACK(on_drag_end), c);
    gtk_widget_add_controller(w, GTK_EVENT_CONTROLLER(drag));
    GtkEventController *scroll = gtk_event_controller_scroll_new(GTK_EVENT_CONTROLLER_SCROLL_VERTICAL);
    g_signal_connect(scroll, "scroll", G_CALLBACK(on_scroll), c);
    gtk_widget_add_controller(w, scroll);
    GtkEventController *motion = gtk_event_controller_motion_new();
    g_signal_connect(motion, "motion", G_CALLBACK(on_motion), c);
    g_signal_connect(motion, "leave", G_CALLBACK(on_leave), c);
    gtk_widget_add_controller(w, motion);
    GtkEventController *keys = gtk_event_controller_key_new();
    g_signal_connect(keys, "key-pressed", G_CALLBACK(on_key), c);
    gtk_widget_add_controller(w, keys);
    gtk_widget_set_focusable(w, TRUE);
    gtk_widget_set_hexpand(w, TRUE);
    gtk_widget_set_vexpand(w, TRUE);
    gtk_widget_set_overflow(w, GTK_OVERFLOW_HIDDEN);
    view_name(w, "Picture");
    return w;
}
