// SPDX-License-Identifier: BSD-3-Clause
// A colour sample that is NaN or infinite becomes the mean of the finite ones among its 8 neighbours in the same
// channel, else 0, rounded to the image's format.
#ifndef HF_REPAIR_H
#define HF_REPAIR_H

#include "pass/frame.h"

struct hf_repair {
    int x, y, channel;
    float value;
};
// List the repairs for the pixels [x0, x1) x [y0, y1), at most max of them. Returns the number of repairs needed.
size_t hf_repair_list(const struct hf_image *image, struct hf_rect pixels, struct hf_repair *list, size_t max);

#endif
