// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors: what a block is blended by. Both fields are upsampled bilinearly.
#include "engine/gather/part_vf.h"
#include "pixel/composite_vf.h"

// In coc and near_coc it puts how much each field counts.
HF_INLINE int blend_kind(const struct composite_rows *r, const int rows, int with_far, int with_near, const int bicubic,
                         int x, vf coc[2][2], vf near_coc[2][2])
{
    int kind = 0;
    if (with_far && blend_has_far(rows, coc)) {
        vf up[2][2];
        near_up(&r->far_coc, rows, 0, 0, x, up);
        kind = BLEND_FAR;
        for (int i = 0; i < 2 * rows; i++) {
            const struct hf_part_curve curve = {.linear = 1 - r->square, .square = r->square};
            const vf own = level_part(curve, vf_set1(r->blend), coc[i / 2][i % 2]);
            const vf around = vf_sub(vf_mul(vf_set1(2 / 16.0f), up[i / 2][i % 2]), own);
            coc[i / 2][i % 2] = vf_max(vf_min(around, own), vf_zero());
        }
    }
    if (with_near && blend_has_near(r, rows, bicubic, 1, x, near_coc))
        kind |= BLEND_NEAR;
    return kind;
}

// (1 - t) v + share x field; v's own bits for t = 0, which it keeps anyway if it is plain: v finite and not -0, and share
// 0 where t is.
HF_INLINE vf over(vf v, vf t, vf share, vf field, const int plain)
{
    const vf blended = vf_fma(share, field, vf_mul(vf_sub(vf_set1(1), t), v));
    return plain ? blended : vf_select(vf_ne(t, vf_zero()), blended, v);
}

HF_INLINE void blend_block(const struct composite_rows *r, const int rows, const int channels, const int kind,
                           const int how, int x, vf near_coc[2][2], vi words[2][2], vi *most, struct composite_block *b)
{
    const int bicubic = how & HOW_BICUBIC, packed = how & HOW_PACKED;
    const vf sixteenth = vf_set1(1 / 16.0f);
    HF_UNROLL(4)
    for (int c = 0; c < channels; c++) {
        vf up[2][2] = {{vf_zero()}};
        for (int i = 0; i < 2 * rows && packed; i++)
            b->colour[i / 2][i % 2][c] = r11_channel(words[i / 2][i % 2], c, most);
        if (kind & BLEND_FAR)
            near_up(&r->far, rows, 0, c, x, up);
        for (int i = 0; i < 2 * rows && kind & BLEND_FAR; i++) {
            const vf t = b->coc[i / 2][i % 2];
            vf *to = &b->colour[i / 2][i % 2][c];
            *to = over(*to, t, vf_mul(t, sixteenth), up[i / 2][i % 2], packed);
        }
        if (kind & BLEND_NEAR)
            near_up(&r->near, rows, bicubic, c, x, up);
        for (int i = 0; i < 2 * rows && kind & BLEND_NEAR; i++) {
            vf *to = &b->colour[i / 2][i % 2][c];
            *to = over(*to, near_coc[i / 2][i % 2], bicubic ? vf_set1(1) : sixteenth, up[i / 2][i % 2], 0);
        }
    }
}

HF_INLINE int composite_how(const struct hf_setup *s)
{
    return hf_fields(s)->bicubic ? HOW_BICUBIC : 0;
}

HF_INLINE float composite_gain(const struct hf_setup *s)
{
    return hf_gather_levels(s, HF_FAR)->gain;
}

HF_INLINE float composite_square(const struct hf_setup *s)
{
    return hf_gather_levels(s, HF_FAR)->curve.square;
}

enum {
    COMPOSITE_FAR = HF_BUF_FAR,
    COMPOSITE_FAR_COC = HF_BUF_FAR_PART,
    COMPOSITE_FAR_CHANNEL = 0,
    COMPOSITE_NEAR = HF_BUF_NEAR,
    COMPOSITE_NEAR_COC = HF_BUF_COVER,
};
#include "pixel/composite_simd.inc"

COMPOSITE_RUN(none, 0, 0)
COMPOSITE_RUN(near, BLEND_NEAR, 0)
COMPOSITE_RUN(far, BLEND_FAR, 0)
COMPOSITE_RUN(both, BLEND_NEAR | BLEND_FAR, 0)

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    static composite_run_of_kind *const run[4] = {composite_run_none, composite_run_near, composite_run_far,
                                                  composite_run_both};
    composite_fields(f, r, run);
}
