// SPDX-License-Identifier: BSD-3-Clause
// Kernels that all engines share: rows of images, of depth as CoC or radius, of pixels in order.
#ifndef HF_PIXEL_KERNELS_H
#define HF_PIXEL_KERNELS_H

#include "pass/frame.h"
#include "pixel/format.h"
#include "simd/choose.h"

// Rows of an image: n lanes from lane x of row y (that is 2n pixels from 2x), split into even and odd pixels. The odd
// pixel of the last lane of an odd width repeats the even one. even and odd are 64-byte aligned and have HF_PAD floats
// to spare. Returns non-zero if a sample is not finite (then repair.c has to look at the row). A missing alpha is left
// alone.
typedef int hf_load_row(const struct hf_image *image, int x, int y, int n, float *const even[4], float *const odd[4]);
// The other way. even and odd may hold anything past their n lanes. even[3] NULL: alpha 1 if the format has one.
// Returns the number of samples that had to be clamped.
typedef uint64_t hf_store_row(const struct hf_image *image, int x, int y, int n, const float *const even[4],
                              const float *const odd[4]);

// Is a run of n words finite: floats, halves, R11G11B10F words? They are copied on the way if copy is not NULL; if they
// are not finite, not all of them may be.
typedef int hf_finite(const void *words, size_t n, void *copy);

// n depth samples to floats; p need not be aligned. out may be written up to HF_PAD floats past its end.
typedef void hf_widen_depth(const void *p, int n, float *out);

// Near and far CoC of the n lanes from lane x of full-resolution row y, into four rows: near even, near odd, far even,
// far odd. counts NULL: the near rows need not be written, and nothing is counted; else x is a multiple of 16.
typedef void hf_coc_row(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// Is every pixel of those lanes a surface without CoC? 0 where that takes longer to say than to make the CoC.
typedef int hf_sharp_row(const struct hf_frame *f, int x, int y, int n);

// Signed CoC radii of n full-resolution pixels from (x, y) on, in order. counts NULL: nothing is counted; else x is a
// multiple of 32.
typedef void hf_radius_row(const struct hf_frame *f, int x, int y, int n, float *out, struct hf_counts *counts);

// Rows of 2n pixels in order, from their n even and n odd ones, and back.
typedef void hf_zip_row(const float *even, const float *odd, int n, float *out);
typedef void hf_unzip_row(const float *in, int n, float *even, float *odd);

// Round a row of n floats to what a storage holds, in place; may touch HF_PAD floats more.
typedef void hf_round_row(float *v, int n);
typedef void hf_round_rgb(float *r, float *g, float *b, int n);

// Highlights of rows of n pixels, their R, G and B, in place: raised, and lowered again. May touch HF_PAD floats more.
typedef void hf_highlight_row(const struct hf_highlight *h, float *r, float *g, float *b, int n);

// What lies behind near pixels (behind.c), rows of n.
// The largest of out and of what near radii two pixels each have.
typedef void hf_near_row(const float *radius, int n, float *out);
// The largest of three.
typedef void hf_most_row(const float *a, const float *b, const float *c, int n, float *out);
// Pairs of pixels, v times weight times scale, added to out.
typedef void hf_seen_row(const float *v, const float *weight, float scale, int n, float *out);
// The mean of three.
typedef void hf_third_row(const float *a, const float *b, const float *c, int n, float *out);
// How much a neighbourhood of that size counts behind near radii, of a share.
typedef void hf_part_row(const float *near, float share, float size, int n, float *out);
// out + part * in.
typedef void hf_add_part(const float *in, const float *part, int n, float *out);
// 2 n pixels from n quads of their own row and of the one beside it, bilinearly; reads quads -1 to n.
typedef void hf_up_row(const float *own, const float *over, int n, float *out);

struct hf_behind_kernels {
    hf_near_row *near_row;
    hf_most_row *most_row;
    hf_seen_row *seen_row;
    hf_third_row *third_row;
    hf_part_row *part_row;
    hf_add_part *add_part;
    hf_up_row *up_row;
};

// A row of pixels to be taken apart (edges.h), and rows of its two sides; [0] the front.
struct hf_edge_row {
    int channels;
    float sharp;             // radii up to here are 0
    const float *own;        // the row's radii
    const float *radius[5];  // of rows from two above it on, what is beyond `sharp`
    const float *sure[5];    // 1: not mixed
    const float *middle,
        *slope;  // of the row: between front and back, and how fast a radius goes from one to the other
    const float *colour[5][4];
};
struct hf_sides {
    float *colour[2][4], *radius[2];
    float *share;  // the back's, 0..1
};
// How little the 3 x 3 radii of a pixel differ, 1 for one surface to 0 for two; the middle of these radii; and how fast
// front becomes back around it. Of the first and the last pixel it means nothing.
typedef void hf_edges_sure(const float *const radius[3], int n, float *sure, float *middle, float *slope);
// Reads two pixels around n; writes whole vectors.
typedef void hf_edges_take(const struct hf_edge_row *row, int n, const struct hf_sides *out);

struct hf_edges_kernels {
    hf_edges_sure *sure;
    hf_edges_take *take;
};

struct hf_pixel_kernels {
    hf_coc_row *coc_row;
    hf_sharp_row *sharp_row;
    hf_radius_row *radius_row;
    hf_zip_row *zip;
    hf_unzip_row *unzip;
    hf_load_row *load[HF_FORMAT_COUNT];
    hf_store_row *store[HF_FORMAT_COUNT];
    hf_widen_depth *depth[HF_DEPTH_FORMAT_COUNT];  // none for float32, which is read where it is
    hf_finite *finite_f32, *finite_f16, *finite_r11, *finite_any;
    hf_round_rgb *truncate_r11;  // R11G11B10F, towards zero
    hf_round_row *round_half;    // to nearest even, clamped to +-65504
    hf_highlight_row *raise, *lower;
    struct hf_behind_kernels behind;
    struct hf_edges_kernels edges;
};
HF_DECLARE_KERNELS(hf_pixel_kernels);

void hf_format_kernels_c(struct hf_pixel_kernels *k);  // the rows of images among them (format.c)
void hf_behind_rows_c(struct hf_pixel_kernels *k);     // and of what lies behind near pixels (behind_rows.c)

hf_highlight_row hf_raise_row_c;
hf_highlight_row hf_lower_row_c;
hf_edges_sure hf_edges_sure_c;
hf_edges_take hf_edges_take_c;
hf_near_row hf_near_row_c;
hf_most_row hf_most_row_c;
hf_seen_row hf_seen_row_c;
hf_add_part hf_add_part_c;

#endif
