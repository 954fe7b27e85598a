// SPDX-License-Identifier: BSD-3-Clause
// Colour samples that are NaN or infinite become the mean of the finite ones among their 8 neighbours in the same
// channel, else 0, rounded to the image's format.
#ifndef HF_REPAIR_H
#define HF_REPAIR_H

#include "pass/frame.h"

struct hf_repair {
    int x, y, channel;
    float value;
};
// Repairs for the pixels [x0, x1) x [y0, y1): at most max of them are written to list. Returns how many there are.
size_t hf_repair_list(const struct hf_image *image, struct hf_rect pixels, struct hf_repair *list, size_t max);

#endif
