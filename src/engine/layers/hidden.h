// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_LAYERS_HIDDEN_H
#define HF_LAYERS_HIDDEN_H

#include <math.h>

#include "engine/layers/kernels.h"

enum { HF_LAYERS_SMOOTH = 6, HF_LAYERS_TAPS = 2 * HF_LAYERS_SMOOTH + 1 };  // hidden samples on either side in a mean

// In a mean along a line a sample's weight falls with its difference of radius from the middle one, to 0 at ALIKE.
#define HF_LAYERS_ALIKE 4
// A sample that covers less than 1 / WHOLE of its quad counts less, so that none suddenly appears in its neighbours'
// means.
#define HF_LAYERS_WHOLE 16
// A sample whose square roots exceed GLARE times the middle one's is dimmed. Otherwise a lamp beside a silhouette would
// light up everything that is hidden along it.
#define HF_LAYERS_GLARE 16
// A sample counts less the more its colour differs from the middle's: by SHADES times their difference over the sum of
// the middle's roots, and at least OTHER. Edges behind an object stay edges, and streaks disappear.
#define HF_LAYERS_SHADES 2
#define HF_LAYERS_OTHER 0.1f
// Its weight by its place in the line, i from 0 to 2 SMOOTH.
static inline float hf_layers_line(int i)
{
    return (float)(HF_LAYERS_SMOOTH + 1 - (i < HF_LAYERS_SMOOTH ? HF_LAYERS_SMOOTH - i : i - HF_LAYERS_SMOOTH));
}

// How lonely a sample of radius r is in a line, 0 to 1. The radius of a lonely sample is a mean of two surfaces' radii, so
// it belongs to neither. In a slice that is drawn sharp it would be a speck, or a hole among its neighbours; their mean
// replaces it. The part of the line's weight that is as far away as the sample decides: it is fully lonely up to ALONE,
// and not at all from 1 / COMPANY above that. The caller takes the lesser result of row and column, or a thin rod's
// samples would be lost. like, others: weight of samples that are as far away and of those that are not; size: weight of
// the latter times their absolute radii.
#define HF_LAYERS_ALONE (1.0f / 7)
#define HF_LAYERS_COMPANY 4
#define HF_LAYERS_SHARP 2
static inline float hf_layers_lonely(float r, float like, float others, float size)
{
    const float all = like + others, part = (all > 0 ? like / all : 1) - HF_LAYERS_ALONE;
    const float around = others > 0 ? size / others : HF_LAYERS_SHARP, own = fabsf(r);
    return (1 - hf_saturate(part * HF_LAYERS_COMPANY)) * hf_saturate(HF_LAYERS_SHARP - (own < around ? own : around));
}

// How far a surface hides another whose radius is larger by 1 + more: completely from half a pixel on. The ramp lets a
// picture change without a jump as radii grow.
static inline float hf_layers_hides(float more)
{
    return hf_saturate(2 * more);
}

// A surface found on two opposite sides continues between them. It counts BETWEEN times as much as what is seen on one
// side alone, so an edge that passes behind a rod stays straight. It is one surface if its two radii differ by less
// than 1 / UNLIKE of its distance (in radius) behind the object, and two surfaces from twice that on.
#define HF_LAYERS_BETWEEN 256
#define HF_LAYERS_UNLIKE 4
enum { HF_LAYERS_STEPS = 12, HF_LAYERS_LINES = 4 };

// A tap of a level: its samples (colour, weight (4), radius (5)) and their weight, `part` times a ramp: scale times how
// far they lie behind the nearest surface, less `from`. whole: how much of a hidden sample's coverage that weight gives. What lies
// no farther behind than `least` has no weight.
struct hf_hidden_tap {
    const float *in[6];
    float from, scale, part, whole, least;
};

// Behind an edge a lens sees as many pixels as the two surfaces' radii differ by. Level j finds what is up to 2^(j+2) - 2
// pixels away: its taps are 2^(j+1) apart, and a sample is merged from 2^(j+1) - 2 pixels on either side. So the levels
// before it are enough up to this difference of radii, and the level does not count. What a quad finds thus depends on
// the surfaces around it alone, however many levels the rest of the frame needs.
static inline float hf_layers_level_from(int j)
{
    return (float)((2 << j) - 2);
}

// A line through a sample: the offsets of the samples some steps away on either side, and their distance in half-resolution
// pixels. What lies no farther behind the nearest surface than `least` is not seen so far away.
struct hf_hidden_line {
    int steps;
    ptrdiff_t side[2][HF_LAYERS_STEPS];
    float away[HF_LAYERS_STEPS], least[HF_LAYERS_STEPS];
};
static inline float hf_layers_line_least(float away)
{
    const float least = 2.999f * (away - 1);  // a little less than what counts, as that is rounded
    return least > 1 ? least : 1;
}

// A sample that taps have just reached covers nothing yet; it covers fully from 1 / REACHED of a tap on.
#define HF_LAYERS_REACHED 4

// A known front that fills less than this of a pixel, or all but this, is not split off: so colours stay finite.
#define HF_LAYERS_LEAST 1e-3f

// Weights of taps below this count as 0, so that 1 / weight is finite.
#define HF_LAYERS_SOME 1e-30f

// The radius of a place without a sample: before anything else.
#define HF_LAYERS_NOTHING (-1e30f)

// A pixel whose back is less than 1 / EDGE of it counts partly as its front for others. The front's weight falls smoothly to 0
// as the back grows, so the pixel's radius moves at most 700 times as fast as the back's part; were it a straight line, 4,096
// times.
#define HF_LAYERS_EDGE 64

// A front that is less than 1 / THIN of its pixel comes nearer to its back the less it is, where the nearest surface of a
// quad is sought. Otherwise the front would decide what is found behind it until nothing of it is left, and then no
// more. At 64 and less, pictures and their transposes differ by half as much again.
#define HF_LAYERS_THIN 256

// Negative samples keep their sign.
static inline float hf_layers_root(float v)
{
    return v > 0 ? sqrtf(v) : v < 0 ? -sqrtf(-v) : 0;
}

// The radii and weights of a row of quads from quad x on: two rows of visible samples, then the backs of mixed ones.
void hf_layers_quad_rows(const struct hf_frame *f, int x, int y, const float *radius[4], const float *weight[4]);
// The farthest sample of each quad of a cell: level 0.
void hf_layers_quads_pass(const struct hf_frame *f, struct hf_rect r);
// Floats of scratch that the pass needs for a band of half-resolution rows.
size_t hf_layers_hidden_floats(const struct hf_layers *l, int width, int height);
// Likewise for the pass of known surfaces.
size_t hf_layers_known_floats(const struct hf_layers *l, int width, int height);
// Split pixels whose front surface is known into that and the rest.
void hf_layers_take_edges(const struct hf_frame *f, struct hf_rect r);
// Set all colours of a buffer of samples in r, half-resolution pixels: 1 says that they are known, 0 that they are guesses.
void hf_layers_set_colours(const struct hf_frame *f, int buf, struct hf_rect r, float to);
// Weigh the samples that stand beyond the frame, where r touches its edges, by how much of their surface the frame shows.
void hf_layers_bound_border(const struct hf_frame *f, struct hf_rect r);
// How far around a pixel the search for hidden samples reaches, half-resolution pixels.
int hf_layers_hidden_reach(const struct hf_layers *l);

#endif
