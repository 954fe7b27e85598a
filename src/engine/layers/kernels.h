// SPDX-License-Identifier: BSD-3-Clause
// The kernels of layers.
#ifndef HF_LAYERS_KERNELS_H
#define HF_LAYERS_KERNELS_H

#include "pass/engine.h"
#include "engine/layers/layers.h"

typedef void hf_layers_unmix(const struct hf_unmix_row *row, int n);
// Mean roots of brightness of n quads, from two rows of colour.
typedef void hf_layers_roots(const float *const above[3], const float *const below[3], int n, float *out);
// Sums of nine numbers: of a line, and of lines.
typedef void hf_layers_nine(const float *const in[9], int n, float *out);
// What of n pixels' weight is a highlight: in is colour, weight (4), radius (5); the least of five is the root of brightness
// around, one for two pixels. covered: of the same places, roots of alpha, or NULL.
typedef void hf_layers_shares(const float *const in[6], const float *const around[5], const float *const covered[5],
                              int n, float *out);
// The farthest of n quads from two rows of samples: colour, weight (4), radius (5).
typedef void hf_layers_quads(const float *const seen[2][6], const float *const mixed[2][6], int channels, int n,
                             float *const out[6]);
// Three samples of each lane become one: those within about 1 / slope of the farthest. out may be none of in.
typedef void hf_layers_merge(const float *const in[3][6], int channels, float slope, int n, float *const out[6]);
// Add taps of levels to the sums, one after the other.
struct hf_hidden_tap;
typedef void hf_layers_taps(const struct hf_hidden_tap *tap, int count, int channels, const float *nearest, int n,
                            float *const sum[6]);
// Add what lies behind `nearest` on both sides of a line to the sums.
struct hf_hidden_line;
typedef void hf_layers_between(const struct hf_hidden_line *line, int channels, const float *nearest, int n,
                               float *const sum[6]);
// Least of the radii of n quads, from two rows.
typedef void hf_layers_nearest(const float *above, const float *below, int n, float *out);
// Hidden samples, of which the colours are roots, from the sums of taps: their weight is how much of a quad lies more than a
// pixel of radius before them; its two rows are given of what is seen, then of what is behind mixed edges. Those of which the
// weight of taps times scale is below 1 weigh as much less.
typedef void hf_layers_found(const float *const sum[6], const float *const radius[4], const float *const weight[4],
                             int channels, float scale, int n, float *const out[6]);
// Hidden samples of n quads as those of one row of their pixels: the weight goes to pixels that lie more than a pixel of
// radius before them, of which radius and weight are given as for hf_layers_found, and is no more than theirs.
typedef void hf_layers_spread(const float *const in[6], const float *const radius[4], const float *const weight[4],
                              int row, int channels, int n, float *const out[6]);
// The mean of lines of thirteen hidden samples, of those with weight that are about as far as the middle one; its weight is
// kept, and without any it becomes nothing. along: weights and radii of the middle ones, of which six more are read on either
// side; a sample that is alone in its line and along these takes its line's place, and colours are no longer roots. Or NULL.
typedef void hf_layers_smooth(const float *const in[13][6], const float *const along[2], int channels, int n,
                              float *const out[6]);
// How alike what lies around n places side by side is to what is known around another: sums of the weights of its taps that
// are known there too, and of these times the square of how far colours are off.
struct hf_pattern_place;
struct hf_pattern_tap;
typedef void hf_layers_alike(const struct hf_pattern_place *place, const struct hf_pattern_tap *tap, int count,
                             const float *const in[6], int channels, int n, float *sum, float *off);
// Least and largest radius of what has weight in rows of n samples, with those that out holds; without weights all have.
// Returns whether a share is positive; share may be NULL.
typedef int hf_layers_extremes(const float *radius, const float *weight, const float *share, ptrdiff_t stride, int n,
                               int rows, struct hf_layers_range *out);
// Is there a sample with weight and a radius between `before` and `after` in rows of n?
typedef int hf_layers_inside(const float *radius, const float *weight, ptrdiff_t stride, int n, int rows, float before,
                             float after);
// Shares of a slice in n samples, and in those of rows - 1 rows below them, summed. add: to what out holds. share: of
// their weight whose colour, but not its alpha, is left out. any[i]
// is made 1 where there is any in the 16 samples from 16 i on. in[4] NULL: all weigh 1.
typedef void hf_layers_weigh(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                             int rows, int channels, int n, int add, float *const out[5], uint8_t *any);
// Sums of pairs of 2n numbers; out may be in.
typedef void hf_layers_fold(const float *in, int n, float *out);
// Draw n sources of two rows, one below the other, blurred by s into rows from..to; out is the upper one's.
typedef void hf_layers_disc(const struct hf_slice *s, const float *upper, const float *lower, int n, int from, int to,
                            float *out, ptrdiff_t stride);
// Sums of n numbers and those `apart` farther on.
typedef void hf_layers_pairs(const float *in, int apart, int n, float *out);
// Add runs of a row of sources to n pixels, each times its part if there is one. window: sums of 2^k sources, a plane
// each.
typedef void hf_layers_runs(const struct hf_shape_run *run, int count, const float *window, ptrdiff_t plane,
                            const float *part, int n, float *out);
// Add weights of a picture's row, the first for in[x] and the others for what comes before it.
typedef void hf_layers_weights(const float *weight, int count, const float *in, int n, float *out);
// Add a row of a picture of brightness v.
typedef void hf_layers_stamp(const float *weight, int n, float v, float *out);
// 2n numbers from n of two rows, three quarters of a and one of b; reads one more at either end.
typedef void hf_layers_up(const float *a, const float *b, int n, float *out);
// Put sums, the weight at 4, under what a stack holds; part, if not NULL, receives how much of them shows. Of samples that are
// seen, those that hide others leave these as much to cover as they found; those behind them leave less. HELD: of what is
// seen as much is held back as to->held says, which becomes less by that.
enum hf_layers_sums { HF_SUMS_HIDING, HF_SUMS_SEEN, HF_SUMS_HELD, HF_SUMS_HIDDEN };
typedef void hf_layers_blend(const struct hf_stack_row *to, int channels, const float *const in[5],
                             enum hf_layers_sums sums, int n, float *part);
// Shares of one radius, of which a slice shows so much: out += part * amount * in.
typedef void hf_layers_light(const float *part, float amount, const float *in, int n, float *out);
// The result of n pixels from what is near and, if not NULL, what is far, a gap before coverage below `faint` being
// shared by both; where the result is the pixel itself, its own bits.
typedef void hf_layers_finish(const struct hf_stack_row *near, const float *const far[5], const float *const own[4],
                              int channels, float faint, int n, float *const out[4]);

struct hf_layers_kernels {
    struct hf_passes passes;
    hf_layers_unmix *unmix;
    hf_layers_roots *roots;
    hf_layers_nine *nine;
    hf_layers_shares *shares;
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
};
HF_DECLARE_KERNELS(hf_layers_kernels);

// How much a sample of so much light counts in a mean: wholly up to `plain`, from there on less, by the fourth power down to
// that of FAINTEST. A mean of a lamp and what is around it would be the lamp's.
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

// The engine's buffers. Those named AT hold weight and radius, and of what is seen the share.
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
    HF_LAYERS_BUFS
};

hf_kernel hf_layers_load_pass, hf_layers_unmix_pass, hf_layers_hidden_pass, hf_layers_patterns_pass,
    hf_layers_composite_pass;
// Note the radii and slices of the samples that a cell has made.
void hf_layers_mark_seen(const struct hf_frame *f, struct hf_rect r);
void hf_layers_mark_hidden(const struct hf_frame *f, struct hf_rect r);

// Of a disc's rows, from the outermost inwards, the last that reaches rows from..to around two of its sources.
static inline int hf_layers_least_row(int from, int to)
{
    return from > 1 ? from - 1 : to < 1 ? 1 - to : 0;
}

hf_layers_unmix hf_layers_unmix_c;
hf_layers_roots hf_layers_roots_c;
hf_layers_nine hf_layers_nine_c;
hf_layers_shares hf_layers_shares_c;
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

extern const struct hf_engine_def hf_layers_engine;

#endif
