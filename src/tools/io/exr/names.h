// SPDX-License-Identifier: BSD-3-Clause
// How programs name the channels of an EXR: views, layers, colours.
//
//     ViewLayer.Combined.left.R      layer ViewLayer.Combined, of view left in a part with a multiView attribute
//     R                              the layer without a name, or that of its part's name where there are several parts
#ifndef HF_IO_EXR_NAMES_H
#define HF_IO_EXR_NAMES_H

#include "tools/io/exr/exr.h"

enum { HF_EXR_NAME = 256 };

// A part and the names of the views in it.
struct hf_exr_part_views {
    int count;
    bool multiview;
    const char *single[1];
    const exr_attr_string_vector_t *list;
};
struct hf_exr_part_views hf_exr_views_of(const struct hf_exr *e, int part);
const char *hf_exr_view_name(const struct hf_exr_part_views *v, int i);

// The index of channel "<prefix><name>" of a part, or -1.
int hf_exr_find_prefixed(const struct hf_exr_part *part, const char *prefix, const char *name);
// The names of R, G, B and A with this prefix, or NULL if one of the first three is missing.
const char *const *hf_exr_colour_names(const struct hf_exr_part *part, const char *prefix);
// The layer that a channel is the red of: its name including the dot. False if it is not a red.
bool hf_exr_layer_of_red(const struct hf_exr_part *part, const char *channel, char layer[HF_EXR_NAME]);
// Whether one of the dot-separated pieces of a channel name, except the last, is this word.
bool hf_exr_has_component(const char *channel, const char *word);

// depth.c: the depth beside or above a layer of a part, or -1. With plain, names without a prefix count too.
int hf_exr_layer_depth(const struct hf_exr_part *part, const char *prefix, const char *view, bool plain);
// Find the view's depth. alone: the whole file belongs to this view. given: the name that the user gave, or NULL.
int hf_exr_set_depth(const struct hf_exr *e, struct hf_io_view *v, bool alone, const char *given,
                     struct hf_io_error *err);

// layers.c: a set of colour channels.
struct hf_exr_colours {
    int part;
    char prefix[HF_EXR_NAME];  // the part of the name before R, with the dot
    char name[HF_EXR_NAME];    // of the layer, without the view; "" for one without
    char view[HF_EXR_NAME];
    int score;  // how likely it is the picture
    bool data;  // not a picture: masks, normals, depths
};
// List all sets of a file, to be freed. Returns how many, or -1 without memory.
int hf_exr_list_colours(const struct hf_exr *e, struct hf_exr_colours **out);
// Describe the set with a prefix in a part.
void hf_exr_describe_colours(const struct hf_exr *e, int part, const char *prefix, struct hf_exr_colours *c);
// How well a name given by the user fits; 0: not at all.
int hf_exr_layer_fits(const struct hf_exr *e, const struct hf_exr_colours *c, const char *wanted);
// The layer whose colours are the picture of a view, or "" if that is not clear. In a part with several views the
// layer's name must end in the view's.
void hf_exr_find_layer(const struct hf_exr_part *part, const char *view, bool multiview, char layer[HF_EXR_NAME]);

#endif
