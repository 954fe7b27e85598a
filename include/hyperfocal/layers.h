// SPDX-License-Identifier: BSD-3-Clause
//
// Several pictures with depth that show one scene: separate renders of its objects, or what stands behind what a picture shows.
// Words, units, order of bytes, errors and how structs grow are those of hyperfocal.h.
#ifndef HYPERFOCAL_LAYERS_H
#define HYPERFOCAL_LAYERS_H

#include "hyperfocal.h"

#ifdef __cplusplus
extern "C" {
#endif

// What a layer is to the others.
enum hf_layer_kind {
    HF_LAYER_WHOLE,  // a picture of its own, also where other layers hide it
    // What the layers before it hide: of each pixel the next surface behind them. Colour is premultiplied, alpha the part of
    // the pixel in which there is such a surface. Peels follow one whole picture, front to back; two of them are used.
    HF_LAYER_PEEL,
};

// A picture with depth, one of several that show a scene.
struct hf_layer {
    size_t size;              // sizeof(struct hf_layer)
    enum hf_layer_kind kind;  // default HF_LAYER_WHOLE
    uint32_t reserved;
    // All layers have the same width and height; formats and types of depth may differ, but all or none are HF_DEPTH_COC. A
    // picture without alpha has alpha 1.
    const struct hf_image *image;
    const struct hf_depth *depth;
};

// As hf_render_region (region NULL: all), of count pictures with depth, 1 to 64, that together say what stands where, and what
// stands behind: a lens sees past edges, and what it sees there is taken from the layers that show it and guessed only where
// none does. Structs of the array follow each other at layers->size. dst must not overlap a layer. With one layer it is
// hf_render_region. The engine must be HF_ENGINE_LAYERS when there are more, else HF_ERR_ARG. With params->focus HF_DERIVE
// the first layer's depth decides. Errors as for hf_render_region.
HF_API int hf_render_layers(struct hf_context *c, const struct hf_image *dst, const struct hf_layer *layers, int count,
                            const struct hf_params *params, const struct hf_region *region);

#ifdef __cplusplus
}
#endif

#endif
