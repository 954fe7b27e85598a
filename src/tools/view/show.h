// SPDX-License-Identifier: BSD-3-Clause
// What may be shown in place of the picture: false colours of its depth, of its radii, of tiles and of the engine's buffers. No
// GTK.
#ifndef HF_VIEW_SHOW_H
#define HF_VIEW_SHOW_H

#include "hyperfocal/inspect.h"
#include "tools/view/picture.h"

enum view_show {
    VIEW_SHOW_AFTER,    // the result
    VIEW_SHOW_BEFORE,   // the input
    VIEW_SHOW_DEPTH,    // near bright, far dark
    VIEW_SHOW_COC,      // near red, far blue, in focus green
    VIEW_SHOW_PEAKING,  // the result, edges in focus marked
    VIEW_SHOW_TILES,    // what each tile ran
    VIEW_SHOW_BUFFER,   // a buffer of the engine
    VIEW_SHOWS
};

extern const char *const view_show_names[VIEW_SHOWS];

// Signed radii of n pixels of a picture with a depth, in its own pixels. Returns 0, or -1 if the parameters are wrong.
int view_radii(const struct hf_depth *depth, int width, int height, const struct hf_params *params,
               const struct hf_region *at, float *radii);

#endif
