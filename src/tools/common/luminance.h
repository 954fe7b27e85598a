// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_TOOL_LUMINANCE_H
#define HF_TOOL_LUMINANCE_H

// Rec. 709.
static inline float tool_luminance(float r, float g, float b)
{
    return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

#endif
