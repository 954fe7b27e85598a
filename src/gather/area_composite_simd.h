// SPDX-License-Identifier: BSD-3-Clause
// Composite by area, on vectors: both fields are upsampled bilinearly, with what rows share as there.

// How much each field counts at the pixels of a row or two; of the near field what near_up makes is made here. In place of
// CoC. Returns which fields there are.
HF_INLINE int area_blend_kind(const struct composite_rows *r, const int rows, int with_far, int with_near,
                              const int bicubic, int x, vf coc[2][2], vf near_coc[2][2])
{
    int kind = 0;
    vi far = vi_set1(0), near = vi_set1(0);
    if (with_far) {
        for (int i = 0; i < 2 * rows; i++)
            far = vi_or(far, vf_as_vi(coc[i / 2][i % 2]));
        if (vi_any(far)) {
            vf up[2][2];
            near_up(&r->far_coc, rows, 0, 0, x, up);
            kind = BLEND_FAR;
            for (int i = 0; i < 2 * rows; i++) {
                const vf own = vf_min(vf_mul(vf_set1(r->blend), coc[i / 2][i % 2]), vf_set1(1));
                const vf around = vf_sub(vf_mul(vf_set1(2 / 16.0f), up[i / 2][i % 2]), own);
                coc[i / 2][i % 2] = vf_max(vf_min(around, own), vf_zero());
            }
        }
    }
    if (with_near) {
        near_up(&r->near_coc, rows, bicubic, 0, x, near_coc);
        for (int i = 0; i < 2 * rows; i++) {
            near_coc[i / 2][i % 2] = vf_mul(vf_set1(bicubic ? 1 : 1 / 16.0f), near_coc[i / 2][i % 2]);
            near = vi_or(near, vf_as_vi(near_coc[i / 2][i % 2]));
        }
        kind |= vi_any(near) ? BLEND_NEAR : 0;
    }
    return kind | BLEND_AREA;
}

// (1 - t) v + share x field; v's own bits for t = 0, which it keeps anyway if it is plain: finite and not -0.
HF_INLINE vf area_over(vf v, vf t, vf share, vf field, const int plain)
{
    const vf blended = vf_fma(share, field, vf_mul(vf_sub(vf_set1(1), t), v));
    return plain ? blended : vf_select(vf_ne(t, vf_zero()), blended, v);
}

HF_INLINE void area_blend_block(const struct composite_rows *r, const int rows, const int channels, const int kind,
                                const int bicubic, const int packed, int x, vf near_coc[2][2], vi words[2][2], vi *most,
                                struct composite_block *b)
{
    const vf sixteenth = vf_set1(1 / 16.0f);
#pragma GCC unroll 4
    for (int c = 0; c < channels; c++) {
        vf up[2][2] = {{vf_zero()}};
        for (int i = 0; i < 2 * rows && packed; i++)
            b->colour[i / 2][i % 2][c] = r11_channel(words[i / 2][i % 2], c, most);
        if (kind & BLEND_FAR)
            near_up(&r->far, rows, 0, c, x, up);
        for (int i = 0; i < 2 * rows && kind & BLEND_FAR; i++) {
            const vf t = b->coc[i / 2][i % 2];
            vf *to = &b->colour[i / 2][i % 2][c];
            *to = area_over(*to, t, vf_mul(t, sixteenth), up[i / 2][i % 2], packed);
        }
        if (kind & BLEND_NEAR)
            near_up(&r->near, rows, bicubic, c, x, up);
        for (int i = 0; i < 2 * rows && kind & BLEND_NEAR; i++) {
            vf *to = &b->colour[i / 2][i % 2][c];
            *to = area_over(*to, near_coc[i / 2][i % 2], bicubic ? vf_set1(1) : sixteenth, up[i / 2][i % 2], packed);
        }
    }
}
