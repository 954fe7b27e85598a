// SPDX-License-Identifier: BSD-3-Clause
// What the gather's files share: its passes and buffers, what it makes of its parameters, its kernels.
#ifndef HF_GATHER_H
#define HF_GATHER_H

#include "frame/engine.h"
#include "gather/taps.h"
#include "pixel/pass_c.h"

// In the order of the chapter's table 3.1.
enum hf_gather_pass {
    HF_GATHER_COC,
    HF_GATHER_DOWN,
    HF_GATHER_MAX_X,
    HF_GATHER_MAX_Y,
    HF_GATHER_BLUR_X,
    HF_GATHER_BLUR_Y,
    HF_GATHER_COMPUTATION,
    HF_GATHER_FILL,
    HF_GATHER_COMPOSITE,
    HF_GATHER_PASSES
};

// The buffers of the chapter's figure 3.6.
enum hf_gather_buf {
    HF_BUF_COC,        // full resolution: near even, near odd, far even, far odd lanes of each row
    HF_BUF_COLOR4,     // half-resolution colour, R G B (A)
    HF_BUF_COLORFAR4,  // half-resolution colour x far CoC
    HF_BUF_COC4,       // half-resolution near and far CoC
    HF_BUF_MAX_X,      // near CoC: the four steps of its outward blur
    HF_BUF_MAX,
    HF_BUF_BLUR_X,
    HF_BUF_BLUR,
    HF_BUF_NEAR,  // fields: colour
    HF_BUF_FAR,
    HF_BUF_NEAR_FILL,
    HF_BUF_FAR_FILL,
    HF_BUF_SUM,         // inside the gather: sums of weights, near and far
    HF_BUF_WEIGHT,      // with Karis average: w and far CoC x w
    HF_BUF_COLORW4,     // colour x w
    HF_BUF_COLORFARW4,  // colour x far CoC x w
    HF_BUF_COUNT
};

// How far around a pixel a pass reads.
enum hf_gather_halo {
    HF_HALO_NONE,
    HF_HALO_3X3,    // one pixel
    HF_HALO_MAX_X,  // reach of the near max and blur, along one axis
    HF_HALO_MAX_Y,
    HF_HALO_TAPS,
    HF_HALO_UPSAMPLE,  // one pixel, two for the cubic
};

struct hf_gather {
    float blend;  // of the fields with the picture: less than 1 below a strength of a quarter
    int karis, per_pixel_kernel, bicubic;
    enum hf_fill fill;  // of OPEN as of NONE: they differ in the taps
    enum hf_downsample downsample;
    enum hf_division division;
    int rings;
    int max_x, max_y;  // near max and blur reach to either side
    int smoothstep;    // measured: of the CoC, and how it is stored, once the radii are known
    enum hf_storage storage;
    struct hf_taps taps;      // of both fields
    struct hf_taps far_taps;  // measured: of the far one
};

static inline const struct hf_gather *hf_gather(const struct hf_setup *s)
{
    return s->own;
}

static inline const struct hf_taps *hf_gather_taps(const struct hf_setup *s, unsigned field)
{
    return field == HF_FAR && s->measured ? &hf_gather(s)->far_taps : &hf_gather(s)->taps;
}

struct hf_gather_kernels {
    struct hf_passes passes;
};
HF_DECLARE_KERNELS(hf_gather_kernels);

hf_kernel hf_gather_coc, hf_down_c, hf_max_x_c, hf_max_y_c, hf_blur_x_c, hf_blur_y_c, hf_gather_c, hf_fill_c,
    hf_composite_c;

struct hf_reach hf_gather_halo(const struct hf_setup *s, int halo);

extern const struct hf_engine_def hf_gather_engine;

// Uniform cubic B-spline a quarter of a pixel off the centre: weights of the neighbour on that side, of the one on
// the other side, and of the one behind the neighbour. The rest, 235/384, is the pixel's own.
#define CUBIC_NEIGHBOUR (121 / 384.0f)
#define CUBIC_OTHER (27 / 384.0f)
#define CUBIC_BEHIND (1 / 384.0f)

#endif
