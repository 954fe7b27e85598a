// SPDX-License-Identifier: BSD-3-Clause
// What the chapter's files share: its passes and buffers, what it makes of its parameters, its kernels.
#ifndef HF_CHAPTER_H
#define HF_CHAPTER_H

#include "engine/chapter/taps.h"
#include "pixel/fields.h"

enum { HF_CHAPTER_FILL = HF_PASS_OWN, HF_CHAPTER_COMPOSITE, HF_CHAPTER_PASSES };

enum hf_chapter_buf {
    HF_BUF_NEAR_FILL = HF_BUF_OWN,
    HF_BUF_FAR_FILL,
    HF_BUF_COLORW4,     // colour x w, w being what a sample weighs with Karis average
    HF_BUF_COLORFARW4,  // colour x far CoC x w
    HF_CHAPTER_BUFS
};

enum { HF_HALO_3X3 = HF_HALO_OWN };

struct hf_chapter {
    struct hf_fields fields;
    int faithful;
    enum hf_fill fill;  // of OPEN as of NONE: they differ in the taps
    enum hf_downsample downsample;
    enum hf_division division;
    struct hf_tap_set taps;      // of both fields
    struct hf_tap_set far_taps;  // measured: of the far one
};

static inline const struct hf_chapter *hf_chapter(const struct hf_setup *s)
{
    return s->own;
}

static inline const struct hf_tap_set *hf_chapter_taps(const struct hf_setup *s, unsigned field)
{
    return field == HF_FAR && s->measured ? &hf_chapter(s)->far_taps : &hf_chapter(s)->taps;
}

// What a pixel becomes where there is near CoC, v, or what it was. The chapter takes v wherever there is any; then what
// the near field begins to reach changes at once, and lights up what is beside. So it comes in gradually, up to an eighth.
#define HF_NEAR_WHOLE 8.0f
static inline float hf_near_part(const struct hf_setup *s, float own, float v, float blur)
{
    const float part = HF_NEAR_WHOLE * blur;
    return !(blur > 0) ? own : hf_chapter(s)->faithful || part >= 1 ? v : own + part * (v - own);
}

struct hf_chapter_kernels {
    struct hf_passes passes;
};
HF_DECLARE_KERNELS(hf_chapter_kernels);

hf_kernel hf_chapter_down_c, hf_chapter_computation_c, hf_chapter_fill_c, hf_chapter_composite_c;

struct hf_reach hf_chapter_halo(const struct hf_setup *s, int halo);

extern const struct hf_engine_def hf_chapter_engine;

// A far pixel takes the colour of a neighbour that is less far than itself, but where it is more than so many times as far
// only so many times the neighbour's part: what begins to be far changes nothing at once, however far the pixels around are.
#define HF_FAR_WHOLE 16.0f
// Weights that sum to less have no inverse; pixels that are so little far stay what they are.
#define HF_FAR_LEAST 0x1p-120f

// Half-resolution colour stays below this, so that no sum of thousands passes the largest float.
#define HF_LARGEST 0x1p115f
// Full-resolution colour that is blended: less a field it is a float.
#define HF_BLENDED 0x1p127f

#endif
