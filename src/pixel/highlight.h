// SPDX-License-Identifier: BSD-3-Clause
// Highlights of clipped pictures: raised when a picture is read, lowered when it is stored. A pixel of luminance m gets
// M = m + more t^2, with t = (m - from) / span clamped to 0..1, and R, G and B grow in proportion. So M starts at the
// threshold without a jump or a kink, increases with m, and exceeds it by a constant above 1. The way back: below gain,
// t is the positive root of span t + more t^2 = M - from. Nothing is fused: the same bits everywhere.
//
// The measure is luminance, as in bright passes and in highlights of lens blurs, not the largest channel: paint of one
// full channel is not a clipped lamp. Negative channels are left out, because they are not raised.
#ifndef HF_HIGHLIGHT_H
#define HF_HIGHLIGHT_H

#include "pass/frame.h"

// Rec. 709, linear; they sum to 1.
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
