// SPDX-License-Identifier: BSD-3-Clause
// Kernels that all engines share: rows of images, rows of depth as CoC or radius, rows of pixels in order.
#ifndef HF_PIXEL_KERNELS_H
#define HF_PIXEL_KERNELS_H

#include "pass/frame.h"
#include "pixel/format.h"
#include "simd/choose.h"

// Load a row of an image: n lanes from lane x of row y (2n pixels from pixel 2x), split into even and odd pixels. At an
// odd width the odd pixel of the last lane repeats the even one. even and odd are 64-byte aligned and have HF_PAD spare
// floats. A missing alpha is not written. Returns non-zero if a sample is not finite; repair.c then has to process the
// row.
typedef int hf_load_row(const struct hf_image *image, int x, int y, int n, float *const even[4], float *const odd[4]);
// Store a row. even and odd may hold anything past their n lanes. even[3] NULL: alpha is 1 if the format has one.
// Returns the number of samples that had to be clamped.
typedef uint64_t hf_store_row(const struct hf_image *image, int x, int y, int n, const float *const even[4],
                              const float *const odd[4]);

// Whether a run of n words is finite: floats, halves, or R11G11B10F words. If copy is not NULL, they are copied; if
// some are not finite, the copy may be incomplete.
typedef int hf_finite(const void *words, size_t n, void *copy);

// Convert n depth samples to floats; p need not be aligned. May write HF_PAD floats past the end of out.
typedef void hf_widen_depth(const void *p, int n, float *out);

// Near and far CoC of the n lanes from lane x of full-resolution row y, to four rows: near even, near odd, far even,
// far odd. counts NULL: the near rows need not be written and nothing is counted; else x must be a multiple of 16.
typedef void hf_coc_row(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// Whether all pixels of those lanes are surfaces without CoC. Returns 0 where finding out would take longer than making
// the CoC.
typedef int hf_sharp_row(const struct hf_frame *f, int x, int y, int n);

// Signed CoC radii of n full-resolution pixels from (x, y) on, in order. counts NULL: nothing is counted; else x must
// be a multiple of 32.
typedef void hf_radius_row(const struct hf_frame *f, int x, int y, int n, float *out, struct hf_counts *counts);

// Interleave n even and n odd pixels to 2n pixels in order, and split them again.
typedef void hf_zip_row(const float *even, const float *odd, int n, float *out);
typedef void hf_unzip_row(const float *in, int n, float *even, float *odd);

// Round a row of n floats in place to what a storage holds; may touch HF_PAD more floats.
typedef void hf_round_row(float *v, int n);
typedef void hf_round_rgb(float *r, float *g, float *b, int n);

// Raise or lower the highlights of n pixels' R, G and B in place. May touch HF_PAD more floats.
typedef void hf_highlight_row(const struct hf_highlight *h, float *r, float *g, float *b, int n);

// Rows of the disocclusion fill (behind.c), n quads each.
// Raise out to the near radii of two pixels each.
typedef void hf_near_row(const float *radius, int n, float *out);
// The largest of three.
typedef void hf_most_row(const float *a, const float *b, const float *c, int n, float *out);
// Add pairs of pixels, v times weight times scale, to out.
typedef void hf_seen_row(const float *v, const float *weight, float scale, int n, float *out);
// The mean of three.
typedef void hf_third_row(const float *a, const float *b, const float *c, int n, float *out);
// The weight of a neighbourhood of that size behind near radii, times share.
typedef void hf_part_row(const float *near, float share, float size, int n, float *out);
// out + part * in.
typedef void hf_add_part(const float *in, const float *part, int n, float *out);
// Upsample n quads to 2n pixels bilinearly, from their own row and the row beside it; reads quads -1 to n.
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

// A row of pixels to be taken apart (edges.h), and the rows of its two sides; [0] is the front.
struct hf_edge_row {
    int channels;
    float sharp;             // radii up to this one are written as 0
    const float *own;        // the row's radii, so written
    const float *radius[5];  // by how much radii exceed `sharp`; row 0 is two above
    const float *sure[5];    // 1: not mixed; 0: wholly
    const float *middle,
        *slope;  // of the 3 x 3 around each pixel: hf_edges_sure
    const float *colour[5][4];
};
struct hf_sides {
    float *colour[2][4], *radius[2];
    float *share;  // of the back, 0..1
};
// From the 3 x 3 radii around each pixel: sure, 1 if they are of one surface to 0 if of two; their middle; and slope,
// how fast the front becomes the back around the middle. All three are undefined at the first and the last pixel.
typedef void hf_edges_sure(const float *const radius[3], int n, float *sure, float *middle, float *slope);
// Reads two pixels beyond both ends; writes whole vectors.
typedef void hf_edges_take(const struct hf_edge_row *row, int n, const struct hf_sides *out);

struct hf_edges_kernels {
    hf_edges_sure *sure;
    hf_edges_take *take;
};

// The near field's outward blur (fields.h).
struct hf_fields_kernels {
    hf_kernel *max_x, *max_y, *blur_x, *blur_y;
};

struct hf_pixel_kernels {
    hf_coc_row *coc_row;
    hf_sharp_row *sharp_row;
    hf_radius_row *radius_row;
    hf_zip_row *zip;
    hf_unzip_row *unzip;
    hf_load_row *load[HF_FORMAT_COUNT];
    hf_store_row *store[HF_FORMAT_COUNT];
    hf_widen_depth *depth[HF_DEPTH_FORMAT_COUNT];  // none for float32, which is read in place
    hf_finite *finite_f32, *finite_f16, *finite_r11, *finite_any;
    hf_round_rgb *truncate_r11;  // to R11G11B10F, towards zero
    hf_round_row *round_half;    // to nearest even, clamped to +-65504
    hf_highlight_row *raise, *lower;
    struct hf_behind_kernels behind;
    struct hf_edges_kernels edges;
    struct hf_fields_kernels fields;
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
