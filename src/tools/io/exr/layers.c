// SPDX-License-Identifier: BSD-3-Clause
// Layers of colour: which exist, which one is the picture, and which one a name means.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "tools/io/exr/names.h"

// A score of how likely a layer is the picture: by its name, a depth of its own, and being the layer that programs make
// by default.
static int score_layer(const struct hf_exr_part *part, const char *layer, const char *view)
{
    static const char *const usual[] = {"combined", "rgba", "beauty", "Ci", "C"};
    static const char *const first[] = {"ViewLayer", "View Layer", "RenderLayer", "rgba", "beauty"};
    int score = 1;
    for (size_t i = 0; i < sizeof(usual) / sizeof(usual[0]); i++)
        score += hf_exr_has_component(layer, usual[i]) && score < 4 ? 4 : 0;
    score += hf_exr_layer_depth(part, layer, view, false) >= 0 ? 2 : 0;
    for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++)
        if (hf_exr_has_component(layer, first[i]))
            return score + 1;
    return score;
}

// The layer whose colours are the picture, or "" if that is not clear. In a part with several views the layer's name
// must end in the view's.
void hf_exr_find_layer(const struct hf_exr_part *part, const char *view, bool multiview, char layer[HF_EXR_NAME])
{
    int best = 0, rivals = 0;
    layer[0] = 0;
    for (int c = 0; c < part->channel_count; c++) {
        char prefix[HF_EXR_NAME];
        if (!hf_exr_layer_of_red(part, part->channels[c].name, prefix))
            continue;
        const size_t n = strlen(prefix), v = strlen(view);
        if (multiview && (n < v + 1 || strncmp(prefix + n - 1 - v, view, v) || (n > v + 1 && prefix[n - 2 - v] != '.')))
            continue;
        const int score = score_layer(part, prefix, view);
        if (score > best)
            snprintf(layer, HF_EXR_NAME, "%s", prefix);
        rivals = score > best ? 0 : rivals + (score == best && score < 4);
        best = score > best ? score : best;
    }
    if (rivals)
        layer[0] = 0;
}

// Whether a layer is data rather than a picture: masks, vectors, depths, a denoiser's inputs.
static bool is_data(const char *name)
{
    static const char *const within[] = {"crypto", "normal",   "motion", "velocity",
                                         "depth",  "position", "vector", "denoising"};
    static const char *const whole[] = {"N", "P", "Z", "Pz", "UV", "ST", "ID", "Pref"};
    char piece[2 * HF_EXR_NAME];
    for (size_t i = 0; i < sizeof(within) / sizeof(within[0]); i++)
        if (strcasestr(name, within[i]))
            return true;
    snprintf(piece, sizeof(piece), "%s.", name);
    for (size_t i = 0; i < sizeof(whole) / sizeof(whole[0]); i++)
        if (hf_exr_has_component(piece, whole[i]))
            return true;
    return false;
}

// The view that the last piece of a layer's prefix names, and where that piece begins; in a part without views, the
// part's own.
static const char *view_of(const struct hf_exr_part_views *views, const char *prefix, size_t *begin)
{
    const size_t n = strlen(prefix);
    *begin = n;
    for (int i = 0; i < views->count && views->multiview; i++) {
        const char *name = hf_exr_view_name(views, i);
        const size_t v = strlen(name);
        if (n >= v + 1 && !strncmp(prefix + n - 1 - v, name, v) && (n == v + 1 || prefix[n - 2 - v] == '.')) {
            *begin = n - 1 - v;
            return name;
        }
    }
    return hf_exr_view_name(views, 0);
}

void hf_exr_describe_colours(const struct hf_exr *e, int p, const char *prefix, struct hf_exr_colours *c)
{
    const struct hf_exr_part *part = &e->parts[p];
    const struct hf_exr_part_views views = hf_exr_views_of(e, p);
    size_t end;
    *c = (struct hf_exr_colours){.part = p};
    snprintf(c->prefix, sizeof(c->prefix), "%s", prefix);
    snprintf(c->view, sizeof(c->view), "%s", view_of(&views, prefix, &end));
    if (end > 0)
        snprintf(c->name, sizeof(c->name), "%.*s", (int)end - 1, prefix);
    else if (e->part_count > 1)
        snprintf(c->name, sizeof(c->name), "%s", part->name);
    c->score = prefix[0] ? score_layer(part, prefix, c->view) : 9;
    c->data = is_data(c->name);
}

int hf_exr_list_colours(const struct hf_exr *e, struct hf_exr_colours **out)
{
    int count = 0, room = 1;
    for (int p = 0; p < e->part_count; p++)
        room += e->parts[p].channel_count;
    *out = calloc((size_t)room, sizeof(**out));
    for (int p = 0; p < e->part_count && *out; p++) {
        const struct hf_exr_part *part = &e->parts[p];
        for (int c = 0; c < part->channel_count && !hf_exr_is_deep(part); c++) {
            char prefix[HF_EXR_NAME] = "";
            const char *const *names = hf_exr_colour_names(part, "");
            if (strchr(part->channels[c].name, '.') ? hf_exr_layer_of_red(part, part->channels[c].name, prefix)
                                                    : names && !strcmp(part->channels[c].name, names[0]))
                hf_exr_describe_colours(e, p, prefix, &(*out)[count++]);
        }
    }
    return *out ? count : -1;
}

// Whether text begins with word, followed by its end or a dot.
static bool begins_with(const char *text, const char *word)
{
    const size_t n = strlen(word);
    return n && !strncasecmp(text, word, n) && (text[n] == 0 || text[n] == '.');
}

int hf_exr_layer_fits(const struct hf_exr *e, const struct hf_exr_colours *c, const char *wanted)
{
    static const char *const plain[] = {"RGB", "RGBA", "main"};
    const char *last = strrchr(c->name, '.');
    if (!strcmp(c->name, wanted))
        return 6;
    if (!strcasecmp(c->name, wanted))
        return 5;
    for (size_t i = 0; i < sizeof(plain) / sizeof(plain[0]); i++)
        if (!c->prefix[0] && e->part_count == 1 && !strcasecmp(wanted, plain[i]))
            return 4;
    if (begins_with(c->name, wanted))
        return 3;
    if (begins_with(e->parts[c->part].name, wanted))
        return 2;
    return last && !strcasecmp(last + 1, wanted);
}
