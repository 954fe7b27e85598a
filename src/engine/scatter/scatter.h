// SPDX-License-Identifier: BSD-3-Clause
// What the scatter engine knows of a frame: its levels, its scales, its options (engine.c, composite.c).
#ifndef HF_SCATTER_H
#define HF_SCATTER_H

#include <float.h>

#include "pixel/aperture.h"

// The engine's buffers.
enum hf_scatter_buf {
    HF_BUF_SOURCE,   // colour of every pixel, of a mixed one its front's (pixel/edges.h)
    HF_BUF_RADIUS,   // its signed radius
    HF_BUF_BACK,     // the back's colour; means nothing where this has no share
    HF_BUF_BACK_AT,  // the back's share, and its radius
    HF_BUF_FAR_SUM,
    HF_BUF_FAR_WEIGHT,
    HF_BUF_NEAR_SUM,
    HF_BUF_NEAR_WEIGHT,
    HF_SCATTER_BUFS
};

// Sums have a fixed point, so samples of very different brightness have sums of their own: those of a bin are below
// 2^62 of its units in all, and every share of a sample down to its least is a whole number of them. So the sums are
// exact, whatever else is in the frame. A bin takes at least HF_BIN_BITS exponents, so these bins hold all that floats
// have. A frame draws on a few of them, and does not touch the memory of the others.
enum { HF_BIN_BITS = 6, HF_BINS = (FLT_MAX_EXP - (FLT_MIN_EXP - FLT_MANT_DIG) + HF_BIN_BITS - 1) / HF_BIN_BITS };

struct hf_bins {
    int count;
    float least[HF_BINS];  // absolute samples from here on, and below the bin before; the last: 0
    double scale[HF_BINS][4], unscale[HF_BINS][4];  // from a sample's share to the integers of the sums, and back
};

// Channels that share pictures, and so a sum of weights.
struct hf_splat_group {
    int channels, channel[3];
    float factor[2];  // of the radius, near and far
};

struct hf_scatter {
    int ready;  // prepared: the rest is valid
    struct hf_aperture aperture;
    int groups;
    struct hf_splat_group group[4];
    int group_of[4];   // of each channel
    int opaque;        // alpha is 1 everywhere, as the weights' ratio is
    float largest[2];  // |r| of the frame, near and far
    // Radii between which pixels move from the full to the half-resolution sums, half_slope 1 / their difference; below
    // 0: there is nothing but the latter.
    float half_from, half_to, half_slope;
    float fade, fade_slope;            // radius up to which the pixel itself still shows, and 1 / its distance from 0.5
    int reach_x[2][2], reach_y[2][2];  // [field: near, far][level]: of the pictures, the level's pixels; -1: none
    int around_x, around_y;            // of the frame, half-resolution pixels, once its depth has been looked at
    int mixed;                         // there may be mixed pixels
    int slices;                        // of the far field (slice.c)
    int behind;                        // neighbourhoods that near radii ask for (behind.h)
    float ring, cat_eye;               // radii of the hole, and by which the second circle moves in the corners
    float corner;                      // 1 / the picture's diagonal, pixels
    struct hf_bins bins[2][2];         // [level][of colour, of alpha]
    // Samples are summed up and put together times dim, a power of two: below 1 where there are some that would overflow.
    float dim, undim, most;  // 1 / dim; dim times the largest float
};

// A share to 22 bits, by its own size: whole units of its bin.
static inline float hf_share(float v)
{
    const float t = v * 5;
    return t - (t - v);
}

static inline const struct hf_scatter *hf_scatter(const struct hf_setup *s)
{
    return s->own;
}

// What still shows of a pixel of radius r >= 0 itself: 1 for a sharp one.
static inline float hf_own_part(const struct hf_scatter *t, float r)
{
    return hf_saturate((t->fade - r) * t->fade_slope);
}

// How much of a pixel of radius r > 0 the half-resolution sums take.
static inline float hf_half_part(const struct hf_scatter *t, float r)
{
    return hf_saturate((r - t->half_from) * t->half_slope);
}

// How much of a pixel's radius, positive on the side of the field, is drawn in it, both levels together: what it does not
// show itself.
static inline float hf_field_weight(const struct hf_scatter *t, float r)
{
    return r > 0 ? 1 - hf_own_part(t, r) : 0;
}

// What the quads around a half-resolution source count in its radius.
#define HF_SITE_AROUND 0x1p-12f
// Of a pixel whole 64ths are parts of means: no part is so small that exact sums lose it.
enum { HF_ALIKE_LOG2 = 6 };

// How much of a pixel of radius r is alike to sources whose radii are so far apart from it at most.
static inline float hf_alike(float r, float apart)
{
    const float most = 0.25f + r * (1 / 32.0f);
    return (float)(int)(hf_saturate((most - apart) * 8) * (1 << HF_ALIKE_LOG2)) * (1.0f / (1 << HF_ALIKE_LOG2));
}

// Slices that a far field of radii up to this has.
enum { HF_SLICES = 8 };
int hf_slice_count(float largest);

// Floats of scratch that the splats of such a cell need, half-resolution pixels.
size_t hf_splat_work(const struct hf_scatter *t, int cell_width, int cell_height);

// One channel of a row of n pixels from (x, y) on: what its fields hold there. NULL: there is no such field.
struct hf_scatter_row {
    const struct hf_setup *setup;
    int x, y, n;
    const float *radius, *far, *far_weight, *near, *near_weight;
    const float *behind;  // what lies behind near pixels; NULL: what far ones say
    const float *column;  // where each is, if they do not lie side by side
};

// A row of pixels as parts of half-resolution means: n of these from column 0 on, two pixels each.
struct hf_tent_row {
    const struct hf_scatter *scatter;
    float sign;  // of the radii of the field
    int n, channels;
    const float *radius, *colour[3];
    const float *own, *next;  // radii of the quads of this row, and of the row that its tent reaches; from -1 to n
    float *pixel[2][4];       // even and odd: colour times weight, 3 the weight
};

// Sources to be drawn.
enum { HF_SPLATS = 128 };

struct hf_splats {
    int count;
    int32_t x[HF_SPLATS], y[HF_SPLATS];  // the level's pixels
    int32_t picture[HF_SPLATS];
    _Alignas(64) int64_t share[HF_SPLATS + 4][4];  // of each lane for 1 unit of weight
};

// A row of sources, the level's pixels from column x on.
struct hf_source_row {
    int x, y;
    const float *colour[3], *weight;  // colours are weighted
    const float *radius;              // times scale: of the picture
    float scale;
    const int32_t *picture;  // its number; -1: no source
};

// A window of sums: differences along x, four lanes a pixel: three channels and the weight. A row has pixels to spare
// before and after it, where all that begins or ends outside may come together.
enum { HF_SUMS_MARGIN = 8 };

struct hf_sums {
    int64_t *lane;
    ptrdiff_t *row;  // where pixel x0 of each row y0.. of the window is; rows are used again when they are settled
    int x0, y0, x1, y1;
};

#endif
