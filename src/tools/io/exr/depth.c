// SPDX-License-Identifier: BSD-3-Clause
// Finds the depth channel of a view.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "tools/io/exr/names.h"

// Names that programs give a depth, after the name of its layer, in any case: Blender (Depth.Z, Depth.V), Arnold and
// most others (Z), RenderMan (z, zfiltered), V-Ray (VRayZDepth), Karma (Pz, hitPz), Cinema 4D (Z Depth).
static const char *const depth_names[] = {
    "Z",           "depth.Z", "depth.V", "depth",      "depth.R",      "depth.Y",      "Pz",        "Pz.Z",
    "depth.Pz",    "hitPz",   "hitPz.Z", "ZDepth",     "ZDepth.Z",     "ZDepth.R",     "ZDepth.Y",  "zfiltered",
    "zfiltered.Z", "Z.R",     "Z.Z",     "VRayZDepth", "VRayZDepth.R", "VRayZDepth.Z", "Z Depth.R", "Z Depth.Y",
    "Z Depth.Z"};

static bool is_depth_name(const char *name)
{
    for (size_t i = 0; i < sizeof(depth_names) / sizeof(depth_names[0]); i++)
        if (!strcasecmp(name, depth_names[i]))
            return true;
    return false;
}

// The depth beside or above a layer of this part: <prefix>Z and similar names, then the same after removing the last
// piece of the prefix. With plain, names without a prefix count too. Returns -1 if there is none.
int hf_exr_layer_depth(const struct hf_exr_part *part, const char *prefix, const char *view, bool plain)
{
    char base[HF_EXR_NAME], full[2 * HF_EXR_NAME];
    snprintf(base, sizeof(base), "%s", prefix);
    for (;;) {
        for (size_t i = 0; i < 2 * sizeof(depth_names) / sizeof(depth_names[0]) && (base[0] || plain); i++) {
            const bool own = i % 2;  // Depth.left.Z, of a view
            const char *name = depth_names[i / 2], *dot = strchr(name, '.');
            if (own && (!view[0] || !dot))
                continue;
            if (own)
                snprintf(full, sizeof(full), "%s%.*s.%.*s%s", base, (int)(dot - name), name, HF_EXR_NAME / 2, view,
                         dot);
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

// The conditions of one search for depth.
struct depth_search {
    const struct hf_exr *e;
    const char *view;    // "" when the file names none
    const char *prefix;  // the part of the name before the R of the view's channels
    bool unprefixed;     // names without a prefix belong to this view
    int colour_part;     // -1: none
    bool any_part;       // the file has only one view, so every part belongs to it
};

// The length of the first piece of a part's name: fg in fg.depth, fg_depth.
static size_t first_piece(const char *name)
{
    return strcspn(name, "._/:");
}

static bool same_piece(const char *a, const char *b)
{
    const size_t n = first_piece(a);
    return n && n == first_piece(b) && !strncasecmp(a, b, n);
}

// Whether a part belongs to another picture, as bg.depth beside bg.rgba does if ours is fg.rgba.
static bool is_other_picture(const struct depth_search *s, int p)
{
    const struct hf_exr_part *parts = s->e->parts;
    if (s->colour_part < 0 || p == s->colour_part || same_piece(parts[p].name, parts[s->colour_part].name))
        return false;
    static const char *const whole[] = {"rgba", "rgb", "beauty", "main", "combined", "C", "Ci"};
    for (size_t i = 0; i < sizeof(whole) / sizeof(whole[0]); i++)
        if (!strcasecmp(parts[p].name, whole[i]))
            return false;
    if (hf_exr_colour_names(&parts[p], "") && parts[p].name[0])
        return !strcasestr(parts[p].name, "depth");
    for (int i = 0; i < s->e->part_count; i++)
        if (i != p && i != s->colour_part && hf_exr_colour_names(&parts[i], "") &&
            same_piece(parts[i].name, parts[p].name))
            return true;
    return false;
}

static bool part_is_ours(const struct depth_search *s, int p)
{
    if (hf_exr_is_deep(&s->e->parts[p]) || is_other_picture(s, p))
        return false;
    return p == s->colour_part || s->any_part || !strcmp(s->e->parts[p].view, s->view);
}

// The first of the view's parts that has the channel, the colour's part first.
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

// Whether a name such as left.depth.Z denotes another view; only a multiView attribute makes it so.
static bool names_other_view(const struct depth_search *s, int p, const char *channel)
{
    const struct hf_exr_part_views names = hf_exr_views_of(s->e, p);
    bool other = names.multiview && !s->unprefixed && !hf_exr_has_component(channel, s->view);
    for (int i = 0; i < names.count && names.multiview; i++)
        other |=
            strcmp(hf_exr_view_name(&names, i), s->view) && hf_exr_has_component(channel, hf_exr_view_name(&names, i));
    return other;
}

// Whether a depth belongs to another layer's picture: ViewLayer.Depth.Z beside Foreground.Combined.R.
static bool is_other_layers(const struct depth_search *s, int p, const char *channel)
{
    const struct hf_exr_part *part = &s->e->parts[p];
    const char *dot = strchr(channel, '.'), *own = strchr(s->prefix, '.');
    const size_t n = dot ? (size_t)(dot + 1 - channel) : 0;
    if (!n || !own || ((size_t)(own + 1 - s->prefix) == n && !strncmp(s->prefix, channel, n)))
        return false;
    for (int c = 0; c < part->channel_count; c++) {
        char layer[HF_EXR_NAME];
        if (hf_exr_layer_of_red(part, part->channels[c].name, layer) && !strncmp(layer, channel, n))
            return true;
    }
    return false;
}

// The only channel whose name contains "depth", or the only one in a part so named; -1 if there is none or several.
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

// The channel that the user named. For a view with a name, "<view>.<name>" precedes "<name>"; "<part>:<name>" (as
// hf_io_channels prints it) selects the part.
static int find_given(const struct depth_search *s, const char *given, int *channel)
{
    char full[2 * HF_EXR_NAME];
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
        snprintf(full, sizeof(full), "%.*s.%.*s", HF_EXR_NAME - 2, s->view, HF_EXR_NAME - 2, given);
        const int p = find_name(s, full, channel);
        if (p >= 0)
            return p;
    }
    return find_name(s, given, channel);
}

// The depth of the view's own layer, first in the colour's part.
static int find_beside(const struct depth_search *s, int *channel)
{
    // First the colour's own part, then parts with the same name, then the others.
    for (int turn = 0; turn < 3; turn++)
        for (int p = 0; p < s->e->part_count; p++) {
            const struct hf_exr_part *part = &s->e->parts[p];
            const bool own = p == s->colour_part;
            const bool named = s->colour_part >= 0 && same_piece(part->name, s->e->parts[s->colour_part].name);
            if ((turn == 0) != own || (turn < 2 && !own && !named) || !part_is_ours(s, p))
                continue;
            *channel = hf_exr_layer_depth(part, s->prefix, s->view, s->unprefixed);
            // A part that is a depth by its own name: Pz with a single channel Y.
            if (*channel < 0 && !own && part->channel_count == 1 && is_depth_name(part->name))
                *channel = 0;
            if (*channel >= 0)
                return p;
        }
    return -1;
}

// Unreal's depth, a part beside the picture with three equal colours: FinalImageMovieRenderQueue_WorldDepth.R.
static int find_unreal(const struct depth_search *s, int *channel)
{
    static const char *const ends[] = {"WorldDepth.R", "SceneDepth.R"};
    for (int i = -1; i < s->e->part_count; i++) {
        const int p = i < 0 ? s->colour_part : i;
        if (p < 0 || !part_is_ours(s, p))
            continue;
        for (int c = 0; c < s->e->parts[p].channel_count; c++) {
            const char *name = s->e->parts[p].channels[c].name;
            const size_t n = strlen(name), end = strlen(ends[0]);
            if (n < end || (strcasecmp(name + n - end, ends[0]) && strcasecmp(name + n - end, ends[1])) ||
                names_other_view(s, p, name))
                continue;
            *channel = c;
            return p;
        }
    }
    return -1;
}

// Find the depth of a view: the given channel; else that of its layer (Z next to its R, and other names); for the view
// with plain names Z and depth.Z; <view>.Z, depth.<view>.Z, <view>.depth.Z; the only channel with "depth" in its name.
// Returns the part, or -1.
static int find_depth(const struct depth_search *s, const char *given, int *channel)
{
    static const char *const named[] = {"%.*s.Z", "depth.%.*s.Z", "%.*s.depth.Z"};
    char full[2 * HF_EXR_NAME];
    if (given)
        return find_given(s, given, channel);
    int p = find_beside(s, channel);
    if (p < 0 && s->unprefixed)
        p = find_name(s, "Z", channel);
    if (p < 0 && s->unprefixed)
        p = find_name(s, "depth.Z", channel);
    for (int i = 0; i < 3 && p < 0 && s->view[0]; i++) {
        snprintf(full, sizeof(full), i == 0 ? named[0] : i == 1 ? named[1] : named[2], HF_EXR_NAME, s->view);
        p = find_name(s, full, channel);
    }
    if (p < 0)
        p = find_unreal(s, channel);
    return p >= 0 ? p : find_any_depth(s, channel);
}

// The full name of view v; that in hf_io_view may be cut off.
static const char *full_name(const struct hf_exr *e, const struct hf_io_view *v, bool *first)
{
    const struct hf_exr_part_views names = hf_exr_views_of(e, v->part);
    *first = true;
    for (int i = 0; i < names.count; i++) {
        const char *name = hf_exr_view_name(&names, i);
        *first = i == 0;
        if (!strncmp(name, v->name, sizeof(v->name) - 1))
            return name;
    }
    return v->name;
}

int hf_exr_set_depth(const struct hf_exr *e, struct hf_io_view *v, bool alone, const char *given,
                     struct hf_io_error *err)
{
    struct depth_search s = {.e = e, .colour_part = v->part, .any_part = alone};
    char prefix[HF_EXR_NAME];
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

int hf_exr_find_depth_only(const struct hf_exr *e, const char *depth_channel, const char *name, int *channel)
{
    struct depth_search s = {.e = e, .view = name, .prefix = "", .unprefixed = true, .colour_part = -1};
    char prefix[HF_EXR_NAME];
    int flat = 0, last = -1;
    for (int p = 0; p < e->part_count && name[0]; p++) {
        const struct hf_exr_part_views names = hf_exr_views_of(e, p);
        for (int i = 1; i < names.count; i++)
            s.unprefixed &= strcmp(hf_exr_view_name(&names, i), name) != 0;
    }
    if (!s.unprefixed) {
        snprintf(prefix, sizeof(prefix), "%.*s.", HF_EXR_NAME - 2, name);
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
