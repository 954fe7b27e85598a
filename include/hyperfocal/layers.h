// SPDX-License-Identifier: BSD-3-Clause
//
// Several pictures with depth that show one scene: separate renders of its objects, or what stands behind what a
// picture shows. Words, units, order of bytes, errors and how structs grow are those of hyperfocal.h.
#ifndef HYPERFOCAL_LAYERS_H
#define HYPERFOCAL_LAYERS_H

#include "hyperfocal.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a layer is to the others.
enum hf_layer_kind {
    HF_LAYER_WHOLE,  // a picture of its own, also where other layers hide it
    // What the layers before it hide: of each pixel the next surface behind them. Colour is premultiplied, alpha the
    // part of the pixel in which there is such a surface. Peels follow one whole picture, front to back; two of them
    // are used.
    HF_LAYER_PEEL,
};

// A picture with depth, one of several that show a scene.
struct hf_layer {
    size_t size;              // sizeof(struct hf_layer)
    enum hf_layer_kind kind;  // default HF_LAYER_WHOLE
    uint32_t reserved;
    // All layers have the same width and height; formats and types of depth may differ, but all or none are
    // HF_DEPTH_COC. A picture without alpha has alpha 1.
    const struct hf_image *image;
    const struct hf_depth *depth;
};

// Render a region (NULL: all) as hf_render_region does, from count (1 to 64) pictures with depth. Together they say
// what stands where and what stands behind it. A lens sees past edges. What it sees there is taken from the layers that
// show it, and guessed only where no layer does. The structs of the array follow each other at a distance of
// layers->size bytes. dst must not overlap a layer. With one layer the call is hf_render_region. With several, the
// engine must be HF_ENGINE_LAYERS or HF_ENGINE_SCATTER, else the call returns HF_ERR_ARG. The scatter engine takes of
// each pixel the first surface that is hidden, where something in front of the focus hides it, and guesses what is
// hidden elsewhere. If params->focus is HF_DERIVE, the focus comes from the first layer's depth. Errors as for
// hf_render_region.
HF_API int hf_render_layers(struct hf_context *c, const struct hf_image *dst, const struct hf_layer *layers, int count,
                            const struct hf_params *params, const struct hf_region *region);

// A deep picture: any number of samples in a pixel, in any order, in memory of the caller. Those of pixel i, counted
// row after row from the top left one, are first[i] to first[i + 1] - 1 of each array.
struct hf_deep {
    size_t size;            // sizeof(struct hf_deep)
    int width;              // pixels
    int height;             // pixels
    const uint64_t *first;  // width * height + 1 numbers, which never fall
    uint64_t samples;       // that each array below has; no number of first is more
    // Linear, premultiplied. Values that are not finite count as 0.
    const float *colour[3];
    const float *alpha;  // 0 to 1; a sample that has no more than 0 shows nothing
    // Numbers of the type that *as describes, of which data, stride and format are not read. NaN: the sample shows
    // nothing.
    const float *depth;
    const struct hf_depth *as;  // what the numbers mean
    // NULL, or the far end of each sample, also such a number: a medium that fills the way from depth to there evenly,
    // with alpha for all of it. One that is not behind depth is none.
    const float *back;
    // NULL, or the object that each sample belongs to, 0: unknown. Samples of one object that follow each other front
    // to back are beside each other in the pixel: their alpha adds up. Others are over each other.
    const uint32_t *object;
};

// Render a region (NULL: all) of a deep picture as hf_render_region does. Pixels without samples are transparent and
// infinitely far away. Three depths of a pixel are kept: what is seen, and two that may be hidden. Samples of about the
// same blur are put over each other first, and a medium is cut into eight parts. The engine must be HF_ENGINE_LAYERS
// or HF_ENGINE_SCATTER, which takes the first of the two, and params->focus must not be HF_DERIVE, else the call returns
// HF_ERR_ARG. Errors as for hf_render_region.
HF_API int hf_render_deep(struct hf_context *c, const struct hf_image *dst, const struct hf_deep *deep,
                          const struct hf_params *params, const struct hf_region *region);

#ifdef __cplusplus
}
#endif

#endif
