// SPDX-License-Identifier: BSD-3-Clause
// Checks of the caller's images and depth.
#ifndef HF_FRAME_CHECK_H
#define HF_FRAME_CHECK_H

#include "pass/check.h"

// Return HF_OK, or HF_ERR_ARG with one sentence in message that names argument and value.
int hf_check_image(const struct hf_image *image, const char *name, struct hf_message *message);
// dst may have memory for a region alone; NULL: for all.
int hf_check_images(const struct hf_image *dst, const struct hf_image *src, const struct hf_region *region,
                    struct hf_message *message);
int hf_check_depth(const struct hf_depth *d, int width, struct hf_message *message);
// Check only the meaning of depth values, also if there are no values yet.
int hf_check_depth_type(const struct hf_depth *d, struct hf_message *message);

#endif
