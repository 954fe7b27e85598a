// SPDX-License-Identifier: BSD-3-Clause
// What Composite on vectors is made of. Even and odd pixels are lanes of their own, so the four phases of the upsampling are
// four pieces of plain arithmetic over the same half-resolution loads; both phases in x are made together and share them.
// So do two rows of the picture that lie between the same two half-resolution rows, where they can be made together.
#ifndef HF_COMPOSITE_VF_H
#define HF_COMPOSITE_VF_H

#include "pixel/coc_vf.h"
#include "pixel/depth_rows.h"
#include "pixel/fields.h"

// Two half-resolution rows, at lane 0: the one that the first row of the picture belongs to, and its neighbour, to
// which the second row belongs if there is one. Channels lie a fixed distance apart, so that a few registers address
// them all; vector stores may alias anything, and pointers kept in memory would be read again after each.
struct field_rows {
    const float *row[2];
    ptrdiff_t plane;
};

// What rows of the composite are made from.
struct composite_rows {
    struct field_rows far, far_coc;
    struct field_rows near, near_coc;  // for the cubic in lines: interpolated in y, and without neighbours
    float blend, square;               // of the engine: composite_gain, composite_square
    int down;                          // the neighbour row is the one below
};

// Colours and far CoC of 2 VF_N pixels of a row or two: even, odd.
struct composite_block {
    vf colour[2][2][4];
    vf coc[2][2];
};

// A neighbourhood in a plane: both rows, columns before, at and after. With registers enough, each is loaded once.
HF_INLINE void load_around(const struct field_rows *f, int c, int x, vf v[2][3])
{
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            v[i][k] = vf_load(f->row[i] + c * f->plane + x + k - 1);
            if (VF_N == 16)
                v[i][k] = vf_once(v[i][k]);
        }
}

// Of the pixel's four neighbours in there: own, beside, next, and next beside.
HF_INLINE vf around(vf v[2][3], int row, int odd, int i)
{
    return v[i < 2 ? row : !row][i % 2 == 0 ? 1 : odd ? 2 : 0];
}

HF_INLINE vf cubic_vf(vf own, vf neighbour, vf other, vf behind)
{
    vf v = vf_mul(vf_set1(CUBIC_NEIGHBOUR), vf_sub(neighbour, own));
    v = vf_fma(vf_set1(CUBIC_OTHER), vf_sub(other, own), v);
    v = vf_fma(vf_set1(CUBIC_BEHIND), vf_sub(behind, own), v);
    return vf_add(own, v);
}

// A row of the near field interpolated in y by the cubic, from 16 columns before x0, so that loads are aligned, to two
// behind its end.
static void near_line(const struct hf_buf *b, int c, int y, struct hf_rect r, float *out)
{
    const int hy = y / 2, step = y & 1 ? 1 : -1, x0 = r.x0 - 16, n = r.x1 - x0 + 2;
    const float *own = hf_at(b, c, x0, hy), *next = hf_at(b, c, x0, hy + step);
    const float *other = hf_at(b, c, x0, hy - step), *behind = hf_at(b, c, x0, hy + 2 * step);
    for (int x = 16 - VF_N; x < n; x += VF_N)
        vf_store(out + x, cubic_vf(vf_load(own + x), vf_load(next + x), vf_load(other + x), vf_load(behind + x)));
}

// Sixteen times channel c of the near field at even and odd pixels of a row or two, in x first, which both rows share.
// Thrice a number and itself are four times it, rounded or not: constants stay exact. The cubic: once.
HF_INLINE void near_up(const struct field_rows *f, const int rows, const int bicubic, int c, int x, vf up[2][2])
{
    if (bicubic) {
        const float *p = f->row[0] + c * f->plane + x;
        const vf v = vf_load(p), before = vf_load(p - 1), after = vf_load(p + 1);
        up[0][0] = cubic_vf(v, before, after, vf_load(p - 2));
        up[0][1] = cubic_vf(v, after, before, vf_load(p + 2));
        return;
    }
    const vf three = vf_set1(3);
    vf v[2][3];
    load_around(f, c, x, v);
    for (int odd = 0; odd < 2; odd++) {
        const vf a = vf_fma(three, v[0][1], v[0][2 * odd]), b = vf_fma(three, v[1][1], v[1][2 * odd]);
        up[0][odd] = vf_fma(three, a, b);
        if (rows == 2)
            up[1][odd] = vf_fma(three, b, a);
    }
}

// What there is to blend; the engine may have kinds of its own.
enum { BLEND_NEAR = 1, BLEND_FAR = 2, BLEND_OWN = 4 };
// How: the near field by the cubic; colour straight from R11G11B10F; and the engine's options.
enum { HOW_BICUBIC = 1, HOW_PACKED = 2, HOW_OWN = 4 };

// Is there anything of the near field? In *near_coc the sums of its CoC, times scale.
HF_INLINE int blend_has_near(const struct composite_rows *r, const int rows, const int bicubic, float scale, int x,
                             vf near_coc[2][2])
{
    vi near = vi_set1(0);
    near_up(&r->near_coc, rows, bicubic, 0, x, near_coc);
    for (int i = 0; i < 2 * rows; i++) {
        near_coc[i / 2][i % 2] = vf_mul(vf_set1(scale * (bicubic ? 1 : 1 / 16.0f)), near_coc[i / 2][i % 2]);
        near = vi_or(near, vf_as_vi(near_coc[i / 2][i % 2]));
    }
    return vi_any(near);
}

// And of far CoC?
HF_INLINE int blend_has_far(const int rows, vf coc[2][2])
{
    vi far = vi_set1(0);
    for (int i = 0; i < 2 * rows; i++)
        far = vi_or(far, vf_as_vi(coc[i / 2][i % 2]));
    return vi_any(far);
}

#endif
