// SPDX-License-Identifier: BSD-3-Clause
#include "tools/io/exr/names.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

struct hf_exr_part_views hf_exr_views_of(const struct hf_exr *e, int p)
{
    struct hf_exr_part_views v = {.count = 1, .single = {e->parts[p].view}};
    const exr_attribute_t *a = NULL;
    if (exr_get_attribute_by_name(e->core, p, "multiView", &a) == EXR_ERR_SUCCESS && a &&
        a->type == EXR_ATTR_STRING_VECTOR && a->stringvector && a->stringvector->n_strings > 0) {
        v.multiview = true;
        v.list = a->stringvector;
        v.count = v.list->n_strings;
    }
    return v;
}

const char *hf_exr_view_name(const struct hf_exr_part_views *v, int i)
{
    return v->multiview ? v->list->strings[i].str : v->single[0];
}

// Channel "<prefix><name>" of a part: index or -1.
int hf_exr_find_prefixed(const struct hf_exr_part *part, const char *prefix, const char *name)
{
    char full[2 * HF_EXR_NAME];
    snprintf(full, sizeof(full), "%s%s", prefix, name);
    return hf_exr_find_channel(part, full);
}

// Names that programs give the channels of a colour. The first row whose R, G and B a layer has is taken.
static const char *const spellings[][4] = {
    {"R", "G", "B", "A"}, {"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}, {"Red", "Green", "Blue", "Alpha"}};
enum { SPELLINGS = sizeof(spellings) / sizeof(spellings[0]) };

const char *const *hf_exr_colour_names(const struct hf_exr_part *part, const char *prefix)
{
    for (int i = 0; i < SPELLINGS; i++)
        if (hf_exr_find_prefixed(part, prefix, spellings[i][0]) >= 0 &&
            hf_exr_find_prefixed(part, prefix, spellings[i][1]) >= 0 &&
            hf_exr_find_prefixed(part, prefix, spellings[i][2]) >= 0)
            return spellings[i];
    return NULL;
}

// Whether one of the dot-separated pieces of a channel name, except the last, is this word.
bool hf_exr_has_component(const char *channel, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = channel, *dot; n && (dot = strchr(at, '.')); at = dot + 1)
        if ((size_t)(dot - at) == n && !strncasecmp(at, word, n))
            return true;
    return false;
}

// The layer that a channel is the red of: its name including the dot. False if it is not a red.
bool hf_exr_layer_of_red(const struct hf_exr_part *part, const char *channel, char layer[HF_EXR_NAME])
{
    const char *dot = strrchr(channel, '.');
    if (!dot || dot == channel || dot + 1 - channel >= HF_EXR_NAME)
        return false;
    snprintf(layer, HF_EXR_NAME, "%.*s", (int)(dot + 1 - channel), channel);
    const char *const *names = hf_exr_colour_names(part, layer);
    return names && !strcmp(dot + 1, names[0]);
}
