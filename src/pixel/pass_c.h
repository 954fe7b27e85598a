// SPDX-License-Identifier: BSD-3-Clause
// What the passes in plain C share. They are the specification: a vector version gives the same bits, or with fused
// multiply-add less rounding. So the order of operations here is deliberate where it looks odd; the usual reason is
// that a mirrored picture must give the mirrored result, bit for bit.
#ifndef HF_PASS_C_H
#define HF_PASS_C_H

#include "frame/pass.h"
#include "params.h"

hf_kernel hf_coc_c, hf_down_c, hf_max_x_c, hf_max_y_c, hf_blur_x_c, hf_blur_y_c, hf_gather_c, hf_fill_c, hf_composite_c;
hf_coc_row hf_coc_row_c;
hf_sharp_row hf_sharp_row_c;
hf_kernel hf_radius_c;
hf_radius_row hf_radius_row_c;
hf_kernel hf_gaussian_depth_pass, hf_gaussian_rows_pass, hf_gaussian_columns_pass, hf_gaussian_merge_pass;
hf_blend_row hf_blend_row_c;
hf_lerp_row hf_lerp_row_c;
hf_gaussian_line hf_gaussian_line_c;
hf_gaussian_columns hf_gaussian_columns_c;
hf_gaussian_up hf_gaussian_up_c;
hf_kernel hf_wide_columns_pass, hf_wide_rows_pass;
hf_wide_block hf_wide_block_c;
hf_zip_row hf_zip_row_c;
hf_unzip_row hf_unzip_row_c;
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
hf_scatter_note hf_scatter_note_c;
hf_scatter_blend hf_scatter_blend_c;

// The variable that CoC is linear in at a pixel: z, -1/z with a lens, or the radius itself.
float hf_coc_variable(const struct hf_frame *f, int x, int y, struct hf_counts *counts);

void hf_coc_pixel(const struct hf_frame *f, int x, int y, float *n, float *far, struct hf_counts *counts);

// CoC from 0 to 1, of the shape that was asked for; NaN becomes 0.
static inline float hf_ramp(const struct hf_setup *s, float t)
{
    t = hf_saturate(t);
    return s->smoothstep ? (t * t) * (3 - 2 * t) : t;
}

float hf_round_coc(enum hf_storage storage, float t);

// Round n colours to what the storage holds when a pass writes them: channel 3 is alpha.
static inline void hf_store_rgb(const struct hf_frame *f, float *const ch[4], int n)
{
    if (f->s->storage == HF_STORAGE_CHAPTER)
        f->k->truncate_r11(ch[0], ch[1], ch[2], n);
    else if (f->s->storage == HF_STORAGE_HALF)
        for (int c = 0; c < f->s->channels; c++)
            f->k->round_half(ch[c], n);
}

// Row y of a buffer's channels, from x.
static inline void hf_row(const struct hf_buf *b, int channels, int x, int y, float *ch[4])
{
    for (int c = 0; c < channels; c++)
        ch[c] = hf_at(b, c, x, y);
}

// a + t (b - a), and a's own bits for t = 0: what is not blended must not change -0.0 or overflow.
static inline float hf_lerp(float a, float b, float t)
{
    return t == 0 ? a : a + t * (b - a);
}

// Uniform cubic B-spline a quarter of a pixel off the centre: weights of the neighbour on that side, of the one on
// the other side, and of the one behind the neighbour. The rest, 235/384, is the pixel's own.
#define CUBIC_NEIGHBOUR (121 / 384.0f)
#define CUBIC_OTHER (27 / 384.0f)
#define CUBIC_BEHIND (1 / 384.0f)

#endif
