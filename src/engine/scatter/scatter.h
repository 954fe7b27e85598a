// SPDX-License-Identifier: BSD-3-Clause
// A frame's data in the scatter engine: its levels, its scales, its options (engine.c, composite.c).
#ifndef HF_SCATTER_H
#define HF_SCATTER_H

#include <float.h>

#include "pass/known.h"
#include "pixel/aperture.h"

// The engine's buffers.
enum hf_scatter_buf {
    HF_BUF_SOURCE,   // colour of every pixel; of a mixed one its front's (pixel/edges.h)
    HF_BUF_RADIUS,   // its signed radius
    HF_BUF_BACK,     // the back's colour, undefined where the back has no share
    HF_BUF_BACK_AT,  // the back's share, and its radius
    HF_BUF_HIDDEN,   // of frames with known surfaces: the first that near samples hide, likewise (known.c)
    HF_BUF_HIDDEN_AT,
    HF_BUF_FAR_SUM,
    HF_BUF_FAR_WEIGHT,
    HF_BUF_NEAR_SUM,
    HF_BUF_NEAR_WEIGHT,
    HF_SCATTER_BUFS
};

// Sums have a fixed point, so samples of very different brightness get sums of their own, called bins. The sums of a
// bin stay below 2^63 of its units, and every share of its samples is a whole number of units. So sums are exact,
// whatever else is in the frame. A bin takes at least HF_BIN_BITS exponents, so HF_BINS cover all floats. A frame uses
// few of them, and never touches the memory of the others. Four sources side by side that belong to two bins cost twice.
enum { HF_BIN_BITS = 6, HF_BINS = (FLT_MAX_EXP - (FLT_MIN_EXP - FLT_MANT_DIG) + HF_BIN_BITS - 1) / HF_BIN_BITS };

struct hf_bins {
    int count;
    float least[HF_BINS];  // a bin holds absolute samples from here on, below the bin before; the last: 0
    double scale[HF_BINS][4], unscale[HF_BINS][4];  // from a sample's share to the integers of the sums, and back
};

// Channels that share sprites, and therefore a sum of weights.
struct hf_splat_group {
    int channels, channel[3];
    float factor[2];  // of the radius, near and far
};

struct hf_scatter {
    int ready;  // prepared: the other members are valid
    // turned: the aperture in front of the focus, by half a turn, if that shows.
    struct hf_aperture aperture, turned;
    int turns;
    int groups;
    struct hf_splat_group group[4];
    int group_of[4];   // of each channel
    int opaque;        // alpha is 1 everywhere, as is the quotient of its sums
    float largest[2];  // largest |r| of the frame, near and far
    // Between these radii pixels move from the full-resolution to the half-resolution sums; half_slope is 1 / their
    // difference. Below 0: only the latter are used.
    float half_from, half_to, half_slope;
    float fade, fade_slope;  // from this radius on the pixel itself is invisible; 1 / (fade - 0.5)
    int reach_x[2][2],
        reach_y[2][2];             // [field: near, far][level]: reach of the sprites in the level's pixels; -1: none
    int around_x, around_y;        // reach around a cell, half-resolution pixels; valid once the frame's depth is known
    int mixed;                     // there may be mixed pixels
    const struct hf_known *given;  // known surfaces, or NULL
    int slices;                    // of the far field (slice.c)
    int behind;                    // levels of neighbourhoods that near radii need (pixel/behind.h)
    float ring, cat_eye;           // radius of the hole; how far the second circle moves in the corners
    float trust;                   // 1 / the weight from which on a field's colour counts fully; INFINITY: every weight
    float corner;                  // 1 / the picture's diagonal, pixels
    struct hf_bins bins[2][2];     // [level][of colour, of alpha]
    // Samples are summed and composited times dim, a power of two below 1 if some would overflow.
    float dim, undim, most;  // 1 / dim; dim times the largest float
};

// A share rounded to 22 bits, so that it is a whole number of its bin's units.
static inline float hf_share(float v)
{
    const float t = v * 5;
    return t - (t - v);
}

// The sprites of a field: 0 near, 1 far.
static inline const struct hf_aperture *hf_scatter_aperture(const struct hf_scatter *t, int field)
{
    return t->turns && !field ? &t->turned : &t->aperture;
}

static inline const struct hf_scatter *hf_scatter(const struct hf_setup *s)
{
    return s->own;
}

// The visible part of a pixel of radius r >= 0 itself: 1 for a sharp one.
static inline float hf_own_part(const struct hf_scatter *t, float r)
{
    return hf_saturate((t->fade - r) * t->fade_slope);
}

// The part of a pixel of radius r > 0 that the half-resolution sums take.
static inline float hf_half_part(const struct hf_scatter *t, float r)
{
    return hf_saturate((r - t->half_from) * t->half_slope);
}

// The part of a pixel that is drawn in a field, at both levels together: what the pixel does not show itself. r: its
// radius, positive on the field's side.
static inline float hf_field_weight(const struct hf_scatter *t, float r)
{
    return r > 0 ? 1 - hf_own_part(t, r) : 0;
}

// Weight of the quads around a half-resolution source in its radius.
#define HF_SITE_AROUND 0x1p-12f
// The part of a pixel that belongs to means is a whole number of 64ths, so that exact sums lose none.
enum { HF_ALIKE_LOG2 = 6 };

// How far a pixel of radius r counts as similar to sources whose radii differ from it by `apart` at most.
static inline float hf_alike(float r, float apart)
{
    const float most = 0.25f + r * (1 / 32.0f);
    return (float)(int)(hf_saturate((most - apart) * 8) * (1 << HF_ALIKE_LOG2)) * (1.0f / (1 << HF_ALIKE_LOG2));
}

// The number of slices of a far field with radii up to this.
enum { HF_SLICES = 8 };
int hf_scatter_slice_count(float largest);

// Floats of scratch that the splats of a cell need; its size is in half-resolution pixels.
size_t hf_splat_work(const struct hf_scatter *t, int cell_width, int cell_height);

// One channel of a row of n pixels from (x, y) on: the values of its fields. NULL: there is no such field.
struct hf_scatter_row {
    const struct hf_setup *setup;
    int x, y, n;
    const float *radius, *far, *far_weight, *near, *near_weight;
    const float *behind;  // what lies behind near pixels; NULL: only far sprites show there
    const float *column;  // the pixels' columns, if they are not side by side
};

// A row of pixels as parts of half-resolution means: n means from column 0 on, two pixels each.
struct hf_tent_row {
    const struct hf_scatter *scatter;
    float sign;  // of the field's radii
    int n, channels;
    const float *radius, *colour[3];
    const float *own, *next;  // radii of the quads of this row, and of the row that its tent reaches; from -1 to n
    float *pixel[2][4];       // even and odd: colour times weight, 3 the weight
};

// Sources to draw.
enum { HF_SPLATS = 128 };

struct hf_splats {
    int count;
    int32_t x[HF_SPLATS], y[HF_SPLATS];  // the level's pixels
    int32_t picture[HF_SPLATS];
    _Alignas(64) int64_t share[HF_SPLATS + 4][4];  // of each lane, for 1 unit of weight
};

// A row of sources, in the level's pixels, from column x on.
struct hf_source_row {
    int x, y;
    const float *colour[3], *weight;  // colours are weighted
    const float *radius;              // times scale: the sprite's radius
    float scale;
    const int32_t *picture;  // the sprite's number; -1: no source
};

// A window of sums: differences along x, four lanes per pixel (three channels and the weight). Each row has spare
// pixels before and after it, which take all that begins or ends outside.
enum { HF_SUMS_MARGIN = 8 };

struct hf_sums {
    int64_t *lane;
    ptrdiff_t
        *row;  // the place of the window's column x0 in each row from y0 on; rows are reused once they are settled
    int x0, y0, x1, y1;
};

#endif
