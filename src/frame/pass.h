// SPDX-License-Identifier: BSD-3-Clause
// The table of passes and the tables of kernels.
#ifndef HF_PASS_H
#define HF_PASS_H

#include "pixel/format.h"
#include "frame/frame.h"

// How far around a pixel a pass reads its .around buffers; the engine gives the numbers.
enum hf_halo {
    HF_HALO_NONE,
    HF_HALO_3X3,    // one pixel
    HF_HALO_MAX_X,  // gather: reach of the near max and blur, along one axis
    HF_HALO_MAX_Y,
    HF_HALO_TAPS,      // gather: reach of the taps
    HF_HALO_UPSAMPLE,  // one pixel, two for the cubic
    HF_HALO_RADIUS,    // the largest CoC radius
    HF_HALO_COLUMNS,   // gaussian: reach of its iterations down the columns
};

// The two fields: what a scene asks of a tile, was found in a chunk, or a pass or buffer serves.
enum { HF_NEAR = 1, HF_FAR = 2, HF_FIELDS = HF_NEAR | HF_FAR };

#define HF_BIT(buf) (1u << HF_BUF_##buf)

// Kernels beyond the gather's, which are numbered by its passes.
enum {
    HF_KERNEL_RADIUS = HF_PASS_COUNT,  // looks at the depth: counts, and the range of radii
    HF_KERNEL_HEXAGON_LOAD,
    HF_KERNEL_HEXAGON_1,
    HF_KERNEL_HEXAGON_2,
    HF_KERNEL_HEXAGON_BLUR,  // both, band by band
    HF_KERNEL_HEXAGON_COMPOSITE,
    HF_KERNEL_GAUSSIAN_DEPTH,  // looks at the depth: counts
    HF_KERNEL_GAUSSIAN_ROWS,
    HF_KERNEL_GAUSSIAN_COLUMNS,
    HF_KERNEL_WIDE_COLUMNS,  // gaussian, of any size
    HF_KERNEL_WIDE_ROWS,
    HF_KERNEL_GAUSSIAN_MERGE,
    HF_KERNEL_SCATTER_PREPARE,
    HF_KERNEL_SPLAT_FAR,
    HF_KERNEL_SPLAT_NEAR,
    HF_KERNEL_SCATTER_COMPOSITE,
    HF_KERNEL_COUNT
};

struct hf_pass {
    const char *name;
    int kernel;       // which one in hf_kernels.pass
    unsigned reads;   // buffers read at the pixel itself
    unsigned around;  // buffers read in its halo
    unsigned writes;
    unsigned inside;   // scratch of the pass itself, as large as what it writes ...
    unsigned weighed;  // ... and larger by the halo
    enum hf_halo halo;
    int sweep;       // 1: over the input; 2 and more: per cell, from buffers to the output
    unsigned field;  // runs where this field is needed; 0: where any is
    // Guess of its cost until it has been measured: nanoseconds per half-resolution pixel and field, at radius 12, with
    // AVX-512 at 3.7 GHz.
    float ns;
};

struct hf_reach {
    int x, y;  // half-resolution pixels
};

// The gather's halos.
struct hf_reach hf_pass_halo(const struct hf_setup *s, enum hf_halo halo);

// Computes r of the pass's output buffers, nothing else: r lies inside the frame, in half-resolution pixels. May
// write up to HF_PAD floats past the end of each row of them.
typedef void hf_kernel(const struct hf_frame *f, struct hf_rect r);

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

// Near and far CoC of the n lanes from lane x of full-resolution row y, into four rows: near even, near odd, far even,
// far odd. counts NULL: the near rows need not be written, and nothing is counted; else x is a multiple of 16.
typedef void hf_coc_row(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// Is every pixel of those lanes a surface without CoC? 0 where that takes longer to say than to make the CoC.
typedef int hf_sharp_row(const struct hf_frame *f, int x, int y, int n);

// Signed CoC radii of n full-resolution pixels from (x, y) on, in order. counts NULL: nothing is counted; else x is a
// multiple of 32.
typedef void hf_radius_row(const struct hf_frame *f, int x, int y, int n, float *out, struct hf_counts *counts);

// gaussian: blend factors of the n lanes from lane x of row y into out[0], even, and out[1], odd; out[2] and out[3] are
// scratch. counts NULL: nothing is counted.
typedef void hf_blend_row(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// a + t (b - a), a's own bits for t = 0.
typedef void hf_lerp_row(float *a, const float *b, const float *t, int n);
// One iteration of the 5-tap kernel along a line of n pixels with two more at either end. May read HF_PAD floats before
// and after them.
typedef void hf_gaussian_line(const float *in, int n, float *out, int faithful);
// One down n columns, at most HF_GAUSSIAN_STRIP: from rows of in, of which there are `rows` and which repeat at their ends,
// rows from to to. out is row `from` of the result, and may be that of in itself.
typedef void hf_gaussian_columns(const float *in, ptrdiff_t in_stride, int rows, int from, int to, float *out,
                                 ptrdiff_t out_stride, int n, int faithful);
// n lanes from lane x of row y of the frame, bilinearly from a buffer of half or a quarter of its size.
typedef void hf_gaussian_up(const struct hf_buf *b, int c, int quarter, int x, int y, int n, float *even, float *odd);

// HF_WIDE_LANES columns of n samples, side by side, blurred in place. work: hf_wide_floats(n) but for the block's own.
struct hf_wide;
typedef void hf_wide_block(float *block, int n, const struct hf_wide *w, float *work);

// Rows of 2n pixels in order, from their n even and n odd ones, and back.
typedef void hf_zip_row(const float *even, const float *odd, int n, float *out);
typedef void hf_unzip_row(const float *in, int n, float *even, float *odd);

// Round a row of n floats to what a storage holds, in place; may touch HF_PAD floats more.
typedef void hf_round_row(float *v, int n);
typedef void hf_round_rgb(float *r, float *g, float *b, int n);

struct hf_sums;
struct hf_splats;
struct hf_aperture;
struct hf_run;
// Scatter: draw a list of pictures into the sums (scatter/splat.c).
typedef void hf_splat(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list);
// One outline's rows from row y on, around column x.
typedef void hf_splat_runs(const struct hf_sums *s, int x, int y, const struct hf_run *run, int rows,
                           const int64_t share[4]);
// An image's rows from (x, y) on, as differences.
typedef void hf_splat_taps(const struct hf_sums *s, int x, int y, const int16_t *tap, int columns, int rows,
                           const int64_t share[4]);
struct hf_scatter;
struct hf_source_row;
// Scatter: weights of n pixels in a field at full resolution, out[3], and their weighted colours. sign: of its radii.
typedef void hf_source_weights(const struct hf_scatter *t, float sign, const float *radius,
                               const float *const colour[3], int channels, int n, float *const out[4]);
// Numbers of the pictures of n sources, -1 where weight or radius is not positive.
typedef void hf_source_pictures(const float *radius, const float *weight, float scale, int n, int32_t *out);
// Sources `from` to `to` of a row go to the list, which has room. inverse: 1 / area of each picture.
typedef void hf_list_row(struct hf_splats *list, const struct hf_source_row *row, int from, int to,
                         const float *inverse, const double scale[4]);
// A finished row of n pixels of sums, and its margins: integrated, scaled, split into planes (lane 3, the weight, to
// out[3]), and zeroed.
typedef void hf_settle(int64_t *lane, int n, int channels, const double unscale[4], float *const out[4]);

struct hf_scatter_row;
// The largest sample of n blurred pixels, and how many have another alpha than 1.
typedef void hf_scatter_note(const float *radius, float *const colour[4], int channels, int n, float *largest,
                             uint64_t *transparent);
// Put the fields over and under a row of pixels.
typedef void hf_scatter_blend(const struct hf_scatter_row *row, float *out);
struct hf_tent_row;
// Radii of n half-resolution pixels from two rows of 2n: 0 where none of the four is in the field, -1 where those that
// are differ.
typedef void hf_quad_row(const float *above, const float *below, int n, float sign, float *out);
// The same of n half-resolution sources, 0 for none, from three rows of quads; these from -1 to n.
typedef void hf_site_row(const float *const quad[3], int n, float *out);
// Weights and weighted colours of a row's pixels from column `first` on; returns whether some are no part of a mean.
typedef int hf_tent_weights(const struct hf_tent_row *t, int first);
// Means over 1 3 3 1 in eighths, of even and odd pixels; even up to n and odd from -1 on.
typedef void hf_tent(const float *even, const float *odd, int n, float *out);
// Half the weighted sum of four rows.
typedef void hf_mean_row(const float *const tent[4], const float part[4], int n, float *out);

struct hf_kernels {
    hf_kernel *pass[HF_KERNEL_COUNT];
    hf_coc_row *coc_row;
    hf_sharp_row *sharp_row;
    hf_radius_row *radius_row;
    hf_blend_row *blend_row;
    hf_lerp_row *lerp_row;
    hf_gaussian_line *gaussian_line;
    hf_gaussian_columns *gaussian_columns;
    hf_gaussian_up *gaussian_up;
    hf_wide_block *wide_block;
    hf_zip_row *zip;
    hf_unzip_row *unzip;
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
    hf_scatter_note *scatter_note;
    hf_scatter_blend *scatter_blend;
    hf_load_row *load[HF_FORMAT_COUNT];
    hf_store_row *store[HF_FORMAT_COUNT];
    hf_finite *finite_f32, *finite_f16, *finite_r11;
    hf_round_rgb *truncate_r11;  // R11G11B10F, towards zero
    hf_round_row *round_half;    // to nearest even, clamped to +-65504
};

// Complete: every kernel in C.
void hf_kernels_c(struct hf_kernels *k);
void hf_format_kernels_c(struct hf_kernels *k);  // its rows of images (format.c)
// Overwrite with vector kernels: with fused multiply-add, or to the same bits as the C. SSE4.1 has none to fuse.
void hf_kernels_sse41_exact(struct hf_kernels *k);
void hf_kernels_avx2_fused(struct hf_kernels *k);
void hf_kernels_avx2_exact(struct hf_kernels *k);
void hf_kernels_avx512_fused(struct hf_kernels *k);
void hf_kernels_avx512_exact(struct hf_kernels *k);
void hf_kernels_neon_fused(struct hf_kernels *k);
void hf_kernels_neon_exact(struct hf_kernels *k);
// The table for an instruction set.
void hf_kernels_init(struct hf_kernels *k, enum hf_isa isa, int fused);

// Load a row of the frame's colour: loaded, repaired where not finite, in chapter storage truncated.
// Returns nothing; repaired samples are counted in counts when it is not NULL.
void hf_read_colour(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                    struct hf_counts *counts);
// The same for 2n pixels in order from pixel 2x on. Uses scratch rows 0 to 7.
void hf_read_pixels(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// Store 2n pixels in order from pixel 2x of row y on, as the target's format wants them; what it clamps is counted.
// alpha 0: in[3] is not there, and is 1 if the format has one. Uses scratch rows 0 to 7.
void hf_write_pixels(const struct hf_frame *f, int x, int y, int n, const float *const in[4], int alpha);

#endif
