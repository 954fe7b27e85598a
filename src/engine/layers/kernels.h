// SPDX-License-Identifier: BSD-3-Clause
// The kernels of layers.
#ifndef HF_LAYERS_KERNELS_H
#define HF_LAYERS_KERNELS_H

#include "pass/engine.h"
#include "engine/layers/layers.h"

typedef void hf_layers_unmix(const struct hf_unmix_row *row, int n);
// Mean square roots of the brightness of n quads, from two rows of colour.
typedef void hf_layers_roots(const float *const above[3], const float *const below[3], int n, float *out);
// Means of nine numbers: along a line, or of nine lines.
typedef void hf_layers_nine(const float *const in[9], int n, float *out);
// The part of n pixels' weight that is a highlight. seen, mixed: colour (NULL: channels that there are not), weight (4), radius
// (5); they change places where the mixed one is the brighter highlight. mixes[i]: whether pixels 16 i to 16 i + 15 have mixed
// ones. around: square roots of the brightness at five pairs of pixels around; the least counts. covered: roots of alpha at the
// same places, or NULL. any[i] becomes nonzero where pixels 16 i to 16 i + 15 have a highlight.
typedef void hf_layers_shares(float *const seen[6], float *const mixed[6], const uint8_t *mixes,
                              const float *const around[5], const float *const covered[5], int n, float *out,
                              uint8_t *any);
// Take lamps out of n quads (highlights.h). in: roots of colour, weight (4), radius (5). weight holds in[4]; lamps lose some of it
// or all, others keep it. A tap is a quad beside each: the root of its brightness and, of its two rows of pixels, radius and
// alpha (or NULL). The nearest of its pixels and the mean of alpha count, so that mirrored pictures give mirrored results.
struct hf_lamp_tap {
    const float *root, *radius[2], *alpha[2];
};
enum { HF_LAYERS_LAMP_NEXT = 4, HF_LAYERS_LAMP_TAPS = 12 };  // the first are next to the quad
typedef void hf_layers_lamps(const float *const in[6], const struct hf_lamp_tap tap[HF_LAYERS_LAMP_TAPS], int n,
                             float *weight);
// The farthest samples of n quads, from two rows of samples: colour, weight (4), radius (5).
typedef void hf_layers_quads(const float *const seen[2][6], const float *const mixed[2][6], int channels, int n,
                             float *const out[6]);
// Three samples of each lane become one: the mean of those whose radii lie within about 1 / slope of the farthest. out
// must not be one of in.
typedef void hf_layers_merge(const float *const in[3][6], int channels, float slope, int n, float *const out[6]);
// Add the taps of levels to the sums (colour, weight (4), radius (5), coverage (6)), one tap after the other, from their samples
// number `at` on.
struct hf_hidden_tap;
typedef void hf_layers_taps(const struct hf_hidden_tap *const *tap, int count, ptrdiff_t at, int channels,
                            const float *nearest, int n, float *const sum[7]);
// Add the surfaces behind `nearest` that continue between both sides of a line to the sums: of n samples in[] (colour, weight
// (4), radius (5)), no farther than the line's first steps.
struct hf_hidden_line;
typedef void hf_layers_between(const struct hf_hidden_line *line, int steps, const float *const in[6], int channels,
                               const float *nearest, int n, float *const sum[7]);
// The nearest, that is the least, radius of each of n quads (2 x 2 pixels), from what hf_layers_quad_rows gives.
typedef void hf_layers_nearest(const float *const radius[4], const float *const weight[4], int n, float *out);
// Hidden samples from the sums of taps; their colours are square roots. Their weight is the part of the quad that lies
// more than a pixel of radius before them. radius and weight: the quad's two rows of visible samples, then those behind
// mixed edges. Where the sum of coverage is below 1, the hidden sample weighs less in proportion.
typedef void hf_layers_found(const float *const sum[7], const float *const radius[4], const float *const weight[4],
                             int channels, int n, float *const out[6]);
// Give the hidden samples of n quads to one row of their pixels. The weight goes to the pixels that lie more than a
// pixel of radius before the hidden sample, and is at most theirs. radius and weight: as for hf_layers_found.
typedef void hf_layers_spread(const float *const in[6], const float *const radius[4], const float *const weight[4],
                              int row, int channels, int n, float *const out[6]);
// Means over lines of thirteen hidden samples, of those about as far as the middle one. The middle one keeps its
// weight; without any it becomes nothing. along is NULL in the first of two directions. In the second it holds weights
// and radii of the middle samples' own row, and six more samples on either side are read. There, a sample that is alone
// in both directions takes the mean of its line, and colours are squared back from roots.
typedef void hf_layers_smooth(const float *const in[13][6], const float *const along[2], int channels, int n,
                              float *const out[6]);
// Compare the surroundings of n places side by side with what is known around another place: sums of the weights of the
// taps that are known there too, and of those weights times the squared difference of colour.
struct hf_pattern_place;
struct hf_pattern_tap;
typedef void hf_layers_alike(const struct hf_pattern_place *place, const struct hf_pattern_tap *tap, int count,
                             const float *const in[6], int channels, int n, float *sum, float *off);
// Widen `out` by the least and largest radius of samples with weight, in rows of n. Without `weight` all samples count.
typedef void hf_layers_extremes(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows,
                                struct hf_layers_range *out);
// Whether rows of n contain a sample with weight and a radius between `before` and `after`. Without `weight` all samples
// have some.
typedef int hf_layers_inside(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows, float before,
                             float after);
// A slice's parts of n samples, summed with those in the rows - 1 rows below. share: the part of their weight that is
// left out. channels: 0 for weights alone. add: add to what out holds. any[i] becomes 1 where the 16 samples from 16 i on
// have some. in[4] NULL: all weigh 1.
typedef void hf_layers_weigh(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                             int rows, int channels, int n, int add, float *const out[5], uint8_t *any);
// Sums of pairs of 2n numbers; out may be in.
typedef void hf_layers_fold(const float *in, int n, float *out);
// Draw n sources of two adjacent rows, blurred by s, into rows from..to; out is the row of the upper one. Planes lie `plane` and
// `out_plane` floats apart; the last one holds weights, and where these are 0 the others are too.
struct hf_layers_sources {
    const float *upper, *lower;
    ptrdiff_t plane;
    int planes, n, from, to;
    float *out;
    ptrdiff_t out_plane, stride;
};
typedef void hf_layers_disc(const struct hf_slice *s, const struct hf_layers_sources *in);
// Sums of n numbers and the numbers `apart` places after them.
typedef void hf_layers_pairs(const float *in, int apart, int n, float *out);
// Add runs of a row of sources to n pixels, each times its `part` if that is given. window: sums of 2^k sources, one
// plane for each k.
typedef void hf_layers_runs(const struct hf_shape_run *run, int count, const float *window, ptrdiff_t plane,
                            const float *part, int n, float *out);
// Add a row of an aperture picture: weight[0] is for in[x], the next for the source before it, and so on.
typedef void hf_layers_weights(const float *weight, int count, const float *in, int n, float *out);
// Add a row of an aperture picture times the brightness v.
typedef void hf_layers_stamp(const float *weight, int n, float v, float *out);
// Upsample: 2n numbers from n of two rows, three quarters of a and one quarter of b. Reads one more at either end.
typedef void hf_layers_up(const float *a, const float *b, int n, float *out);
// A row of pixels seen from many points of the lens.
struct hf_view_row;
typedef void hf_layers_views(const struct hf_view_row *row);
// Put sums of a slice (weight at 4) under what a stack holds, and clear them.
// HIDING: visible samples that hide others; hidden samples keep all they may cover. SEEN: visible samples behind those;
// they reduce what hidden samples may cover. HELD: as SEEN, but as much coverage as to->held says is withheld, and
// to->held shrinks by it. HIDDEN: hidden samples.
enum hf_layers_sums { HF_SUMS_HIDING, HF_SUMS_SEEN, HF_SUMS_HELD, HF_SUMS_HIDDEN };
typedef void hf_layers_blend(const struct hf_stack_row *to, int channels, float *const in[5], enum hf_layers_sums sums,
                             int n);
// Add light as far as it is seen: out += part * in.
typedef void hf_layers_light(const float *part, const float *in, int n, float *out);
// The final n pixels from the near sums and, if not NULL, the far ones and light. Light is added as it is; its weights (4) are
// what it covers of the pixel, and sums fill the rest. Where the far coverage and light's that nothing cuts (5) are below `faint`,
// near and far share the open part. A result equal to the pixel's own colour takes its bits.
typedef void hf_layers_finish(const struct hf_stack_row *near, const float *const far[5], const float *const light[6],
                              const float *const own[4], int channels, float faint, int n, float *const out[4]);

// Subtract what is cut from light: out -= part * in, with a little more, so that nothing is left where all is subtracted from a
// sum that holds it with other roundings. It never passes 0.
typedef void hf_layers_dim(const float *part, const float *in, int n, float *out);
// Add what lies where the rays of n pixels of half resolution pass a row of coverage, up to 1. Returns whether there is something.
struct hf_layers_rays {
    float part, most;  // a ray passes this part of the way from its pixel to the lamp, and at most so far from it
    float lamp;        // where the rays meet, in pixels
    int x;             // the first pixel, of half resolution
    float size;        // samples of the coverage for a pixel; a power of 2
    const float *upper, *lower;  // two rows of coverage, and how much of each counts
    float above, below;
    int first, samples;  // the place of the rows' first sample, and how many they are; the ends are repeated
    float *line;         // scratch
};
typedef int hf_layers_passed(const struct hf_layers_rays *r, int n, float *out);

struct hf_layers_kernels {
    struct hf_passes passes;
    hf_layers_unmix *unmix;
    hf_layers_roots *roots;
    hf_layers_nine *nine;
    hf_layers_shares *shares;
    hf_layers_lamps *lamps;
    hf_layers_quads *quads;
    hf_layers_merge *merge;
    hf_layers_taps *taps;
    hf_layers_between *between;
    hf_layers_nearest *nearest;
    hf_layers_found *found;
    hf_layers_spread *spread;
    hf_layers_smooth *smooth;
    hf_layers_alike *alike;
    hf_layers_extremes *extremes;
    hf_layers_inside *inside;
    hf_layers_weigh *weigh;
    hf_layers_fold *fold;
    hf_layers_disc *disc;
    hf_layers_pairs *pairs;
    hf_layers_runs *runs;
    hf_layers_weights *weights;
    hf_layers_stamp *stamp;
    hf_layers_up *up;
    hf_layers_blend *blend;
    hf_layers_light *light;
    hf_layers_finish *finish;
    hf_layers_dim *dim;
    hf_layers_passed *passed;
    hf_layers_views *views;
};
HF_DECLARE_KERNELS(hf_layers_kernels);

#define HF_LAYERS_DIM_MORE (1 + 0x1p-18f)

// How much a sample of that brightness counts in a mean: fully up to `plain`, less above, by the fourth power, down to
// that of FAINTEST. Otherwise a mean of a lamp and its surroundings would be the lamp's colour.
#define HF_LAYERS_FAINTEST (1.0f / 256)
static inline float hf_layers_dimmed(float light, float plain)
{
    if (!(light > plain))
        return 1;
    const float part = plain / light, some = part > HF_LAYERS_FAINTEST ? part : HF_LAYERS_FAINTEST,
                square = some * some;
    return square * square;
}

static inline const struct hf_layers *hf_layers(const struct hf_setup *s)
{
    return s->own;
}

static inline const struct hf_layers_kernels *hf_layers_kernels(const struct hf_frame *f)
{
    return f->kernels;
}

// The engine's buffers. Those named AT hold weight and radius; SEEN_AT also holds the share, QUADS_AT the nearest radius
// that hides.
enum {
    HF_LAYERS_BUF_COLOUR,
    HF_LAYERS_BUF_RADIUS,
    HF_LAYERS_BUF_SEEN,
    HF_LAYERS_BUF_SEEN_AT,
    HF_LAYERS_BUF_MIXED,
    HF_LAYERS_BUF_MIXED_AT,
    HF_LAYERS_BUF_QUADS,
    HF_LAYERS_BUF_QUADS_AT,
    HF_LAYERS_BUF_HIDDEN,
    HF_LAYERS_BUF_HIDDEN_AT,
    HF_LAYERS_BUF_BEYOND,
    HF_LAYERS_BUF_BEYOND_AT,
    HF_LAYERS_BUF_SECOND,  // hidden samples at full resolution, of frames with known surfaces
    HF_LAYERS_BUF_SECOND_AT,
    HF_LAYERS_BUF_THIRD,
    HF_LAYERS_BUF_THIRD_AT,
    HF_LAYERS_BUFS
};

hf_kernel hf_layers_load_pass, hf_layers_unmix_pass, hf_layers_hidden_pass, hf_layers_patterns_pass,
    hf_layers_known_pass, hf_layers_composite_pass;
// Of each tile of a row of tiles: 1 if it may have mixed pixels, and highlights. Of other tiles the weights, the mixed
// samples and the shares need not be read.
struct hf_layers_any {
    uint8_t *mixed, *bright;
};
// Note the radii and slices of the samples that a cell has made, tile by tile.
void hf_layers_mark_seen(const struct hf_frame *f, struct hf_rect r, const struct hf_layers_any *any);
// Likewise for hidden samples. some: whether each of a row of tiles may have samples, of the first and the second hidden surface;
// NULL: all may.
void hf_layers_mark_hidden(const struct hf_frame *f, struct hf_rect r, const uint8_t *const some[2]);

// Of a disc's rows, counted from the outermost inwards: the last that reaches rows from..to around two sources.
static inline int hf_layers_least_row(int from, int to)
{
    return from > 1 ? from - 1 : to < 1 ? 1 - to : 0;
}

hf_layers_unmix hf_layers_unmix_c;
hf_layers_roots hf_layers_roots_c;
hf_layers_nine hf_layers_nine_c;
hf_layers_shares hf_layers_shares_c;
hf_layers_lamps hf_layers_lamps_c;
hf_layers_quads hf_layers_quads_c;
hf_layers_merge hf_layers_merge_c;
hf_layers_taps hf_layers_taps_c;
hf_layers_between hf_layers_between_c;
hf_layers_nearest hf_layers_nearest_c;
hf_layers_found hf_layers_found_c;
hf_layers_spread hf_layers_spread_c;
hf_layers_smooth hf_layers_smooth_c;
hf_layers_alike hf_layers_alike_c;
hf_layers_extremes hf_layers_extremes_c;
hf_layers_inside hf_layers_inside_c;
hf_layers_weigh hf_layers_weigh_c;
hf_layers_fold hf_layers_fold_c;
hf_layers_disc hf_layers_disc_c;
hf_layers_pairs hf_layers_pairs_c;
hf_layers_runs hf_layers_runs_c;
hf_layers_weights hf_layers_weights_c;
hf_layers_stamp hf_layers_stamp_c;
hf_layers_up hf_layers_up_c;
hf_layers_blend hf_layers_blend_c;
hf_layers_light hf_layers_light_c;
hf_layers_finish hf_layers_finish_c;
hf_layers_dim hf_layers_dim_c;
hf_layers_passed hf_layers_passed_c;
hf_layers_views hf_layers_views_c;

extern const struct hf_engine_def hf_layers_engine;

#endif
