// SPDX-License-Identifier: BSD-3-Clause
// What the passes in plain C share. They are the specification: a vector version gives the same bits, or with fused
// multiply-add fewer roundings. So an order of operations that looks odd is deliberate. The usual reason: a mirrored
// picture must give the mirrored result, bit for bit.
#ifndef HF_PASS_C_H
#define HF_PASS_C_H

#include "pixel/depth.h"
#include "pixel/kernels.h"

hf_coc_row hf_coc_row_c;
hf_sharp_row hf_sharp_row_c;
hf_kernel hf_radius_pass;
hf_radius_row hf_radius_row_c;
hf_zip_row hf_zip_row_c;
hf_unzip_row hf_unzip_row_c;

// The variable that CoC is linear in at a pixel: z, -1/z with a lens, or the radius itself.
float hf_coc_variable(const struct hf_frame *f, int x, int y, struct hf_counts *counts);

// The CoC from 0 to 1, linear or smoothstep; NaN becomes 0.
static inline float hf_ramp(const struct hf_setup *s, float t)
{
    t = hf_saturate(t);
    return s->smoothstep ? hf_smoothstep(t) : t;
}

float hf_round_coc(enum hf_storage storage, float t);

// Read a row of the frame's colour for an engine. Samples that are not finite are repaired, highlights are raised if
// asked for, and chapter storage truncates. Repaired samples are counted in counts, unless it is NULL.
void hf_read_colour(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                    struct hf_counts *counts);
// The same without raising highlights.
void hf_read_given(const struct hf_frame *f, int x, int y, int n, float *const even[4], float *const odd[4],
                   struct hf_counts *counts);
// Store n lanes as the target's format wants them, as far as they lie in the region. Returns how many samples were clamped.
uint64_t hf_store_lanes(const struct hf_frame *f, int x, int y, int n, const float *const even[4],
                        const float *const odd[4]);
// Store an engine's rows: highlights are lowered, and a sample that still has the bits that hf_read_colour gave takes
// the picture's own bits. even[3] and odd[3] NULL: alpha is 1 if the format has one. Clamped samples are counted.
void hf_store_colour(const struct hf_frame *f, int x, int y, int n, const float *const even[4],
                     const float *const odd[4]);
// Read 2n pixels in order from pixel 2x on. Uses scratch rows 0 to 7.
void hf_read_pixels(const struct hf_frame *f, int x, int y, int n, float *const out[4], struct hf_counts *counts);
// Store 2n pixels in order from pixel 2x of row y on, converted to the target's format; clamped samples are counted.
// alpha 0: in[3] is missing, and alpha is 1 if the format has one. Uses scratch rows 0 to 7.
void hf_write_pixels(const struct hf_frame *f, int x, int y, int n, const float *const in[4], int alpha);

// Round n colours to what the storage holds, as a pass writes them; channel 3 is alpha.
static inline void hf_store_rgb(const struct hf_frame *f, float *const ch[4], int n)
{
    if (f->s->storage == HF_STORAGE_PACKED)
        f->k->truncate_r11(ch[0], ch[1], ch[2], n);
    else if (f->s->storage == HF_STORAGE_HALF)
        for (int c = 0; c < f->s->channels; c++)
            f->k->round_half(ch[c], n);
}

// Pointers to a buffer's channels at (x, y); NULL for a buffer that the frame does not have.
static inline void hf_row(const struct hf_buf *b, int channels, int x, int y, float *ch[4])
{
    for (int c = 0; c < channels; c++)
        ch[c] = b->ch[c] ? hf_at(b, c, x, y) : NULL;
}

// a + t (b - a), but exactly a's bits for t = 0: a pixel that is not blended must not change -0.0 or overflow.
static inline float hf_lerp(float a, float b, float t)
{
    return t == 0 ? a : a + t * (b - a);
}

#endif
