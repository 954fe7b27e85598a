// SPDX-License-Identifier: BSD-3-Clause
// Several pictures with depth become what an engine takes: one picture, and the surfaces behind it.
#ifndef HF_SURFACES_H
#define HF_SURFACES_H

#include "frame/context.h"
#include "hyperfocal/layers.h"

// The pictures of a call, copied and checked. The first is the one that is defocused.
enum { HF_MOST_LAYERS = 64 };
struct hf_surface_input {
    struct hf_image image;
    struct hf_depth depth;
    enum hf_layer_kind kind;
};

// A picture that several make up: colour over black, and the CoC radius of what is nearest.
struct hf_merged {
    struct hf_image image;
    struct hf_depth depth;
};

// Merge count whole pictures, each over those farther away, into *merged, and what they hide into *known. Both stay in the
// context until its next frame. s: a setup of the frame, of which the lens and the size count. Errors as below.
int hf_surfaces_merge(struct hf_context *c, const struct hf_setup *s, const struct hf_surface_input *in, int count,
                      int fused, struct hf_merged *merged, struct hf_known *known);

// Read count known surfaces into *known, whose planes stay in the context until its next frame. s: the setup of the frame,
// with all but these surfaces. HF_ERR_MEMORY, HF_ERR_CANCELLED.
int hf_surfaces_read(struct hf_context *c, struct hf_setup *s, const struct hf_surface_input *in, int count, int fused,
                     struct hf_known *known);

#endif
