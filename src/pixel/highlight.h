// SPDX-License-Identifier: BSD-3-Clause
// Highlights of clipped pictures: raised when a picture is read, lowered when it is stored. The luminance of a pixel, m,
// becomes M = m + more t^2, t = (m - from) / span within 0..1, and R, G and B grow in proportion. So M goes from the threshold
// on without a jump or a bend, grows with m, and is as much more than m for all m above 1. Back: below gain,
// t is the positive root of span t + more t^2 = M - from. Nothing is fused: the same bits everywhere.
//
// Luminance, as bright passes and the highlights of lens blurs have it, and not the largest channel: paint of one
// full channel is no lamp that has been clipped. What is below 0 has no part in it, for it does not grow.
#ifndef HF_HIGHLIGHT_H
#define HF_HIGHLIGHT_H

#include "pass/frame.h"

// Rec. 709, linear; they add up to 1.
#define HF_LUMINANCE_R 0.2126f
#define HF_LUMINANCE_G 0.7152f
#define HF_LUMINANCE_B 0.0722f

static inline struct hf_highlight hf_highlight_of(const struct hf_highlight_params *p)
{
    const float span = 1 - p->threshold;
    return (struct hf_highlight){
        .on = p->gain > 1, .gain = p->gain, .more = p->gain - 1, .from = p->threshold, .span = span, .scale = 1 / span};
}

#endif
