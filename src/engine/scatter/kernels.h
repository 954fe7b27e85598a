// SPDX-License-Identifier: BSD-3-Clause
// The scatter's kernels.
#ifndef HF_SCATTER_KERNELS_H
#define HF_SCATTER_KERNELS_H

#include "pass/engine.h"
#include "engine/scatter/scatter.h"

struct hf_run;
struct hf_scatter_slice;
// Draw a list of sprites into the sums (splat.c).
typedef void hf_splat(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list);
// Draw an outline's rows from row y on, around column x.
typedef void hf_splat_runs(const struct hf_sums *s, int x, int y, const struct hf_run *run, int rows,
                           const int64_t share[4]);
// Draw an image's rows from (x, y) on, as differences.
typedef void hf_splat_taps(const struct hf_sums *s, int x, int y, const int16_t *tap, int columns, int rows,
                           const int64_t share[4]);
// The weights of n pixels in a field at full resolution (out[3]), and their weighted colours. sign: of the field's
// radii.
typedef void hf_source_weights(const struct hf_scatter *t, float sign, const float *radius,
                               const float *const colour[3], int channels, int n, float *const out[4]);
// The sprite numbers of n sources, -1 where weight or radius is not positive.
typedef void hf_source_pictures(const float *radius, const float *weight, float scale, int n, int32_t *out);
// Add sources `from` to `to` of a row to the lists of their bins, which have room. inverse: 1 / area of each sprite.
typedef void hf_list_row(struct hf_splats list[HF_BINS], const struct hf_source_row *row, int from, int to,
                         const float *inverse, const struct hf_bins *bins);
// Settle a finished row of n pixels and its margins: integrate each bin's sums, scale them, add the bins up, split them
// into planes (lane 3, the weight, to out[3]), and clear the sums.
typedef void hf_settle(int64_t *const lane[HF_BINS], int bins, int n, int channels, const double (*unscale)[4],
                       float *const out[4]);
// Multiply rows of n pixels, `channels` of colour and the weight (3), by their part in a slice.
typedef void hf_slice_row(const struct hf_scatter_slice *s, float sign, const float *radius, int channels, int n,
                          float *const row[4]);
// Composite n pixels of a slice behind those of the slices in front of it: weighted colours, of which some may be NULL,
// and weights (3). at: the pixels' radii; the shares of their backs, or NULL; and the radii of these.
typedef void hf_slice_behind(const struct hf_scatter *t, const float *const at[3], float *const slice[4], int n,
                             float *const to[4]);
// Count what n blurred pixels' samples contain.
typedef void hf_scatter_note(const float *radius, float *const colour[4], int channels, int n,
                             struct hf_counts *counts);
// Composite the fields with a row of pixels.
typedef void hf_scatter_blend(const struct hf_scatter_row *row, float *out);
// The weights of n half-resolution pixels in a field, and these times their radii, from two rows of 2n radii.
typedef void hf_quad_row(const struct hf_scatter *t, const float *above, const float *below, int n, float sign,
                         float *const out[2]);
// The radii of n half-resolution sources, 0 for none, from three rows of quads with one more on either side.
typedef void hf_site_row(const float *const weight[3], const float *const moment[3], int n, float *out);
// Weights and weighted colours of a row's pixels from column `first` on. Returns whether some belong to no mean or only
// in part.
typedef int hf_tent_weights(const struct hf_tent_row *t, int first);
// Means with weights 1 3 3 1 in eighths, of even and odd pixels; reads even up to n, odd from -1 on.
typedef void hf_tent(const float *even, const float *odd, int n, float *out);
// Half the weighted sum of four rows.
typedef void hf_mean_row(const float *const tent[4], const float part[4], int n, float *out);

// The visible parts of pixels `first` (even) to n, sharp and far, in quarters of a quad. widest: the largest near
// radius around each quad. Returns bit 0 if some is sharp, bit 1 if some is far.
typedef int hf_seen_weights(const struct hf_scatter *t, const float *radius, const float *widest, int first, int n,
                            float *const out[2]);
// Blend what is visible around pixels, sharp and far, with what the fields hold there.
typedef void hf_behind_blend(const struct hf_scatter_row *row, const float *const weight[2],
                             const float *const colour[2], const float *own, float *out);

struct hf_scatter_kernels {
    struct hf_passes passes;
    hf_splat *splat;
    hf_splat_runs *splat_runs;
    hf_splat_taps *splat_taps;
    hf_source_weights *source_weights;
    hf_source_pictures *source_pictures;
    hf_list_row *list_row;
    hf_settle *settle;
    hf_quad_row *quad_row;
    hf_site_row *site_row;
    hf_tent_weights *tent_weights;
    hf_tent *tent;
    hf_mean_row *mean_row;
    hf_slice_row *slice_row;
    hf_slice_behind *slice_behind;
    hf_scatter_note *note;
    hf_scatter_blend *blend;
    hf_seen_weights *seen_weights;
    hf_behind_blend *behind_blend;
};
HF_DECLARE_KERNELS(hf_scatter_kernels);

static inline const struct hf_scatter_kernels *hf_scatter_kernels(const struct hf_frame *f)
{
    return f->kernels;
}

hf_kernel hf_scatter_prepare_c, hf_splat_far, hf_splat_near, hf_scatter_composite_c;
hf_splat hf_splat_c;
hf_splat_runs hf_splat_runs_c;
hf_splat_taps hf_splat_taps_c;
hf_source_weights hf_source_weights_c;
hf_source_pictures hf_source_pictures_c;
hf_list_row hf_list_row_c;
hf_settle hf_settle_c;
hf_quad_row hf_quad_row_c;
hf_site_row hf_site_row_c;
hf_tent_weights hf_tent_weights_c;
hf_tent hf_tent_c;
hf_mean_row hf_mean_row_c;
hf_slice_row hf_slice_row_c;
hf_slice_behind hf_slice_behind_c;
hf_scatter_note hf_scatter_note_c;
hf_scatter_blend hf_scatter_blend_c;
hf_seen_weights hf_seen_weights_c;
hf_behind_blend hf_behind_blend_c;

extern const struct hf_engine_def hf_scatter_engine;

#endif
