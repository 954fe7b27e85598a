// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine's buffers, its taps, and what its kernels in C and on vectors share.
//
// J. White and C. Barre-Brisebois, "More Performance! Five Rendering Ideas from Battlefield 3 and Need For Speed: The
// Run", SIGGRAPH 2011: a hexagon is three rhombi, a rhombus is two blurs along its sides, and the three share blurs.
// With u up, v down left, w down right, each a mean over a side's length:
//    pass 1    U = u(c),  B = u(c) + v(c)
//    pass 2    (v(U) + w(B)) / 3
//
// The CoC differs from pixel to pixel, so each blur checks whether a sample reaches the pixel: a sample of radius q
// spreads its colour over the first q pixels of the line, 1/q on each. Near samples (in front of the focus) do so over
// any pixel. Far samples do so only over far pixels, and only if q <= 2p, p being the pixel's radius, with a soft edge
// of one pixel (of p where p is smaller).
//
// The near field is kept premultiplied by its coverage, together with the mean radius of what covers a pixel. So pass 2
// carries it as far as pass 1 did, also over pixels that are sharp themselves. The far field is divided by the weight
// that was found, and stays behind the edges of sharper surfaces. It keeps the mean radius of what was found, too:
// light that pass 1 spread over another surface is spread equally far by pass 2.
//
// The near mean is the square of the mean root radius, each sample weighted by its share of what is found: a sample
// that covers little changes it little, however large its radius. The far mean is 1 / the mean of 1 / radius, each
// sample weighted by its light: a light before a dark wall is spread by its own radius, not by the wall's. Where a pixel's
// lines are dark but for the last trace of a light, the mean fades to the pixel's own radius.
//
// Far light of pass 1 continues beyond the frame's edges; otherwise pass 2 would miss what it brings back, and hexagons
// beside an edge would be cut. A pixel out there has the radius of the frame's nearest pixel, no colour of its own, and
// the weight of what it finds. Inside, a line's result has as much weight as the part of the line within the frame.
// Near coverage beyond the edge is not made, because how much of a hexagon that leaves is known.
//
// The near coverage leaves a part of each pixel open. In a sharp or far pixel that part shows the pixel itself. A
// near pixel is itself the occluder, so there that part shows what is visible around the pixel (behind.c), and the
// pixel itself only up to a radius of 2. A far pixel that finds less than a quarter of its samples takes the rest of that quarter from its own
// colour. All weights are continuous in every radius and vanish with it, so nothing pops.
#ifndef HF_PASS_HEXAGON_H
#define HF_PASS_HEXAGON_H

#include <float.h>

#include "pass/engine.h"
#include "pixel/pass_c.h"

enum hf_hexagon_pass {
    HF_HEXAGON_COC,
    HF_HEXAGON_LOAD,
    HF_HEXAGON_BLUR,
    HF_HEXAGON_LOOK_BEHIND,
    HF_HEXAGON_COMPOSITE,
    HF_HEXAGON_PASSES
};

// At full resolution both fields read the same colours and signed radii. At half resolution a quad may belong to both
// fields, and each has its own. COLOUR is premultiplied by a sample's weight a = 1 / max(|q|, 1).
enum hf_hexagon_buf {
    HF_HEXAGON_COLOUR,  // full resolution: colour x a
    HF_HEXAGON_WEIGHT,  // a; the signed radius; what mean radii are summed from: near a sqrt(1 / a), far light / q
    HF_HEXAGON_NEAR_COLOUR_2,  // half resolution: radii are not negative, and in half-resolution pixels
    HF_HEXAGON_NEAR_WEIGHT_2,  // a times the near part of the quad; radius; the same for its mean
    HF_HEXAGON_FAR_COLOUR_2,
    HF_HEXAGON_FAR_WEIGHT_2,
    HF_HEXAGON_SEEN_COLOUR_2,  // the part of a quad that is not near, premultiplied
    HF_HEXAGON_SEEN_WEIGHT_2,  // how large that part is
    HF_HEXAGON_MADE,           // results of the two passes: at full resolution, then again at half
};

enum hf_hexagon_made {
    HF_HEXAGON_NEAR_U,  // coverage x colour x weight
    HF_HEXAGON_NEAR_B,
    HF_HEXAGON_NEAR_W,  // coverage x weight and mean radius, of U and of B
    HF_HEXAGON_FAR_U,   // colour x weight
    HF_HEXAGON_FAR_B,
    HF_HEXAGON_FAR_W,  // weight times the far part of a pixel, and mean radius, of U and of B
    HF_HEXAGON_NEAR,   // coverage x colour
    HF_HEXAGON_COVERAGE,
    HF_HEXAGON_FAR,
    HF_HEXAGON_BEHIND,  // what lies behind near pixels: colour x weight
    HF_HEXAGON_BEHIND_W,
    HF_HEXAGON_MADE_COUNT
};
enum { HF_HEXAGON_BUF_COUNT = HF_HEXAGON_MADE + 2 * HF_HEXAGON_MADE_COUNT };

// A place of a blur's line. Places lie equally far apart, from the pixel itself on. Each stands for the length b of the
// line that is nearest to it; c is the line's length before that part. A sample of radius q counts max(0, min(b, q -
// c)) at a place. So with one radius everywhere the weights of a line sum to q, and each weight grows from 0 as q does.
// A place lies between pixels; each of these is a tap with a bilinear part. All three lines have the same c and b: the
// position error of one line's places recurs in the others, and because the directions of the three sides sum to 0, so
// do these errors.
struct hf_hexagon_tap {
    int dx, dy;
    float b, c, part;
};

// The same for several rows of pixels at once: a sample at (dx, dy) from the first row, and the weight of each row's
// own tap there. A line that is not steep meets a column in two taps, so neighbouring rows share samples. Each row
// still meets its taps in their order.
enum { HF_HEXAGON_ROWS = 4 };

struct hf_hexagon_step {
    int dx, dy;
    unsigned rows;  // bit i: row i has a tap at this sample
    float least;    // the least c of those rows
    float b[HF_HEXAGON_ROWS], c[HF_HEXAGON_ROWS], part[HF_HEXAGON_ROWS];
    float whole[HF_HEXAGON_ROWS];  // part times b
};

struct hf_hexagon_steps {
    struct hf_hexagon_step *step;
    int count;  // 0: rows cannot be computed together, because a line ends beyond the picture
};

struct hf_hexagon_line {
    struct hf_hexagon_tap *taps;
    int count;
    int x0, y0, x1, y1;                      // the extreme offsets, both included
    struct hf_hexagon_steps one, two, four;  // for that many rows at once
};

// Lines u, v, w, and how far around a pixel pass 2 reads the results of pass 1, half-resolution pixels.
struct hf_hexagon {
    int ready;          // prepared: the other members are valid
    int half;           // at half resolution
    int made;           // the first buffer of results at that resolution
    int width, height;  // of the frame at that resolution
    float rotation;     // degrees
    struct hf_hexagon_line line[3];
    int left, right, above, below;
    float side[3][2];  // 1 / the sides' extent along x and y, in pixels per pixel of radius
    float
        clear[2];  // a hexagon lies inside the frame if it is farther from the edges than this times its radius, plus 1
    int mixed;     // there may be mixed pixels
    int behind;    // levels of neighbourhoods that the near radii need (pixel/behind.h)
    int reach_x, reach_y;  // of one blur, half-resolution pixels; valid once the frame's depth is known
    struct hf_block block;
};

static inline const struct hf_hexagon *hf_hexagon(const struct hf_setup *s)
{
    return s->own;
}

// Rows of a band, half-resolution pixels (bands.c), and floats of scratch for bands of that width.
enum { HF_HEXAGON_BAND = 8 };
size_t hf_hexagon_band_floats(const struct hf_setup *s, int width);

// Samples of one field: planes of colour x weight, of weight, and of radius x sign. At half resolution only a part of a
// quad may belong to the field, and its weight is smaller in proportion.
struct hf_hexagon_field {
    const struct hf_buf *colour;
    const struct hf_buf *weight;
    int a;  // channel of weight
    const struct hf_buf *radius;
    int q;  // channel of radius
    float sign;
    int mean;   // channel of weight that mean radii are summed from; -1: not wanted
    int alone;  // colour and weight are 0 where the radius is not above 0
};

// The buffer of a result at the setup's resolution.
static inline const struct hf_buf *hf_hexagon_made(const struct hf_frame *f, enum hf_hexagon_made b)
{
    return &f->buf[hf_hexagon(f->s)->made + (int)b];
}

static inline struct hf_hexagon_field hf_hexagon_field(const struct hf_frame *f, unsigned field)
{
    const int half = hf_hexagon(f->s)->half;
    const int colour = !half              ? HF_HEXAGON_COLOUR
                       : field == HF_NEAR ? HF_HEXAGON_NEAR_COLOUR_2
                                          : HF_HEXAGON_FAR_COLOUR_2;
    const struct hf_buf *weight = &f->buf[colour + 1];
    return (struct hf_hexagon_field){
        &f->buf[colour], weight, 0, weight, 1, !half && field == HF_NEAR ? -1.0f : 1.0f, 2, half};
}

// The samples that pass 2 reads: the results of pass 1 along line v (0) or w (1).
static inline struct hf_hexagon_field hf_hexagon_field_2(const struct hf_frame *f, unsigned field, int second)
{
    const int near = field == HF_NEAR;
    const struct hf_buf *weight = hf_hexagon_made(f, near ? HF_HEXAGON_NEAR_W : HF_HEXAGON_FAR_W);
    const int colour = near ? HF_HEXAGON_NEAR_U : HF_HEXAGON_FAR_U;
    return (struct hf_hexagon_field){hf_hexagon_made(f, (enum hf_hexagon_made)(colour + second)),
                                     weight,
                                     2 * second,
                                     weight,
                                     2 * second + 1,
                                     1,
                                     -1,
                                     1};
}

// The frame's size at the working resolution.
static inline int hf_hexagon_width(const struct hf_setup *s)
{
    return hf_hexagon(s)->width;
}

static inline int hf_hexagon_height(const struct hf_setup *s)
{
    return hf_hexagon(s)->height;
}

// Moves (x, y) to the frame's nearest pixel. Returns 0 if that is farther away than the frame's own size: nothing is
// made there.
static inline int hf_hexagon_nearest(const struct hf_setup *s, int *x, int *y)
{
    const int width = hf_hexagon_width(s), height = hf_hexagon_height(s);
    const int is = *x >= -width && *x < 2 * width && *y >= -height && *y < 2 * height;
    *x = hf_max(hf_min(*x, width - 1), 0);
    *y = hf_max(hf_min(*y, height - 1), 0);
    return is;
}

// The part within the frame of a side of length 1 / i that begins `by` away from a pixel's centre `at`. A side along an
// edge that rounding has put on the edge counts as 2^-10 inside. A pixel's distance from an edge is exact, so a crop of
// the frame with that edge has the same bits.
static inline float hf_hexagon_along(int width, int height, const float side[2], const float at[2], const float by[2],
                                     float i)
{
    const float right = side[0] > 0 ? ((float)width - at[0]) - by[0] : at[0] + by[0];
    const float down = side[1] > 0 ? ((float)height - at[1]) - by[1] : at[1] + by[1];
    const float dx = (right > 0x1p-10f ? right : 0x1p-10f) * __builtin_fabsf(side[0]) * i;
    const float dy = (down > 0x1p-10f ? down : 0x1p-10f) * __builtin_fabsf(side[1]) * i;
    const float d = dx < dy ? dx : dy;
    return d < 1 ? d : 1;
}

// r in pixels of the working resolution.
static inline struct hf_rect hf_hexagon_rect(const struct hf_setup *s, struct hf_rect r)
{
    if (hf_hexagon(s)->half)
        return r;
    return (struct hf_rect){2 * r.x0, 2 * r.y0, hf_min(2 * r.x1, s->width), hf_min(2 * r.y1, s->height)};
}

// A far pixel that finds a weight below LEAST takes the rest from its own colour. Below a radius of ALL it takes more,
// and from ALL - 1 down all that is missing.
#define HEXAGON_LEAST 0.25f
#define HEXAGON_ALL 2.0f
// The least far mean radius. It reaches no other pixel.
#define HEXAGON_LEAST_MEAN 0.25f
// Far mean radii: what shines along less than TRACE pixels of a line is but a trace of light, which decides nothing. Only
// dark pixels ask for that: those whose lines find more than 1 / DARK times the light over radius that they have themselves.
#define HEXAGON_TRACE 0x1p-8f
#define HEXAGON_DARK 0x1p-16f
// A sample of at least this weight counts as a whole pixel.
#define HEXAGON_WHOLE (1 - 0x1p-20f)

// A weight of what lies behind near pixels that counts half; the rest is the near field's colour. A surface that begins to be
// seen begins with a weight of 0, so the smaller this is the steeper its colour comes in: with 1e-5 within 1e-4 of a pixel of
// radius, up to 4.5 8-bit codes in one float of a distance. The larger it is, the more of a near bar's light is counted twice in
// its middle. Weights count by their squares: larger ones make up nearly all, and of the bar's light less than 0.1 % is counted
// twice, which was 0.15 % by weights that came in as slowly.
#define HEXAGON_NOTHING 6e-5f

// Colours are summed this much darker, so that no sum overflows unless a sample does. A line's weights add up to at
// most 1 + ln(2048) < 9 times a sample, the two lines of pass 1 to twice that, and those of pass 2 to 9 times their
// sum. The factor is a power of two, so no bit changes. A result that rounds up beyond the largest number becomes that
// number.
#define HEXAGON_SCALE 0x1p-10f
#define HEXAGON_MOST (FLT_MAX * HEXAGON_SCALE)

// The light of a colour: the sum of its channels, the same for any order of them. Negative channels count as light, but
// they reduce that of positive ones beside them, so no mean radius exceeds the radii it is made of.
static inline float hf_hexagon_light(float r, float g, float b)
{
    const float low = r < g ? r : g, high = r > g ? r : g;
    const float most = high > b ? high : b, other = high < b ? high : b;
    const float least = low < b ? low : b, middle = low > other ? low : other;
    return __builtin_fabsf((most + least) + middle);
}

#endif
