// SPDX-License-Identifier: BSD-3-Clause
// The hexagon engine's buffers, its taps, and what its kernels in C and on vectors share.
//
// J. White and C. Barre-Brisebois, "More Performance! Five Rendering Ideas from Battlefield 3 and Need For Speed: The
// Run", SIGGRAPH 2011: a hexagon is three rhombi, a rhombus is two blurs along its sides, and the three share blurs.
// With u up, v down left, w down right, each a mean over a side's length:
//     pass 1    U = u(c),  B = u(c) + v(c)
//     pass 2    (v(U) + w(B)) / 3
//
// CoC differs from pixel to pixel, so each blur asks every sample whether it reaches: a sample of radius q spreads
// its colour over the first q pixels of the line, 1/q on each. Near samples (in front of the focus) do so whatever
// they reach; far ones only into far pixels, and only if q <= 2p, p being the radius there, with a soft edge of one
// pixel (of p where p is smaller). The near field is therefore kept premultiplied by its coverage, with the mean
// radius of what covers a pixel, so that pass 2 carries it as far as pass 1 did over pixels that are sharp
// themselves; the far field is divided by what was found, and stays behind the edges of sharper things. It too keeps the
// mean radius of what was found: light that pass 1 has spread over something else is spread as far by pass 2.
// The mean radius is the near field's by its square root, each sample by its share of what is found: what covers little
// changes it little, however large its radius. The far field's is by 1 / radius, each sample by the light that it brings:
// that of a light before a dark wall goes as far as its own radius, not the wall's.
//
// Beyond the frame's edges far light of pass 1 goes on, or pass 2 would miss what it brings back: hexagons beside an edge
// would be cut. There a pixel is as far behind the focus as the frame's nearest, has no colour of its own, and weighs as
// much as it finds; before the edge, what a line makes weighs as much of it as lies within the frame. (What covers near pixels beyond the edge is not made: how much of a hexagon that leaves is known.)
//
// What near coverage leaves of a sharp or far pixel shows that pixel; of a near one, which is what covers, it shows what
// is seen around it (behind.c), and the pixel itself only up to a radius of 2. A far pixel that finds less than a quarter
// of its samples makes up a quarter with its own colour. All weights are continuous in every radius and vanish with it,
// so nothing pops.
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

// At full resolution both fields read the same colours and signed radii; at half resolution a quad may belong to
// both, and each has its own. COLOUR is premultiplied by the weight a of a sample, 1 / max(|q|, 1).
enum hf_hexagon_buf {
    HF_HEXAGON_COLOUR,         // full resolution: colour x a
    HF_HEXAGON_WEIGHT,         // a, the signed radius, and what its mean is made of: near a sqrt(1 / a), far light / q
    HF_HEXAGON_NEAR_COLOUR_2,  // half resolution: radii are not negative, and in half-resolution pixels
    HF_HEXAGON_NEAR_WEIGHT_2,  // a times how much of the quad is near, radius, and the same for its mean
    HF_HEXAGON_FAR_COLOUR_2,
    HF_HEXAGON_FAR_WEIGHT_2,
    HF_HEXAGON_SEEN_COLOUR_2,  // what of a quad is not near: colour x how much that is
    HF_HEXAGON_SEEN_WEIGHT_2,  // and how much
    HF_HEXAGON_MADE,           // what the two passes make: full resolution, then the same again at half
};

enum hf_hexagon_made {
    HF_HEXAGON_NEAR_U,  // coverage x colour x weight
    HF_HEXAGON_NEAR_B,
    HF_HEXAGON_NEAR_W,  // coverage x weight and mean radius, of U and of B
    HF_HEXAGON_FAR_U,   // colour x weight
    HF_HEXAGON_FAR_B,
    HF_HEXAGON_FAR_W,  // weight, of what is far of a pixel, and mean radius, of U and of B
    HF_HEXAGON_NEAR,   // coverage x colour
    HF_HEXAGON_COVERAGE,
    HF_HEXAGON_FAR,
    HF_HEXAGON_BEHIND,  // what lies behind near pixels: colour x weight
    HF_HEXAGON_BEHIND_W,
    HF_HEXAGON_MADE_COUNT
};
enum { HF_HEXAGON_BUF_COUNT = HF_HEXAGON_MADE + 2 * HF_HEXAGON_MADE_COUNT };

// The line of a blur: places equally far apart along it, from the pixel itself on, each for the length b of the line that is
// nearest to it; c is how long the line is before that. A sample of radius q at a place counts min(b, q - c), not less than
// 0: the weights of a line of one radius sum to q for any q, and every weight grows from 0 as q does. Places lie between
// pixels, so each is some of these, by bilinear parts. All lines have the same c and b: what the places of one put too near
// or too far, those of the others do, and as the directions of three sides add up to nothing, so do these errors.
struct hf_hexagon_tap {
    int dx, dy;
    float b, c, part;
};

// The same for some rows of pixels at once: a sample (dx, dy) from the first of them, and what each row's own tap there
// weighs. A line that is not steep meets a column in two taps, so that neighbouring rows share their samples. Each row
// meets its taps in their order.
enum { HF_HEXAGON_ROWS = 4 };

struct hf_hexagon_step {
    int dx, dy;
    unsigned rows;  // bit i: row i has a tap there
    float least;    // the least c of them
    float b[HF_HEXAGON_ROWS], c[HF_HEXAGON_ROWS], part[HF_HEXAGON_ROWS];
    float whole[HF_HEXAGON_ROWS];  // part times b
};

struct hf_hexagon_steps {
    struct hf_hexagon_step *step;
    int count;  // 0: rows cannot be taken together, as a line's end lies beyond the picture
};

struct hf_hexagon_line {
    struct hf_hexagon_tap *taps;
    int count;
    int x0, y0, x1, y1;                      // the largest offsets, both included
    struct hf_hexagon_steps one, two, four;  // rows at once
};

// Lines u, v, w, and how far pass 2 reads around a pixel what pass 1 made, half-resolution pixels.
struct hf_hexagon {
    int ready;       // prepared: the rest is valid
    int half;        // at half resolution
    float rotation;  // degrees
    struct hf_hexagon_line line[3];
    int left, right, above, below;
    float side[3][2];  // 1 / what the sides' directions go along x and y, in pixels for 1 pixel of radius
    float clear[2];    // farther from the frame's edges than this times its radius a hexagon lies inside; and a pixel
    int mixed;         // there may be mixed pixels
    int behind;        // neighbourhoods that near radii ask for (pixel/behind.h)
    int reach_x, reach_y;  // of one blur in this frame, half-resolution pixels, once its depth has been looked at
    struct hf_block block;
};

static inline const struct hf_hexagon *hf_hexagon(const struct hf_setup *s)
{
    return s->own;
}

// Rows of a band, half-resolution pixels (hexagon_bands.c), and floats of scratch for bands of that width.
enum { HF_HEXAGON_BAND = 8 };
size_t hf_hexagon_band_floats(const struct hf_setup *s, int width);

// Samples of one field: planes of colour x weight, of weight, and of radius x sign. At half resolution a sample may be
// there in part, and its weight is that much smaller.
struct hf_hexagon_field {
    const struct hf_buf *colour;
    const struct hf_buf *weight;
    int a;  // channel of weight
    const struct hf_buf *radius;
    int q;  // channel of radius
    float sign;
    int mean;   // channel of weight: what mean radii are made of, -1: not wanted
    int alone;  // colour and weight are 0 where the radius is not above 0
};

// Where things are at the setup's resolution.
static inline const struct hf_buf *hf_hexagon_made(const struct hf_frame *f, enum hf_hexagon_made b)
{
    return &f->buf[HF_HEXAGON_MADE + (hf_hexagon(f->s)->half ? HF_HEXAGON_MADE_COUNT : 0) + b];
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

// The samples that pass 2 reads: what pass 1 made along line v (0) or w (1).
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
    return hf_hexagon(s)->half ? s->half_width : s->width;
}

static inline int hf_hexagon_height(const struct hf_setup *s)
{
    return hf_hexagon(s)->half ? s->half_height : s->height;
}

// The frame's pixel that is nearest to one beyond its edges. Returns 0 if that is more than the frame's own size away:
// nothing is made there.
static inline int hf_hexagon_nearest(const struct hf_setup *s, int *x, int *y)
{
    const int width = hf_hexagon_width(s), height = hf_hexagon_height(s);
    const int is = *x >= -width && *x < 2 * width && *y >= -height && *y < 2 * height;
    *x = hf_max(hf_min(*x, width - 1), 0);
    *y = hf_max(hf_min(*y, height - 1), 0);
    return is;
}

// How much of a side of length 1 / i lies within a frame, from a place on that lies `by` beside a pixel's centre (at).
// What rounding has put on the edge is 2^-10 inside, for a side along it. A pixel's distance from an edge is exact, so a
// part of the frame with that edge has the same bits.
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

// Of what a pixel of radius p finds, how little is too little, and from which p on it need not be all.
#define HEXAGON_LEAST 0.25f
#define HEXAGON_ALL 2.0f
// Far mean radii are not below this, which reaches no other pixel.
#define HEXAGON_LEAST_MEAN 0.25f
// A sample of this weight is whole.
#define HEXAGON_WHOLE (1 - 0x1p-20f)

// Colours are summed up this much darker, so that no sum overflows where none of its samples does: a line's weights add
// up to at most 1 + ln(2048) < 9 times a sample, the two lines of pass 1 to twice that, and those of pass 2 to 9 times
// their sum. A power of two, so that no bit changes. What rounds up beyond the largest number is that number.
#define HEXAGON_SCALE 0x1p-10f
#define HEXAGON_MOST (FLT_MAX * HEXAGON_SCALE)

// How much light a colour is: the sum of its channels, the same in whatever order they are. What is darker than nothing
// counts as light, but not beside what is brighter: then less, so that no mean radius is larger than all that it is of.
static inline float hf_hexagon_light(float r, float g, float b)
{
    const float low = r < g ? r : g, high = r > g ? r : g;
    const float most = high > b ? high : b, other = high < b ? high : b;
    const float least = low < b ? low : b, middle = low > other ? low : other;
    return __builtin_fabsf((most + least) + middle);
}

#endif
