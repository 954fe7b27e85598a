// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_VIEW_FALSE_COLOUR_H
#define HF_VIEW_FALSE_COLOUR_H

#include "tools/view/renderer.h"

// Paint what the request shows in place of the picture, over result->pixels. Of pictures that are shown as they are nothing
// changes.
void view_false_colour(const struct view_request *q, const struct view_pixels *p, const struct hf_params *params,
                       const struct hf_depth *depth, struct view_result *result);

// For hf_inspect_dump: keeps what all buffers hold, and the wanted one as the picture of the result.
struct view_dump {
    struct view_result *result;
    const char *wanted;
    const char *taken;  // the name of samples whose weights follow in another buffer; NULL: none
};
void view_dump_buffer(void *cookie, const struct hf_inspect_buffer *buffer);

#endif
