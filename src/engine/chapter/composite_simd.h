// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors: what a block is blended by.
#include <float.h>

#include "engine/chapter/chapter.h"
#include "engine/chapter/inverse_vf.h"
#include "pixel/composite_vf.h"

HF_INLINE vf far_distance(vf coc, vf g, float factor)
{
    return vf_fma(vf_set1(1000 * factor), vf_abs(vf_sub(coc, g)), vf_set1(factor));
}

// Weights in proportion to 9 3 3 1 / d, d being 1 + 1000 |CoC difference|, and to what neighbours have to give, if some have
// not all. Returns how far the pixel is, 0 where it keeps its colour.
HF_INLINE vf far_weights_block(const enum hf_division division, const int some, vf coc, vf g[2][3], int row, int odd,
                               vf w[4])
{
    static const float factor[4] = {1, 3, 3, 9};
    vf d[4], most = vf_zero();
    for (int i = 0; i < 4; i++)
        d[i] = far_distance(coc, around(g, row, odd, i), factor[i]);
    const vf p01 = vf_mul(d[0], d[1]), p23 = vf_mul(d[2], d[3]);
    w[0] = vf_mul(d[1], p23);
    w[1] = vf_mul(d[0], p23);
    w[2] = vf_mul(d[3], p01);
    w[3] = vf_mul(d[2], p01);
    const vf part = some ? vf_div(vf_set1(1), vf_max(coc, vf_set1(FLT_MIN))) : vf_zero();
    for (int i = 0; i < 4 && some; i++) {
        const vf has = vf_min(vf_mul(vf_mul(vf_set1(HF_FAR_WHOLE), around(g, row, odd, i)), part), vf_set1(1));
        w[i] = vf_mul(w[i], has);
        most = vf_max(most, has);
    }
    const vf sum = vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3]));
    const vm any = vf_gt(sum, vf_set1(HF_FAR_LEAST));
    const vf inverse = some ? vf_keep(any, inverse_vf(division, sum)) : inverse_vf(division, sum);
    for (int i = 0; i < 4; i++)
        w[i] = vf_mul(w[i], inverse);
    return some ? vf_keep(any, vf_mul(coc, most)) : coc;
}

// Apart, as there are few such blocks, and the others keep more in registers without.
static __attribute__((noinline)) void far_weights_some(const enum hf_division division, const int rows, vf coc[2][2],
                                                       vf g[2][3], vf w[2][2][4], vf far[2][2])
{
    for (int i = 0; i < 2 * rows; i++)
        far[i / 2][i % 2] = far_weights_block(division, 1, coc[i / 2][i % 2], g, i / 2, i % 2, w[i / 2][i % 2]);
}

// Are the CoCs of pixels and neighbours not all the same?
HF_INLINE int far_differs(const struct field_rows *coc_rows, const int rows, int x, vf coc[2][2])
{
    vi differs = vi_xor(vf_as_vi(coc[0][0]), vf_as_vi(coc[0][1]));
    for (int i = 2; i < 2 * rows; i++)
        differs = vi_or_xor(differs, vf_as_vi(coc[0][0]), vf_as_vi(coc[i / 2][i % 2]));
    if (vi_any(differs))
        return 1;
    vf g[2][3];
    load_around(coc_rows, 0, x, g);
    for (int i = 0; i < 6; i++)
        differs = vi_or_xor(differs, vf_as_vi(coc[0][0]), vf_as_vi(g[i / 3][i % 3]));
    return vi_any(differs);
}

// Bilinear weights, in 144ths.
static const float far_even[4] = {81, 27, 27, 9};

// An estimate of 1 / 144 is not that number. So where a pixel has the CoC of its neighbours it gets the exact weights,
// whatever the other lanes of its vector hold: those past a row's end hold what an earlier frame has left there.
HF_INLINE void far_weights_same(vf coc, vf g[2][3], int row, int odd, vf w[4])
{
    vm same = vf_eq(coc, around(g, row, odd, 0));
    for (int i = 1; i < 4; i++)
        same = vm_and(same, vf_eq(coc, around(g, row, odd, i)));
    for (int i = 0; i < 4; i++)
        w[i] = vf_select(same, vf_set1(far_even[i] * (1 / 144.0f)), w[i]);
}

// Weights of the neighbours of all pixels, and how much the sums count. Where all CoCs are the same, as inside a far
// field that is fully blurred, bilinear weights are what would come out.
HF_INLINE void far_weights(const struct field_rows *coc_rows, const enum hf_division division, const int rows,
                           const int differs, int x, vf blend, vf coc[2][2], vf w[2][2][4], vf t[2][2])
{
    vf g[2][3];
    for (int i = 0; i < 2 * rows; i++) {
        vf *of = w[i / 2][i % 2];
        t[i / 2][i % 2] = vf_mul(blend, coc[i / 2][i % 2]);
        for (int k = 0; k < 4; k++)
            of[k] = vf_set1(far_even[k] * (1 / 144.0f));
    }
    if (!differs)
        return;
    load_around(coc_rows, 0, x, g);
    vm some = vf_gt(vf_zero(), vf_zero());
    const vf middle = vf_min(g[0][1], g[1][1]);
    for (int odd = 0; odd < 2; odd++) {
        const vf least = vf_mul(vf_set1(HF_FAR_WHOLE / 2), vf_min(middle, vf_min(g[0][2 * odd], g[1][2 * odd])));
        for (int row = 0; row < rows; row++)
            some = vm_or(some, vf_lt(least, coc[row][odd]));
    }
    if (vm_any(some)) {
        vf far[2][2], from[2][3];
        for (int i = 0; i < 6; i++)
            from[i / 3][i % 3] = g[i / 3][i % 3];
        far_weights_some(division, rows, coc, from, w, far);
        for (int i = 0; i < 2 * rows; i++)
            t[i / 2][i % 2] = vf_mul(blend, far[i / 2][i % 2]);
        for (int i = 0; i < 2 * rows && division != HF_DIVISION_EXACT; i++)
            far_weights_same(coc[i / 2][i % 2], g, i / 2, i % 2, w[i / 2][i % 2]);
        return;
    }
    HF_UNROLL(4)
    for (int i = 0; i < 2 * rows; i++) {
        far_weights_block(division, 0, coc[i / 2][i % 2], g, i / 2, i % 2, w[i / 2][i % 2]);
        if (division != HF_DIVISION_EXACT)
            far_weights_same(coc[i / 2][i % 2], g, i / 2, i % 2, w[i / 2][i % 2]);
    }
}

// What is blended of v: less a field it is a float. Plain: finite, not -0, and much smaller.
HF_INLINE vf blend_own(vf v, const int plain)
{
    return plain ? v : vf_min(vf_max(v, vf_set1(-HF_BLENDED)), vf_set1(HF_BLENDED));
}

// own - t rest, rest being own less what it is blended with; v's own bits for t = 0, which it keeps anyway if it is plain.
HF_INLINE vf blend_rest(vf v, vf own, vf rest, vf t, const int plain)
{
    const vf blended = vf_fnma(t, rest, own);
    return plain ? blended : vf_select(vf_ne(t, vf_zero()), blended, v);
}

// Colour less the far field; alpha's mean is over the sum of the weights, which is 1 within rounding.
HF_INLINE vf far_rest(vf own, const vf w[4], const vf v[4], const int alpha)
{
    if (!alpha) {
        for (int k = 0; k < 4; k++)
            own = vf_fnma(w[k], v[k], own);
        return own;
    }
    vf sum = vf_mul(w[0], v[0]), weight = w[0];
    for (int k = 1; k < 4; k++) {
        sum = vf_fma(w[k], v[k], sum);
        weight = vf_add(weight, w[k]);
    }
    return vf_sub(own, vf_div(sum, weight));
}

HF_INLINE void blend_far_channel(const struct field_rows *field, const int rows, int c, int x, vf w[2][2][4],
                                 vf t[2][2], const int plain, struct composite_block *b)
{
    vf v[2][3];
    load_around(field, c, x, v);
    for (int i = 0; i < 2 * rows; i++) {
        const int row = i / 2, odd = i % 2;
        vf *to = &b->colour[row][odd][c];
        const vf of[4] = {around(v, row, odd, 0), around(v, row, odd, 1), around(v, row, odd, 2),
                          around(v, row, odd, 3)};
        const vf own = blend_own(*to, plain);
        *to = blend_rest(*to, own, far_rest(own, w[row][odd], of, c == 3), t[row][odd], plain);
    }
}

// The published demo's: CoCs in reading order of the 2x2 block, which for even pixels is the one before.
HF_INLINE void blend_far_faithful(const struct composite_rows *r, const enum hf_division division, const int channels,
                                  int x, vf blend, struct composite_block *b)
{
    const float *coc[2] = {r->far_coc.row[!r->down], r->far_coc.row[r->down]};
    const float *own = r->far.row[0], *below = r->far.row[r->down];
    for (int o = 0; o < 2; o++) {
        vf d[4], w[4];
        for (int i = 0; i < 4; i++)
            d[i] = far_distance(b->coc[0][o], vf_load(coc[i >> 1] + x + (i & 1) - 1 + o), 1);
        const vf p01 = vf_mul(d[0], d[1]), p23 = vf_mul(d[2], d[3]);
        w[0] = vf_mul(d[1], p23);
        w[1] = vf_mul(d[0], p23);
        w[2] = vf_mul(d[3], p01);
        w[3] = vf_mul(d[2], p01);
        const vf inverse = inverse_vf(division, vf_add(vf_add(w[0], w[1]), vf_add(w[2], w[3])));
        for (int i = 0; i < 4; i++)
            w[i] = vf_mul(w[i], inverse);
        for (int c = 0; c < channels; c++) {
            const float *p = own + c * r->far.plane + x, *q = below + c * r->far.plane + x;
            const vf of[4] = {vf_load(p), vf_load(p + o), vf_load(q), vf_load(q + o)};
            vf *to = &b->colour[0][o][c];
            const vf colour = blend_own(*to, 0);
            *to = blend_rest(*to, colour, far_rest(colour, w, of, c == 3), vf_mul(blend, b->coc[0][o]), 0);
        }
    }
}

// Of the far field also whether CoCs differ.
enum { BLEND_FAR_DIFFERS = BLEND_OWN, HOW_FAITHFUL = HOW_OWN, HOW_DIVISION = 2 * HOW_OWN };

HF_INLINE int blend_kind(const struct composite_rows *r, const int rows, int with_far, int with_near, const int bicubic,
                         int x, vf coc[2][2], vf near_coc[2][2])
{
    int kind = 0;
    if (with_far && blend_has_far(rows, coc))
        kind = far_differs(&r->far_coc, rows, x, coc) ? BLEND_FAR | BLEND_FAR_DIFFERS : BLEND_FAR;
    if (with_near && blend_has_near(r, rows, bicubic, r->blend, x, near_coc))
        kind |= BLEND_NEAR;
    return kind;
}

HF_INLINE void blend_block(const struct composite_rows *r, const int rows, const int channels, const int kind,
                           const int how, int x, vf near_coc[2][2], vi words[2][2], vi *most, struct composite_block *b)
{
    const int far = kind & BLEND_FAR, near = kind & BLEND_NEAR, faithful = how & HOW_FAITHFUL;
    const int bicubic = how & HOW_BICUBIC, packed = how & HOW_PACKED;
    const enum hf_division division = (enum hf_division)(how / HOW_DIVISION);
    vf w[2][2][4] = {{{vf_zero()}}}, t[2][2] = {{vf_zero()}};
    if (far && !faithful)
        far_weights(&r->far_coc, division, rows, kind & BLEND_FAR_DIFFERS, x, vf_set1(r->blend), b->coc, w, t);
    if (far && faithful)
        blend_far_faithful(r, division, channels, x, vf_set1(r->blend), b);
    HF_UNROLL(4)
    for (int c = 0; c < channels; c++) {
        vf up[2][2] = {{vf_zero()}};
        if (near)
            near_up(&r->near, rows, bicubic, c, x, up);
        for (int i = 0; i < 2 * rows && packed; i++)
            b->colour[i / 2][i % 2][c] = r11_channel(words[i / 2][i % 2], c, most);
        if (far && !faithful)
            blend_far_channel(&r->far, rows, c, x, w, t, packed, b);
        for (int i = 0; i < 2 * rows && near; i++) {
            vf *to = &b->colour[i / 2][i % 2][c];
            const vf own = blend_own(*to, packed);
            const vf rest = vf_fnma(vf_set1(bicubic ? 1 : 1 / 16.0f), up[i / 2][i % 2], own);
            *to = blend_rest(*to, own, rest, near_coc[i / 2][i % 2], packed);
        }
    }
}

HF_INLINE int composite_how(const struct hf_setup *s)
{
    return (int)hf_chapter(s)->division * HOW_DIVISION + (hf_chapter(s)->faithful ? HOW_FAITHFUL : 0) +
           (hf_fields(s)->bicubic ? HOW_BICUBIC : 0);
}

HF_INLINE float composite_gain(const struct hf_setup *s)
{
    return hf_fields(s)->blend;
}

HF_INLINE float composite_square(const struct hf_setup *s)
{
    (void)s;
    return 0;
}

enum {
    COMPOSITE_FAR = HF_BUF_FAR_FILL,
    COMPOSITE_FAR_COC = HF_BUF_COC4,
    COMPOSITE_FAR_CHANNEL = 1,
    COMPOSITE_NEAR = HF_BUF_NEAR_FILL,
    COMPOSITE_NEAR_COC = HF_BUF_BLUR,
};
#include "pixel/composite_simd.inc"

COMPOSITE_RUN(0, 0, 0)
COMPOSITE_RUN(1, 1, 0)
COMPOSITE_RUN(2, 2, 0)
COMPOSITE_RUN(3, 3, 0)
COMPOSITE_RUN(6, 6, 0)
COMPOSITE_RUN(7, 7, 0)
COMPOSITE_RUN(6_any, 6, composite_how(s))
COMPOSITE_RUN(7_any, 7, composite_how(s))

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    static composite_run_of_kind *const run[2][8] = {{composite_run_0, composite_run_1, composite_run_2,
                                                      composite_run_3, NULL, NULL, composite_run_6, composite_run_7},
                                                     {composite_run_0, composite_run_1, composite_run_2,
                                                      composite_run_3, NULL, NULL, composite_run_6_any,
                                                      composite_run_7_any}};
    composite_fields(f, r, hf_chapter(f->s)->faithful ? NULL : run[hf_chapter(f->s)->division != HF_DIVISION_EXACT]);
}
