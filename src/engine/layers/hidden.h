// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_HIDDEN_H
#define HF_LAYERS_HIDDEN_H

#include <math.h>

#include "engine/layers/kernels.h"

enum {
    HF_LAYERS_SMOOTH = 6,
    HF_LAYERS_TAPS = 2 * HF_LAYERS_SMOOTH + 1
};  // hidden samples on either side that are one mean

// How much the samples of a line count in the mean of that in the middle, if they are as far; nothing beyond this
// difference of radius.
#define HF_LAYERS_ALIKE 4
// Samples of less than 1 / WHOLE of a quad count less, so that none appears at once in its neighbours' means.
#define HF_LAYERS_WHOLE 16
// A sample of which the roots are more than GLARE times as large as the middle one's is dimmed: a lamp beside a silhouette
// would otherwise light up all that is hidden along it.
#define HF_LAYERS_GLARE 16
// Of another colour, measured by the sum of the middle's roots, a sample counts the less the more SHADES times that is, and
// OTHER at the least: an edge behind an object stays one, and streaks do not.
#define HF_LAYERS_SHADES 2
#define HF_LAYERS_OTHER 0.1f
static inline float hf_layers_line(int i)
{
    return (float)(HF_LAYERS_SMOOTH + 1 - (i < HF_LAYERS_SMOOTH ? HF_LAYERS_SMOOTH - i : i - HF_LAYERS_SMOOTH));
}

// How much a sample of radius r belongs to no surface: in its row and in its column less than ALONE is as far as itself, one
// more than 1 / COMPANY above that being all that is needed of either, or a thin rod's would be lost. Its radius is then a mean
// of two surfaces'. In the slices that are drawn sharp it would be a speck if it lies there, a hole if the others do, and takes
// their place. like and others: weights of what is as far and of what is not; size: of the latter, times how large their radii
// are.
#define HF_LAYERS_ALONE (1.0f / 7)
#define HF_LAYERS_COMPANY 4
#define HF_LAYERS_SHARP 2
static inline float hf_layers_lonely(float r, float like, float others, float size)
{
    const float all = like + others, part = (all > 0 ? like / all : 1) - HF_LAYERS_ALONE;
    const float around = others > 0 ? size / others : HF_LAYERS_SHARP, own = fabsf(r);
    return (1 - hf_saturate(part * HF_LAYERS_COMPANY)) * hf_saturate(HF_LAYERS_SHARP - (own < around ? own : around));
}

// How far a surface hides another whose radius is larger by 1 and so much more: wholly from half a pixel on, so that a
// picture moves without a jump as radii grow.
static inline float hf_layers_hides(float more)
{
    return hf_saturate(2 * more);
}

// What is alike on two opposite sides goes on between them, and counts so much more than what is seen on one side alone: an
// edge that passes behind a rod stays straight. Of a sample's distance behind what hides it, radii on the two sides differ by
// less than 1 / UNLIKE, or little; from twice that on they are two surfaces.
#define HF_LAYERS_BETWEEN 256
#define HF_LAYERS_UNLIKE 4
enum { HF_LAYERS_STEPS = 12, HF_LAYERS_LINES = 4 };

// A tap of a level: its samples, colour, weight (4), radius (5), and how much they count, by `part` of how far behind the
// nearest they lie as scale and off say.
struct hf_hidden_tap {
    const float *in[6];
    float scale, off, part;
};

// A line through n samples, colour, weight (4), radius (5): where those some steps away on either side are, and how far
// that is, half-resolution pixels.
struct hf_hidden_line {
    int steps;
    const float *in[6];
    ptrdiff_t side[2][HF_LAYERS_STEPS];
    float away[HF_LAYERS_STEPS];
};

// What the farthest level's taps have just begun to reach covers nothing yet, and wholly from 1 / REACHED of a tap on.
#define HF_LAYERS_REACHED 4

// Weights of taps below this are none: one over them has to be finite.
#define HF_LAYERS_SOME 1e-30f

// The radius of what is not there: before anything.
#define HF_LAYERS_NOTHING (-1e30f)

// A pixel that is mixed by less than 1 / EDGE is in part what it is by itself to others.
#define HF_LAYERS_EDGE 64

// Negative samples keep their sign.
static inline float hf_layers_root(float v)
{
    return v > 0 ? sqrtf(v) : v < 0 ? -sqrtf(-v) : 0;
}

// The farthest of each quad of a cell: where the levels begin.
void hf_layers_quads_pass(const struct hf_frame *f, struct hf_rect r);
// Floats of scratch that the pass needs for a band of half-resolution rows.
size_t hf_layers_hidden_floats(const struct hf_layers *l, int width, int height);
// How far around a pixel hidden samples are looked for, half-resolution pixels.
int hf_layers_hidden_reach(const struct hf_layers *l);

#endif
