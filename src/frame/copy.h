// SPDX-License-Identifier: BSD-3-Clause
// Sharp parts of a frame: copied as they are, except for samples that are not finite.
#ifndef HF_COPY_H
#define HF_COPY_H

#include "frame/context.h"

// How a frame may be copied: whether it is in place, whether both images have one format, and whether bits may be
// copied unchanged.
struct hf_copy {
    int in_place, alike, raw;
};

struct hf_copy hf_copy_plan(const struct hf_setup *s, const struct hf_image *dst, const struct hf_image *src);
// A rectangle of half-resolution pixels.
void hf_copy_sharp(const struct hf_copy *copy, struct hf_worker *w, struct hf_rect r);

// In place, a tile overwrites pixels from which its neighbours' repairs are made, so all repairs come first: find the
// samples to repair where nobody has read the colour yet ...
void hf_copy_scan(struct hf_worker *w, struct hf_rect r);
// ... and write the repairs if there are any. HF_ERR_MEMORY.
int hf_copy_repair(struct hf_context *c);

#endif
