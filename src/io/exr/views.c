// SPDX-License-Identifier: BSD-3-Clause
// Which channels are a picture and which are its depth. The rules, in this order:
// - a part with a multiView attribute holds a view per name: the first with plain channel names (R), the others with
//   the name in front (left.R); any other part holds one view, called as its view attribute says, or "";
// - a view needs R, G and B, or Y; the first part that has them for a name wins;
// - only when the file has no such view: a layer (ViewLayer.Combined.R), if it is clear which one;
// - depth: see find_depth.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/exr/exr.h"

enum { NAME = 256 };

// A part and the names of the views in it.
struct views_of_part {
    int count;
    bool multiview;
    const char *single[1];
    const exr_attr_string_vector_t *list;
};

static struct views_of_part views_of(const struct hf_exr *e, int p)
{
    struct views_of_part v = {.count = 1, .single = {e->parts[p].view}};
    const exr_attribute_t *a = NULL;
    if (exr_get_attribute_by_name(e->core, p, "multiView", &a) == EXR_ERR_SUCCESS && a &&
        a->type == EXR_ATTR_STRING_VECTOR && a->stringvector && a->stringvector->n_strings > 0) {
        v.multiview = true;
        v.list = a->stringvector;
        v.count = v.list->n_strings;
    }
    return v;
}

static const char *view_name(const struct views_of_part *v, int i)
{
    return v->multiview ? v->list->strings[i].str : v->single[0];
}

// Channel "<prefix><name>" of a part: index or -1.
static int find_prefixed(const struct hf_exr_part *part, const char *prefix, const char *name)
{
    char full[2 * NAME];
    snprintf(full, sizeof(full), "%s%s", prefix, name);
    return hf_exr_find_channel(part, full);
}

// How programs call the channels of a colour; the first spelling that a layer has all three of is taken.
static const char *const spellings[][4] = {
    {"R", "G", "B", "A"}, {"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}, {"Red", "Green", "Blue", "Alpha"}};
enum { SPELLINGS = sizeof(spellings) / sizeof(spellings[0]) };

static const char *const *colour_names(const struct hf_exr_part *part, const char *prefix)
{
    for (int i = 0; i < SPELLINGS; i++)
        if (find_prefixed(part, prefix, spellings[i][0]) >= 0 && find_prefixed(part, prefix, spellings[i][1]) >= 0 &&
            find_prefixed(part, prefix, spellings[i][2]) >= 0)
            return spellings[i];
    return NULL;
}

static bool has_colour(const struct hf_exr_part *part, const char *prefix)
{
    return colour_names(part, prefix) != NULL;
}

// How they call a depth, behind the name of its layer, whatever the case: Blender (Depth.Z, Depth.V), Arnold and most
// others (Z), RenderMan (z, zfiltered), V-Ray (VRayZDepth), Karma (Pz).
static const char *const depth_names[] = {
    "Z",        "depth.Z",  "depth.V",  "depth",     "depth.R", "depth.Y",    "Pz",           "depth.Pz",    "ZDepth",
    "ZDepth.Z", "ZDepth.R", "ZDepth.Y", "zfiltered", "Z.R",     "VRayZDepth", "VRayZDepth.R", "VRayZDepth.Z"};

// The depth that lies beside or above a layer of this part: <prefix>Z and the like, then the same for what is left when
// the prefix loses its last piece. With plain, names without a prefix count too. -1: none.
static int layer_depth(const struct hf_exr_part *part, const char *prefix, const char *view, bool plain)
{
    char base[NAME], full[2 * NAME];
    snprintf(base, sizeof(base), "%s", prefix);
    for (;;) {
        for (size_t i = 0; i < 2 * sizeof(depth_names) / sizeof(depth_names[0]) && (base[0] || plain); i++) {
            const bool own = i % 2;  // Depth.left.Z, of a view
            const char *name = depth_names[i / 2], *dot = strchr(name, '.');
            if (own && (!view[0] || !dot))
                continue;
            if (own)
                snprintf(full, sizeof(full), "%s%.*s.%.*s%s", base, (int)(dot - name), name, NAME / 2, view, dot);
            else
                snprintf(full, sizeof(full), "%s%s", base, name);
            for (int c = 0; c < part->channel_count; c++)
                if (!strcasecmp(part->channels[c].name, full))
                    return c;
        }
        if (!base[0])
            return -1;
        base[strlen(base) - 1] = 0;
        char *last = strrchr(base, '.');
        if (last)
            last[1] = 0;
        else
            base[0] = 0;
    }
}

// Is one of the dot-separated pieces of a channel name (the last, the channel itself, left out) this word?
static bool has_component(const char *channel, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = channel, *dot; n && (dot = strchr(at, '.')); at = dot + 1)
        if ((size_t)(dot - at) == n && !strncasecmp(at, word, n))
            return true;
    return false;
}

// The layer that a channel is the red of: its name with the dot behind it. False when it is none.
static bool layer_of_red(const struct hf_exr_part *part, const char *channel, char layer[NAME])
{
    const char *dot = strrchr(channel, '.');
    if (!dot || dot == channel || dot + 1 - channel >= NAME)
        return false;
    snprintf(layer, NAME, "%.*s", (int)(dot + 1 - channel), channel);
    const char *const *names = colour_names(part, layer);
    return names && !strcmp(dot + 1, names[0]);
}

// How likely a layer is the picture: called so, with a depth of its own, in the layer that programs make by default.
static int score_layer(const struct hf_exr_part *part, const char *layer, const char *view)
{
    static const char *const usual[] = {"combined", "rgba", "beauty", "Ci", "C"};
    static const char *const first[] = {"ViewLayer", "View Layer", "RenderLayer", "rgba", "beauty"};
    int score = 1;
    for (size_t i = 0; i < sizeof(usual) / sizeof(usual[0]); i++)
        score += has_component(layer, usual[i]) && score < 4 ? 4 : 0;
    score += layer_depth(part, layer, view, false) >= 0 ? 2 : 0;
    for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++)
        if (has_component(layer, first[i]))
            return score + 1;
    return score;
}

// The layer whose colours are the picture, or "" when it is not clear which. In a part with several views the layer's
// name must end in the view's.
static void find_layer(const struct hf_exr_part *part, const char *view, bool multiview, char layer[NAME])
{
    int best = 0, rivals = 0;
    layer[0] = 0;
    for (int c = 0; c < part->channel_count; c++) {
        char prefix[NAME];
        if (!layer_of_red(part, part->channels[c].name, prefix))
            continue;
        const size_t n = strlen(prefix), v = strlen(view);
        if (multiview && (n < v + 1 || strncmp(prefix + n - 1 - v, view, v) || (n > v + 1 && prefix[n - 2 - v] != '.')))
            continue;
        const int score = score_layer(part, prefix, view);
        if (score > best)
            snprintf(layer, NAME, "%s", prefix);
        rivals = score > best ? 0 : rivals + (score == best && score < 4);
        best = score > best ? score : best;
    }
    if (rivals)
        layer[0] = 0;
}

static struct hf_io_box to_box(const exr_attr_box2i_t *b)
{
    return (struct hf_io_box){b->min.x, b->min.y, (int)((int64_t)b->max.x + 1), (int)((int64_t)b->max.y + 1)};
}

static float camera_value(const struct hf_exr *e, int p, const char *name)
{
    float f;
    return exr_attr_get_float(e->core, p, name, &f) == EXR_ERR_SUCCESS ? f : NAN;
}

static int fill_windows(const struct hf_exr *e, struct hf_io_view *v, struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[v->part];
    exr_attr_box2i_t display = part->window;
    exr_attr_v2f_t center = {.x = 0, .y = 0}, sensor;
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
    v->camera.sensor_width_mm =
        exr_attr_get_v2f(e->core, v->part, "sensorOverallDimensions", &sensor) == EXR_ERR_SUCCESS ? sensor.x : NAN;
    return hf_io_check_window(e->path, "display window", v->display_window, err);
}

// Add the view with these channels to the file.
static int add_view(const struct hf_exr *e, struct hf_io_views *views, int p, const char *name, const char *prefix,
                    struct hf_io_error *err)
{
    const struct hf_exr_part *part = &e->parts[p];
    struct hf_io_view *v = hf_io_add_view(views);
    if (!v)
        return hf_io_fail(err, "%s: out of memory", e->path);
    const char *const *names = colour_names(part, prefix);
    v->part = p;
    v->depth_part = -1;
    snprintf(v->name, sizeof(v->name), "%s", name);
    for (int k = 0; k < 4; k++) {
        const int c = find_prefixed(part, prefix, names ? names[k] : k == 3 ? "A" : "Y");
        if (c < 0)
            continue;
        snprintf(v->colour[k], sizeof(v->colour[k]), "%s", part->channels[c].name);
        if (part->channels[c].x_sampling != 1 || part->channels[c].y_sampling != 1)
            return hf_io_fail(err, "%s: channel %s is subsampled (%d, %d), which is not supported", e->path,
                              v->colour[k], part->channels[c].x_sampling, part->channels[c].y_sampling);
    }
    if (!names && find_prefixed(part, prefix, "RY") >= 0)
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
    const struct views_of_part names = views_of(e, p);
    for (int i = 0; i < names.count; i++) {
        const char *name = view_name(&names, i);
        char prefix[2 * NAME] = "", layer[NAME];
        if (known_view(views, name))
            continue;
        if (names.multiview && i > 0)
            snprintf(prefix, sizeof(prefix), "%.*s.", NAME, name);
        if (layers) {
            find_layer(part, name, names.multiview, layer);
            if (!layer[0])
                continue;
            snprintf(prefix, sizeof(prefix), "%s", layer);
        } else if (!has_colour(part, prefix) && names.multiview && i == 0) {
            snprintf(prefix, sizeof(prefix), "%.*s.", NAME, name);
        }
        if (!has_colour(part, prefix) && find_prefixed(part, prefix, "Y") < 0)
            continue;
        if (add_view(e, views, p, name, prefix, err))
            return -1;
    }
    return 0;
}

// What one search for depth looks for.
struct depth_search {
    const struct hf_exr *e;
    const char *view;    // "" when the file names none
    const char *prefix;  // what stands before the R of the view's channels
    bool unprefixed;     // plain names are this view's
    int colour_part;     // -1: none
    bool any_part;       // the file has one view, so every part is about it
};

static bool part_is_ours(const struct depth_search *s, int p)
{
    if (hf_exr_is_deep(&s->e->parts[p]))
        return false;
    return p == s->colour_part || s->any_part || !strcmp(s->e->parts[p].view, s->view);
}

// The first of the view's parts that has the channel; the part of the colour comes first.
static int find_name(const struct depth_search *s, const char *name, int *channel)
{
    for (int i = -1; i < s->e->part_count; i++) {
        const int p = i < 0 ? s->colour_part : i;
        if (p < 0 || !part_is_ours(s, p))
            continue;
        *channel = hf_exr_find_channel(&s->e->parts[p], name);
        if (*channel >= 0)
            return p;
    }
    return -1;
}

// Does the name, left.depth.Z, speak of another view? Only a multiView attribute makes it so.
static bool names_other_view(const struct depth_search *s, int p, const char *channel)
{
    const struct views_of_part names = views_of(s->e, p);
    bool other = names.multiview && !s->unprefixed && !has_component(channel, s->view);
    for (int i = 0; i < names.count && names.multiview; i++)
        other |= strcmp(view_name(&names, i), s->view) && has_component(channel, view_name(&names, i));
    return other;
}

// Does a depth belong to another layer's picture: ViewLayer.Depth.Z beside Foreground.Combined.R?
static bool is_other_layers(const struct depth_search *s, int p, const char *channel)
{
    const struct hf_exr_part *part = &s->e->parts[p];
    const char *dot = strchr(channel, '.'), *own = strchr(s->prefix, '.');
    const size_t n = dot ? (size_t)(dot + 1 - channel) : 0;
    if (!n || !own || ((size_t)(own + 1 - s->prefix) == n && !strncmp(s->prefix, channel, n)))
        return false;
    for (int c = 0; c < part->channel_count; c++) {
        char layer[NAME];
        if (layer_of_red(part, part->channels[c].name, layer) && !strncmp(layer, channel, n))
            return true;
    }
    return false;
}

// The only channel called something with "depth" in it, or alone in a part called so: -1 when none or several.
static int find_any_depth(const struct depth_search *s, int *channel)
{
    for (int i = -1; i < s->e->part_count; i++) {
        const int p = i < 0 ? s->colour_part : i;
        int hits = 0;
        if (p < 0 || !part_is_ours(s, p))
            continue;
        const struct hf_exr_part *part = &s->e->parts[p];
        for (int c = 0; c < part->channel_count; c++) {
            const char *name = part->channels[c].name;
            const bool hit = strcasestr(name, "depth") || (part->channel_count == 1 && strcasestr(part->name, "depth"));
            if (!hit || names_other_view(s, p, name) || is_other_layers(s, p, name))
                continue;
            hits++;
            *channel = c;
        }
        if (hits)
            return hits == 1 ? p : -1;
    }
    return -1;
}

// The channel the user named: "<view>.<name>" of a view that has a name goes before "<name>", and "<part>:<name>" (as
// hf_io_channels prints it) picks the part.
static int find_given(const struct depth_search *s, const char *given, int *channel)
{
    char full[2 * NAME];
    const char *colon = strrchr(given, ':');
    for (int p = 0; colon && p < s->e->part_count; p++) {
        const char *name = s->e->parts[p].name;
        if (strlen(name) != (size_t)(colon - given) || strncmp(name, given, (size_t)(colon - given)) ||
            hf_exr_is_deep(&s->e->parts[p]))
            continue;
        *channel = hf_exr_find_channel(&s->e->parts[p], colon + 1);
        if (*channel >= 0)
            return p;
    }
    if (!s->unprefixed && s->view[0]) {
        snprintf(full, sizeof(full), "%.*s.%.*s", NAME - 2, s->view, NAME - 2, given);
        const int p = find_name(s, full, channel);
        if (p >= 0)
            return p;
    }
    return find_name(s, given, channel);
}

// The depth of the view's own layer, first in the part of its colour.
static int find_beside(const struct depth_search *s, int *channel)
{
    for (int i = -1; i < s->e->part_count; i++) {
        const int p = i < 0 ? s->colour_part : i;
        if (p < 0 || !part_is_ours(s, p))
            continue;
        *channel = layer_depth(&s->e->parts[p], s->prefix, s->view, s->unprefixed);
        if (*channel >= 0)
            return p;
    }
    return -1;
}

// Depth of a view: the given channel; else that of its layer (Z next to its R, and other names); for the view with plain names Z and depth.Z; <view>.Z,
// depth.<view>.Z, <view>.depth.Z; any single channel with "depth" in its name. Returns the part, or -1.
static int find_depth(const struct depth_search *s, const char *given, int *channel)
{
    static const char *const named[] = {"%.*s.Z", "depth.%.*s.Z", "%.*s.depth.Z"};
    char full[2 * NAME];
    if (given)
        return find_given(s, given, channel);
    int p = find_beside(s, channel);
    if (p < 0 && s->unprefixed)
        p = find_name(s, "Z", channel);
    if (p < 0 && s->unprefixed)
        p = find_name(s, "depth.Z", channel);
    for (int i = 0; i < 3 && p < 0 && s->view[0]; i++) {
        snprintf(full, sizeof(full), i == 0 ? named[0] : i == 1 ? named[1] : named[2], NAME, s->view);
        p = find_name(s, full, channel);
    }
    return p >= 0 ? p : find_any_depth(s, channel);
}

// The full name of view v: hf_io_view's may be cut off.
static const char *full_name(const struct hf_exr *e, const struct hf_io_view *v, bool *first)
{
    const struct views_of_part names = views_of(e, v->part);
    *first = true;
    for (int i = 0; i < names.count; i++) {
        const char *name = view_name(&names, i);
        *first = i == 0;
        if (!strncmp(name, v->name, sizeof(v->name) - 1))
            return name;
    }
    return v->name;
}

static int set_depth(const struct hf_exr *e, struct hf_io_view *v, bool alone, const char *given,
                     struct hf_io_error *err)
{
    struct depth_search s = {.e = e, .colour_part = v->part, .any_part = alone};
    char prefix[NAME];
    int c = -1;
    s.view = full_name(e, v, &s.unprefixed);
    s.prefix = prefix;
    snprintf(prefix, sizeof(prefix), "%s", v->colour[0]);
    char *dot = strrchr(prefix, '.');
    prefix[dot ? dot + 1 - prefix : 0] = 0;
    v->depth_part = find_depth(&s, given, &c);
    if (v->depth_part < 0)
        return 0;
    const struct hf_exr_channel *ch = &e->parts[v->depth_part].channels[c];
    snprintf(v->depth, sizeof(v->depth), "%s", ch->name);
    if (ch->x_sampling != 1 || ch->y_sampling != 1)
        return hf_io_fail(err, "%s: channel %s is subsampled (%d, %d), which is not supported", e->path, ch->name,
                          ch->x_sampling, ch->y_sampling);
    return hf_exr_check_part(e, v->depth_part, err);
}

int hf_exr_find_views(const struct hf_exr *e, struct hf_io_views *views, const char *depth_channel,
                      struct hf_io_error *err)
{
    for (int layers = 0; layers < 2 && !views->count; layers++)
        for (int p = 0; p < e->part_count; p++)
            if (!hf_exr_is_deep(&e->parts[p]) && views_in_part(e, views, p, layers, err))
                return -1;
    for (int v = 0; v < views->count; v++)
        if (set_depth(e, &views->view[v], views->count == 1, depth_channel, err))
            return -1;
    return 0;
}

int hf_exr_find_depth_only(const struct hf_exr *e, const char *depth_channel, const char *name, int *channel)
{
    struct depth_search s = {.e = e, .view = name, .prefix = "", .unprefixed = true, .colour_part = -1};
    char prefix[NAME];
    int flat = 0, last = -1;
    for (int p = 0; p < e->part_count && name[0]; p++) {
        const struct views_of_part names = views_of(e, p);
        for (int i = 1; i < names.count; i++)
            s.unprefixed &= strcmp(view_name(&names, i), name) != 0;
    }
    if (!s.unprefixed) {
        snprintf(prefix, sizeof(prefix), "%.*s.", NAME - 2, name);
        s.prefix = prefix;
    }
    for (int any = 0; any < 2; any++) {
        s.any_part = any;
        const int p = find_depth(&s, depth_channel, channel);
        if (p >= 0)
            return p;
    }
    if (depth_channel)
        return -1;
    for (int p = 0; p < e->part_count; p++) {
        flat += !hf_exr_is_deep(&e->parts[p]);
        last = hf_exr_is_deep(&e->parts[p]) ? last : p;
    }
    if (flat != 1)
        return -1;
    *channel = e->parts[last].channel_count == 1 ? 0 : hf_exr_find_channel(&e->parts[last], "R");
    return *channel >= 0 ? last : -1;
}

void hf_exr_channels(const struct hf_exr *e, char *buf, size_t size)
{
    for (int p = 0; p < e->part_count; p++)
        for (int c = 0; c < e->parts[p].channel_count; c++)
            hf_io_list(buf, size, e->part_count > 1 ? e->parts[p].name : NULL, e->parts[p].channels[c].name);
}
