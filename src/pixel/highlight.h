// SPDX-License-Identifier: BSD-3-Clause
// Highlights of clipped pictures: raised when a picture is read, lowered when it is stored. The largest of R, G and B, m,
// becomes M = m + more t^2, t = (m - from) / span within 0..1, and the others grow in proportion. So M goes from the threshold
// on without a jump or a bend, grows with m, and is as much more than m for all m above 1. Back: below gain,
// t is the positive root of span t + more t^2 = M - from. Nothing is fused: the same bits everywhere.
#ifndef HF_HIGHLIGHT_H
#define HF_HIGHLIGHT_H

#include "frame/frame.h"

static inline struct hf_highlight hf_highlight_of(const struct hf_highlight_params *p)
{
    const float span = 1 - p->threshold;
    return (struct hf_highlight){
        .on = p->gain > 1, .gain = p->gain, .more = p->gain - 1, .from = p->threshold, .span = span, .scale = 1 / span};
}

#endif
