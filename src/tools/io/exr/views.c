// SPDX-License-Identifier: BSD-3-Clause
// Which channels are a picture and which are its depth. The rules, in this order:
// - A part with a multiView attribute holds one view for each name in it. The first view has plain channel names (R),
//   the others have the view's name in front (left.R). Any other part holds one view, named by its view attribute, or
//   "".
// - A view needs the channels R, G and B, or Y. If several parts have them for a view of one name, the first part wins.
// - Only if the file has no such view, a layer (ViewLayer.Combined.R) is the picture, if it is clear which one.
// - For the depth, see find_depth in depth.c.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/io/exr/names.h"

static struct hf_io_box to_box(const exr_attr_box2i_t *b)
{
    return (struct hf_io_box){b->min.x, b->min.y, (int)((int64_t)b->max.x + 1), (int)((int64_t)b->max.y + 1)};
}

static float camera_value(const struct hf_exr *e, int p, const char *name)
{
    float f;
    return exr_attr_get_float(e->core, p, name, &f) == EXR_ERR_SUCCESS ? f : NAN;
}

// The row vector (x, y, z, 1) times "worldToCamera" has the distance along the camera's axis third; times "worldToNDC" it
// has it last.
static void find_axis(const struct hf_exr *e, int p, float axis[4])
{
    exr_attr_m44f_t m;
    const bool camera = exr_attr_get_m44f(e->core, p, "worldToCamera", &m) == EXR_ERR_SUCCESS;
    const bool known = camera || exr_attr_get_m44f(e->core, p, "worldToNDC", &m) == EXR_ERR_SUCCESS;
    for (int i = 0; i < 4; i++)
        axis[i] = known ? m.m[4 * i + (camera ? 2 : 3)] : NAN;
}

static int fill_windows(const struct hf_exr *e, struct hf_io_view *v, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[v->part];
    exr_attr_box2i_t display = part->window;
    exr_attr_v2f_t center = {.x = 0, .y = 0}, sensor;
    exr_attr_rational_t rate;
    if (hf_exr_check_part(e, v->part, err))
        return -1;
    exr_get_display_window(e->core, v->part, &display);
    if (display.max.x == INT32_MAX || display.max.y == INT32_MAX)
        return hf_io_fail(err, "%s: display window is too far out", e->path);
    v->width = part->width;
    v->height = part->height;
    v->data_window = to_box(&part->window);
    v->display_window = to_box(&display);
    v->pixel_aspect = v->screen_width = 1;
    exr_get_pixel_aspect_ratio(e->core, v->part, &v->pixel_aspect);
    exr_get_screen_window_center(e->core, v->part, &center);
    exr_get_screen_window_width(e->core, v->part, &v->screen_width);
    v->screen_center_x = center.x;
    v->screen_center_y = center.y;
    v->camera.focus = camera_value(e, v->part, "focus");
    v->camera.f_number = camera_value(e, v->part, "aperture");
    v->camera.focal_length_mm = camera_value(e, v->part, "pinholeFocalLength");
    v->camera.nominal_length_mm = camera_value(e, v->part, "nominalFocalLength");
    v->camera.sensor_width_mm =
        exr_attr_get_v2f(e->core, v->part, "sensorOverallDimensions", &sensor) == EXR_ERR_SUCCESS ? sensor.x : NAN;
    find_axis(e, v->part, v->camera.axis);
    if (exr_attr_get_rational(e->core, v->part, "framesPerSecond", &rate) == EXR_ERR_SUCCESS && rate.num > 0 &&
        rate.denom)
        v->frame_rate = rate.num / (double)rate.denom;
    return hf_io_check_window(e->path, "display window", v->display_window, err);
}

// Add the view with these channels to the file's list.
static int add_view(const struct hf_exr *e, struct hf_io_views *views, int p, const char *name, const char *prefix,
                    struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    struct hf_io_view *v = hf_io_add_view(views);
    if (!v)
        return hf_io_fail(err, "%s: out of memory", e->path);
    const char *const *names = hf_exr_colour_names(part, prefix);
    v->part = p;
    v->depth_part = -1;
    snprintf(v->name, sizeof(v->name), "%s", name);
    for (int k = 0; k < 4; k++) {
        const int c = hf_exr_find_prefixed(part, prefix, names ? names[k] : k == 3 ? "A" : "Y");
        if (c < 0)
            continue;
        snprintf(v->colour[k], sizeof(v->colour[k]), "%s", part->channels[c].name);
        if (part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1)
            return hf_io_fail(err, "%s: channel %s is subsampled (%d, %d), which is not supported", e->path,
                              v->colour[k], part->channels[c].x_sampling, part->channels[c].y_sampling);
    }
    if (!names && hf_exr_find_prefixed(part, prefix, "RY") >= 0)
        return hf_io_fail(err, "%s: luminance and chroma (channels Y, RY, BY) are not supported", e->path);
    return fill_windows(e, v, err);
}

static bool known_view(const struct hf_io_views *views, const char *name)
{
    for (int v = 0; v < views->count; v++)
        if (!strncmp(views->view[v].name, name, sizeof(views->view[v].name) - 1))
            return true;
    return false;
}

static int views_in_part(const struct hf_exr *e, struct hf_io_views *views, int p, bool layers, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    const struct hf_exr_part_views names = hf_exr_views_of(e, p);
    for (int i = 0; i < names.count; i++) {
        const char *name = hf_exr_view_name(&names, i);
        char prefix[2 * HF_EXR_NAME] = "", layer[HF_EXR_NAME];
        if (known_view(views, name))
            continue;
        if (names.multiview && i > 0)
            snprintf(prefix, sizeof(prefix), "%.*s.", HF_EXR_NAME, name);
        if (layers) {
            hf_exr_find_layer(part, name, names.multiview, layer);
            if (!layer[0])
                continue;
            snprintf(prefix, sizeof(prefix), "%s", layer);
        } else if (!hf_exr_colour_names(part, prefix) && names.multiview && i == 0) {
            snprintf(prefix, sizeof(prefix), "%.*s.", HF_EXR_NAME, name);
        }
        if (!hf_exr_colour_names(part, prefix) && hf_exr_find_prefixed(part, prefix, "Y") < 0)
            continue;
        if (add_view(e, views, p, name, prefix, err))
            return -1;
    }
    return 0;
}

static bool has_view(const struct hf_io_views *views, const struct hf_exr_colours *c)
{
    for (int i = 0; i < views->count; i++) {
        const char *red = views->view[i].colour[0];
        const size_t n = strlen(c->prefix);
        if (views->view[i].part == c->part && !strncmp(red, c->prefix, n) && !strchr(red + n, '.'))
            return true;
    }
    return false;
}

// Find the layer that the user's name means in each view that has such a layer, and add those that are not in the list
// yet. Returns in how many views it was found, or -1 with *err filled.
static int add_named(const struct hf_exr *e, struct hf_io_views *views, const struct hf_exr_colours *list, int count,
                     const char *wanted, struct hf_io_error *err)
{
    int added = 0;
    for (int i = 0; i < count; i++) {
        int best = -1, rank = 0;
        // The first set of its view adds all of them.
        for (int k = 0; k < count; k++) {
            if (strcmp(list[k].view, list[i].view))
                continue;
            if (k < i) {
                rank = 0;
                best = -1;
                break;
            }
            const int fits = hf_exr_layer_fits(e, &list[k], wanted);
            if (fits > rank || (fits && fits == rank && list[k].score > list[best].score)) {
                rank = fits;
                best = k;
            }
        }
        if (best < 0)
            continue;
        added++;
        if (!has_view(views, &list[best]) &&
            add_view(e, views, list[best].part, list[best].view, list[best].prefix, err))
            return -1;
    }
    return added;
}

// Add every layer that is a picture, the main ones first.
static int add_all(const struct hf_exr *e, struct hf_io_views *views, const struct hf_exr_colours *list, int count,
                   struct hf_io_error *err)
{
    for (int i = 0; i < count; i++)
        if (!list[i].data && !has_view(views, &list[i]) &&
            add_view(e, views, list[i].part, list[i].view, list[i].prefix, err))
            return -1;
    return 0;
}

static int no_layer(const struct hf_exr *e, const char *wanted, struct hf_io_error *err)
{
    char layers[1024], nearest[HF_EXR_NAME], meant[HF_EXR_NAME + 32] = "";
    hf_exr_layers(e, layers, sizeof(layers));
    if (hf_io_nearest(layers, wanted, nearest))
        snprintf(meant, sizeof(meant), " (did you mean %s?)", nearest);
    return hf_io_fail(err, "%s: there is no layer %s%s, the layers are: %s", e->path, wanted, meant, layers);
}

// Add the layers that --layer names, separated by commas.
static int choose_layers(const struct hf_exr *e, struct hf_io_views *views, const char *wanted, struct hf_io_error *err)
{
    struct hf_exr_colours *list;
    const int count = hf_exr_list_colours(e, &list);
    int status = count < 0 ? hf_io_fail(err, "%s: out of memory", e->path) : 0;
    for (const char *at = wanted; !status; at++) {
        char name[HF_EXR_NAME];
        const size_t n = strcspn(at, ",");
        snprintf(name, sizeof(name), "%.*s", (int)n, at);
        if (!strcmp(name, "all"))
            status = add_all(e, views, list, count, err);
        else {
            const int added = add_named(e, views, list, count, name, err);
            status = added < 0 ? -1 : added ? 0 : no_layer(e, name, err);
        }
        at += n;
        if (!*at)
            break;
    }
    free(list);
    return status;
}

// Of a file with deep parts alone: the first that is a picture, or the one that --layer names by the part's name.
static int find_deep(const struct hf_exr *e, struct hf_io_views *views, const struct hf_io_choice *choice,
                     struct hf_io_error *err)
{
    const bool named = choice->layer && strcmp(choice->layer, "all");
    for (int p = 0; p < e->part_count; p++)
        if (!hf_exr_is_deep(&e->parts[p]))
            return 0;
    for (int p = 0; p < e->part_count && !views->count; p++) {
        const struct hf_exr_part *part = &e->parts[p];
        const char *depth = choice->depth_channel ? choice->depth_channel : "Z";
        const int c = hf_exr_find_channel(part, depth);
        if ((named && strcmp(part->name, choice->layer)) ||
            (!hf_exr_colour_names(part, "") && hf_exr_find_prefixed(part, "", "Y") < 0))
            continue;
        if (add_view(e, views, p, part->view, "", err))
            return -1;
        struct hf_io_view *v = &views->view[0];
        v->deep = true;
        v->depth_part = c < 0 ? -1 : p;
        snprintf(v->depth, sizeof(v->depth), "%s", c < 0 ? "" : part->channels[c].name);
        // A grey picture has three equal colours.
        for (int k = 1; k < 3 && !hf_exr_colour_names(part, ""); k++)
            v->colour[k][0] = 0;
    }
    return 0;
}

// Set the layer that contains a view's colours.
static void set_layer(const struct hf_exr *e, struct hf_io_view *v)
{
    char prefix[HF_EXR_NAME];
    struct hf_exr_colours c;
    snprintf(prefix, sizeof(prefix), "%s", v->colour[0]);
    char *dot = strrchr(prefix, '.');
    prefix[dot ? dot + 1 - prefix : 0] = 0;
    hf_exr_describe_colours(e, v->part, prefix, &c);
    snprintf(v->layer, sizeof(v->layer), "%s", c.name);
}

int hf_exr_find_views(const struct hf_exr *e, struct hf_io_views *views, const struct hf_io_choice *choice,
                      struct hf_io_error *err)
{
    const bool named = choice->layer && strcmp(choice->layer, "all");
    bool alone = true;
    if (find_deep(e, views, choice, err))
        return -1;
    if (views->count)
        return 0;
    for (int layers = 0; layers < 2 && !views->count && !named; layers++)
        for (int p = 0; p < e->part_count; p++)
            if (!hf_exr_is_deep(&e->parts[p]) && views_in_part(e, views, p, layers, err))
                return -1;
    if (choice->layer && choose_layers(e, views, choice->layer, err))
        return -1;
    for (int v = 1; v < views->count; v++)
        alone &= !strcmp(views->view[v].name, views->view[0].name);
    for (int v = 0; v < views->count; v++) {
        set_layer(e, &views->view[v]);
        if (hf_exr_set_depth(e, &views->view[v], alone, choice->depth_channel, err))
            return -1;
    }
    return 0;
}

void hf_exr_channels(const struct hf_exr *e, char *buf, size_t size)
{
    for (int p = 0; p < e->part_count; p++)
        for (int c = 0; c < e->parts[p].channel_count; c++)
            hf_io_list(buf, size, e->part_count > 1 ? e->parts[p].name : NULL, e->parts[p].channels[c].name,
                       hf_exr_is_deep(&e->parts[p]) ? " (deep)" : "");
}

void hf_exr_layers(const struct hf_exr *e, char *buf, size_t size)
{
    struct hf_exr_colours *list;
    const int count = hf_exr_list_colours(e, &list);
    buf[0] = 0;
    for (int i = 0; i < count; i++) {
        bool again = false;  // the same layer in another view
        for (int k = 0; k < i; k++)
            again |= !strcmp(list[k].name, list[i].name);
        if (!again)
            hf_io_list(buf, size, NULL, list[i].name[0] ? list[i].name : "RGB", "");
    }
    free(list);
}

static bool has_depth(const struct hf_io_views *views, const struct hf_io_view *of)
{
    for (int i = 0; i < views->count; i++)
        if (views->view[i].depth_part == of->depth_part && !strcmp(views->view[i].depth, of->depth))
            return true;
    return false;
}

// Add to `found` the most likely picture among the layers whose depths are neither in views nor in found. False if none
// is left. Errors of such a layer are reported when it is used.
static bool next_other(const struct hf_exr *e, const struct hf_io_views *views, struct hf_io_views *found,
                       const struct hf_exr_colours *list, int count)
{
    struct hf_io_error ignored;
    struct hf_io_view best = {.depth_part = -1};
    int score = 0;
    for (int i = 0; i < count; i++) {
        struct hf_io_views one = {0};
        if (list[i].data || list[i].score <= score || has_view(views, &list[i]))
            continue;
        if (!add_view(e, &one, list[i].part, list[i].view, list[i].prefix, &ignored) &&
            !hf_exr_set_depth(e, &one.view[0], false, NULL, &ignored) && one.view[0].depth_part >= 0 &&
            !has_depth(views, &one.view[0]) && !has_depth(found, &one.view[0])) {
            best = one.view[0];
            score = list[i].score;
        }
        free(one.view);
    }
    struct hf_io_view *v = best.depth_part >= 0 ? hf_io_add_view(found) : NULL;
    if (v) {
        *v = best;
        set_layer(e, v);
    }
    return v;
}

int hf_exr_other_layers(const struct hf_exr *e, const struct hf_io_views *views, char *buf, size_t size)
{
    enum { SHOWN = 4 };
    struct hf_exr_colours *list;
    struct hf_io_views found = {0};
    const int count = hf_exr_list_colours(e, &list);
    while (next_other(e, views, &found, list, count))
        if (found.count <= SHOWN)
            hf_io_list(buf, size, NULL, found.view[found.count - 1].layer, "");
    const int others = found.count;
    const size_t n = strlen(buf);
    if (others > SHOWN && n < size)
        snprintf(buf + n, size - n, " and %d more", others - SHOWN);
    free(list);
    free(found.view);
    return others;
}
