// SPDX-License-Identifier: BSD-3-Clause
// Composite on vectors. Even and odd pixels are lanes of their own, so the four phases of the upsampling are four
// pieces of plain arithmetic over the same half-resolution loads; both phases in x are made together and share them.
// So do two rows of the picture that lie between the same two half-resolution rows, where they can be made together.
#include <float.h>

#include "pixel/depth_rows.h"
#include "engine/gather/gather.h"
#include "engine/gather/inverse_vf.h"
#include "pixel/coc_vf.h"

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
    float blend;
    int down;  // the neighbour row is the one below
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

// Weights of the neighbours of all pixels, and how much the sums count. Where all CoCs are the same, as inside a far
// field that is fully blurred, bilinear weights are what would come out.
HF_INLINE void far_weights(const struct field_rows *coc_rows, const enum hf_division division, const int rows,
                           const int differs, int x, vf blend, vf coc[2][2], vf w[2][2][4], vf t[2][2])
{
    vf g[2][3];
    const float inverse = 1 / 144.0f;
    for (int i = 0; i < 2 * rows; i++) {
        vf *of = w[i / 2][i % 2];
        t[i / 2][i % 2] = vf_mul(blend, coc[i / 2][i % 2]);
        of[0] = vf_set1(81 * inverse);
        of[1] = of[2] = vf_set1(27 * inverse);
        of[3] = vf_set1(9 * inverse);
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
        return;
    }
#pragma GCC unroll 4
    for (int i = 0; i < 2 * rows; i++)
        far_weights_block(division, 0, coc[i / 2][i % 2], g, i / 2, i % 2, w[i / 2][i % 2]);
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

// What there is to blend; of the near field there is the CoC too.
enum { BLEND_NEAR = 1, BLEND_FAR = 2, BLEND_FAR_DIFFERS = 4, BLEND_AREA = 8 };

HF_INLINE int blend_kind(const struct composite_rows *r, const int rows, int with_far, int with_near, const int bicubic,
                         int x, vf coc[2][2], vf near_coc[2][2])
{
    int kind = 0;
    vi far = vi_set1(0), near = vi_set1(0);
    if (with_far) {
        for (int i = 0; i < 2 * rows; i++)
            far = vi_or(far, vf_as_vi(coc[i / 2][i % 2]));
        if (vi_any(far))
            kind = far_differs(&r->far_coc, rows, x, coc) ? BLEND_FAR | BLEND_FAR_DIFFERS : BLEND_FAR;
    }
    if (with_near) {
        near_up(&r->near_coc, rows, bicubic, 0, x, near_coc);
        for (int i = 0; i < 2 * rows; i++) {
            near_coc[i / 2][i % 2] = vf_mul(vf_set1(r->blend * (bicubic ? 1 : 1 / 16.0f)), near_coc[i / 2][i % 2]);
            near = vi_or(near, vf_as_vi(near_coc[i / 2][i % 2]));
        }
        kind |= vi_any(near) ? BLEND_NEAR : 0;
    }
    return kind;
}

// Blends a block, of which words are the R11G11B10F words if it is packed: then colours are made here, as late as they
// are needed, and *most is the bits of the largest sample, see r11_unpack.
HF_INLINE void blend_block(const struct composite_rows *r, const enum hf_division division, const int rows,
                           const int channels, const int kind, const int faithful, const int bicubic, const int packed,
                           int x, vf near_coc[2][2], vi words[2][2], vi *most, struct composite_block *b)
{
    const int far = kind & BLEND_FAR, near = kind & BLEND_NEAR;
    vf w[2][2][4] = {{{vf_zero()}}}, t[2][2] = {{vf_zero()}};
    if (far && !faithful)
        far_weights(&r->far_coc, division, rows, kind & BLEND_FAR_DIFFERS, x, vf_set1(r->blend), b->coc, w, t);
    if (far && faithful)
        blend_far_faithful(r, division, channels, x, vf_set1(r->blend), b);
#pragma GCC unroll 4
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

#include "engine/gather/area_composite_simd.inc"

// ---- through lines: everything there is, row by row ----

// Lanes of a row that have been read: the picture, even and odd, channel by channel, `line` floats apart; overwritten.
// Far CoC: even, then odd.
struct composite_line {
    int first, n;
    float *even, *odd;
    const float *coc;
    ptrdiff_t line;
};

HF_INLINE void composite_lines(const struct composite_rows *rows, const struct composite_line *lines,
                               const enum hf_division division, const int channels, const int far, const int near,
                               const int faithful, const int bicubic, const int area)
{
    const struct composite_rows r = *rows;  // see field_rows
    const struct composite_line l = *lines;
    for (int x = 0; x < l.n; x += VF_N) {
        struct composite_block b;
        vf near_coc[2][2] = {{vf_zero()}};
        for (int o = 0; o < 2; o++)
            b.coc[0][o] = vf_load(l.coc + o * l.line + x);
        const int kind = area ? area_blend_kind(&r, 1, far, near, bicubic, l.first + x, b.coc, near_coc)
                              : blend_kind(&r, 1, far, near, bicubic, l.first + x, b.coc, near_coc);
        if (!(kind & (BLEND_FAR | BLEND_NEAR)))
            continue;
        for (int c = 0; c < channels; c++) {
            b.colour[0][0][c] = vf_load(l.even + c * l.line + x);
            b.colour[0][1][c] = vf_load(l.odd + c * l.line + x);
        }
        if (area)
            area_blend_block(&r, 1, channels, kind, bicubic, 0, l.first + x, near_coc, NULL, NULL, &b);
        else
            blend_block(&r, division, 1, channels, kind, faithful, bicubic, 0, l.first + x, near_coc, NULL, NULL, &b);
        for (int c = 0; c < channels; c++) {
            vf_store(l.even + c * l.line + x, b.colour[0][0][c]);
            vf_store(l.odd + c * l.line + x, b.colour[0][1][c]);
        }
    }
}

// Options become constants, so that no pixel asks for them.
HF_INLINE void composite_options(const struct composite_rows *r, const struct composite_line *l,
                                 const struct hf_setup *s, int far, int near, const int channels)
{
    const enum hf_division division = hf_gather(s)->division;
    if (hf_gather(s)->area && hf_gather(s)->bicubic)
        composite_lines(r, l, HF_DIVISION_EXACT, channels, far, near, 0, 1, 1);
    else if (hf_gather(s)->area)
        composite_lines(r, l, HF_DIVISION_EXACT, channels, far, near, 0, 0, 1);
    else if (s->faithful || hf_gather(s)->bicubic || division != HF_DIVISION_EXACT)
        composite_lines(r, l, division, channels, far, near, s->faithful, hf_gather(s)->bicubic, 0);
    else if (far && near)
        composite_lines(r, l, HF_DIVISION_EXACT, channels, 1, 1, 0, 0, 0);
    else if (far)
        composite_lines(r, l, HF_DIVISION_EXACT, channels, 1, 0, 0, 0, 0);
    else
        composite_lines(r, l, HF_DIVISION_EXACT, channels, 0, 1, 0, 0, 0);
}

// Row y of rectangle r, from its lane `first` on.
static void composite_row_lines(const struct hf_frame *f, const struct composite_rows *rows, int y, struct hf_rect r,
                                int first)
{
    const struct hf_setup *s = f->s;
    const int x0 = r.x0 + first, n = r.x1 - x0;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, x0, y, n, lane[0], lane[1], f->counts);
    if (f->far)
        f->k->coc_row(f, x0, y, n, coc, NULL);
    const struct composite_line l = {first, n, lane[0][0], lane[1][0], coc[2], (ptrdiff_t)f->line_floats};
    if (s->channels == 3)
        composite_options(rows, &l, s, f->far, f->near, 3);
    else
        composite_options(rows, &l, s, f->far, f->near, 4);
    hf_store_rgb(f, lane[0], n);
    hf_store_rgb(f, lane[1], n);
    if (s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    hf_store_colour(f, x0, y, n, (const float *const *)lane[0], (const float *const *)lane[1]);
}

// ---- in registers: R11G11B10F to R11G11B10F, two rows at once ----

// Rows of pixels from lane 0 on.
struct packed_rows {
    const uint8_t *from[2], *depth[2];
    uint8_t *to[2];
    const float *coc[2];  // far CoC if it has been made: even, then odd
    ptrdiff_t from_stride, depth_stride, to_stride, line;
    int far, near;  // the fields there are
};

// 2 VF_N pixels of the row after next: a tile's rows are too short for hardware prefetchers to catch on.
#define FETCH_AHEAD(p, stride, write)                                                                                  \
    for (int k_ = 0; k_ < 8 * VF_N; k_ += 64)                                                                          \
    __builtin_prefetch((const uint8_t *)((uintptr_t)(p) + (uintptr_t)(2 * (stride))) + k_, write)

// Far CoC of 2 VF_N pixels from their distances. Returns lanes that are no number.
HF_INLINE vm far_coc(const struct hf_setup *s, const uint8_t *depth, vf coc[2])
{
    vf d[2];
    vf_unzip(vf_load(depth), vf_load(depth + 4 * VF_N), &d[0], &d[1]);
    for (int o = 0; o < 2; o++) {
        vm none;
        coc[o] = coc_far(s, coc_variable(s, HF_FORM_Z, d[o], vf_zero(), vf_zero(), &none));
    }
    return vf_unordered(d[0], d[1]);
}

// Lanes from x on that are all of one kind. Returns the first that is not, or n: all inside the picture, a multiple of
// VF_N. *next: its kind, or -1 where a sample is not finite. One loop for each kind: in one for all the compiler has
// more constants and more ways to meet than registers, and what is live goes through memory.
HF_INLINE int composite_run(const struct composite_rows *rows, const struct packed_rows *packed,
                            const struct hf_setup *s, const enum hf_division division, const int kind, int x, int n,
                            int *next, vi *clamped)
{
    const struct composite_rows r = *rows;  // see field_rows
    const struct packed_rows p = *packed;
    const int with_far = kind & BLEND_FAR || p.far, with_near = kind & BLEND_NEAR || p.near;
    for (; x < n; x += VF_N) {
        const size_t at = (size_t)x * 8;
        struct composite_block b;
        vf near_coc[2][2] = {{vf_zero()}}, in[2][2];
        vi words[2][2], most = vi_set1(0);
        vm bad = vf_gt(vf_zero(), vf_zero());
        for (int i = 0; i < 2; i++) {
            if (with_far && p.coc[i]) {
                b.coc[i][0] = vf_load(p.coc[i] + x);
                b.coc[i][1] = vf_load(p.coc[i] + p.line + x);
            } else if (with_far) {
                FETCH_AHEAD(p.depth[i] + at, p.depth_stride, 0);
                bad = vm_or(bad, far_coc(s, p.depth[i] + at, b.coc[i]));
            }
        }
        const int is = kind & BLEND_AREA ? area_blend_kind(&r, 2, with_far, with_near, 0, x, b.coc, near_coc)
                                         : blend_kind(&r, 2, with_far, with_near, 0, x, b.coc, near_coc);
        if (is != kind) {
            *next = is;
            return x;
        }
        for (int i = 0; i < 2; i++) {
            FETCH_AHEAD(p.from[i] + at, p.from_stride, 0);
            FETCH_AHEAD(p.to[i] + at, p.to_stride, 1);
            in[i][0] = vf_load(p.from[i] + at);
            in[i][1] = vf_load(p.from[i] + at + 4 * VF_N);
            vf even, odd;
            vf_unzip(in[i][0], in[i][1], &even, &odd);
            words[i][0] = vf_as_vi(even);
            words[i][1] = vf_as_vi(odd);
        }
        if (kind & BLEND_AREA)
            area_blend_block(&r, 2, 3, kind, 0, 1, x, near_coc, words, &most, &b);
        else
            blend_block(&r, division, 2, 3, kind, 0, 0, 1, x, near_coc, words, &most, &b);
        if (vm_any(vm_or(bad, vm_not(vi_le(most, vi_set1((31 << 23) - 1)))))) {
            *next = -1;
            return x;
        }
        for (int i = 0; i < 2; i++) {
            if (!(kind & ~BLEND_AREA)) {
                vf_store(p.to[i] + at, in[i][0]);
                vf_store(p.to[i] + at + 4 * VF_N, in[i][1]);
                continue;
            }
            if (s->storage == HF_STORAGE_PACKED) {
                vf_zip(vi_as_vf(r11_pack_cut(b.colour[i][0])), vi_as_vf(r11_pack_cut(b.colour[i][1])), &in[i][0],
                       &in[i][1]);
                vf_store(p.to[i] + at, in[i][0]);
                vf_store(p.to[i] + at + 4 * VF_N, in[i][1]);
                continue;
            }
            store_block(HF_FORMAT_R11G11B10F, p.to[i] + at, b.colour[i][0], b.colour[i][1], clamped + i);
        }
    }
    return n;
}

typedef int composite_run_of_kind(const struct composite_rows *rows, const struct packed_rows *packed,
                                  const struct hf_setup *s, int x, int n, int *next, vi *clamped);

#define COMPOSITE_RUN(name, kind, division)                                                                            \
    static __attribute__((noinline)) int composite_run_##name(                                                         \
        const struct composite_rows *rows, const struct packed_rows *packed, const struct hf_setup *s, int x, int n,   \
        int *next, vi *clamped)                                                                                        \
    {                                                                                                                  \
        return composite_run(rows, packed, s, division, kind, x, n, next, clamped);                                    \
    }
COMPOSITE_RUN(0, 0, HF_DIVISION_EXACT)
COMPOSITE_RUN(1, 1, HF_DIVISION_EXACT)
COMPOSITE_RUN(2, 2, HF_DIVISION_EXACT)
COMPOSITE_RUN(3, 3, HF_DIVISION_EXACT)
COMPOSITE_RUN(6, 6, HF_DIVISION_EXACT)
COMPOSITE_RUN(7, 7, HF_DIVISION_EXACT)
COMPOSITE_RUN(6_any, 6, hf_gather(s)->division)
COMPOSITE_RUN(7_any, 7, hf_gather(s)->division)
COMPOSITE_RUN(8, 8, HF_DIVISION_EXACT)
COMPOSITE_RUN(9, 9, HF_DIVISION_EXACT)
COMPOSITE_RUN(10, 10, HF_DIVISION_EXACT)
COMPOSITE_RUN(11, 11, HF_DIVISION_EXACT)

// n lanes. Returns how many of them were done: all, or those before a sample that is not finite.
static int composite_packed(const struct composite_rows *rows, const struct packed_rows *packed,
                            const struct hf_setup *s, int n, vi *clamped)
{
    static composite_run_of_kind *const run[2][12] = {
        {composite_run_0, composite_run_1, composite_run_2, composite_run_3, NULL, NULL, composite_run_6,
         composite_run_7, composite_run_8, composite_run_9, composite_run_10, composite_run_11},
        {composite_run_0, composite_run_1, composite_run_2, composite_run_3, NULL, NULL, composite_run_6_any,
         composite_run_7_any}};
    const int any = !hf_gather(s)->area && hf_gather(s)->division != HF_DIVISION_EXACT;
    int x = 0, kind = hf_gather(s)->area ? BLEND_AREA : 0;
    while (x < n && kind >= 0)
        x = run[any][kind](rows, packed, s, x, n, &kind, clamped);
    return x;
}

// What can be done in registers of the rows y[0] and y[1] of rectangle r, or of one of them alone, then the other is
// -1. Returns how many lanes, the rest goes through lines.
static int composite_rows_packed(const struct hf_frame *f, const struct composite_rows *rows, const int y[2],
                                 struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int x0 = r.x0, pixels = hf_min(2 * r.x1, s->width) - 2 * x0, n = pixels / 2 / VF_N * VF_N;
    const ptrdiff_t line = (ptrdiff_t)f->line_floats;
    struct packed_rows p = {.from_stride = f->src->stride[0],
                            .depth_stride = f->depth->stride,
                            .to_stride = f->dst->stride[0],
                            .line = line,
                            .far = f->far,
                            .near = f->near};
    for (int i = 0; i < 2; i++) {
        const int at = y[i] < 0 ? y[!i] : y[i];  // what is not there is made from the other row, and thrown away
        p.from[i] = plane_at(f->src, 0, 4, x0, at);
        p.depth[i] = f->far && s->form == HF_FORM_Z ? hf_depth_row(f, 2 * x0, at, 2 * n, i) : NULL;
        p.to[i] = y[i] < 0 ? (uint8_t *)hf_line(f, 0) : plane_at(f->dst, 0, 4, x0, at);
        // In place, a sample that is not finite wants neighbours that have not been overwritten.
        if (p.from[i] == p.to[i] && !f->repaired && !f->k->finite_r11(p.from[i], (size_t)pixels, NULL))
            return 0;
        if (f->far && s->form != HF_FORM_Z) {
            float *const coc[4] = {hf_line(f, 8), hf_line(f, 9), hf_line(f, 10 + 2 * i), hf_line(f, 11 + 2 * i)};
            f->k->coc_row(f, x0, at, n, coc, NULL);
            p.coc[i] = coc[2];
        }
    }
    vi clamped[2] = {vi_set1(0), vi_set1(0)};
    const int done = composite_packed(rows, &p, s, n, clamped);
    for (int i = 0; i < 2; i++)
        if (y[i] >= 0)
            f->counts->clamped += vi_sum(clamped[i]);
    return done;
}

// ---- rows ----

static struct field_rows field_at(const struct hf_buf *b, int c, int x, int y, int next_y)
{
    return (struct field_rows){{hf_at(b, c, x, y), hf_at(b, c, x, next_y)}, b->ch[1] - b->ch[0]};
}

// The fields around row y of the picture.
static struct composite_rows composite_rows_at(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int down = y & 1, hy = (y - down) / 2, ny = down ? hy + 1 : hy - 1;
    struct composite_rows rows = {.blend = hf_gather(f->s)->blend, .down = down};
    if (hf_gather(f->s)->area) {
        rows.blend = hf_gather_levels(f->s, HF_FAR)->gain;
        rows.far = field_at(&f->buf[HF_BUF_FAR], 0, r.x0, hy, ny);
        rows.far_coc = field_at(&f->buf[HF_BUF_FAR_PART], 0, r.x0, hy, ny);
        rows.near = field_at(&f->buf[HF_BUF_NEAR], 0, r.x0, hy, ny);
        rows.near_coc = field_at(&f->buf[HF_BUF_COVER], 0, r.x0, hy, ny);
        return rows;
    }
    if (f->far) {
        rows.far = field_at(&f->buf[HF_BUF_FAR_FILL], 0, r.x0, hy, ny);
        rows.far_coc = field_at(&f->buf[HF_BUF_COC4], 1, r.x0, hy, ny);
    }
    if (f->near) {
        rows.near = field_at(&f->buf[HF_BUF_NEAR_FILL], 0, r.x0, hy, ny);
        rows.near_coc = field_at(&f->buf[HF_BUF_BLUR], 0, r.x0, hy, ny);
    }
    return rows;
}

static void composite_row_rest(const struct hf_frame *f, int y, struct hf_rect r, int first)
{
    const struct hf_setup *s = f->s;
    struct composite_rows rows = composite_rows_at(f, y, r);
    if (f->near && hf_gather(s)->bicubic) {
        const int area = hf_gather(s)->area;
        for (int c = 0; c < s->channels; c++)
            near_line(&f->buf[area ? HF_BUF_NEAR : HF_BUF_NEAR_FILL], c, y, r, hf_line(f, 12 + c));
        near_line(&f->buf[area ? HF_BUF_COVER : HF_BUF_BLUR], 0, y, r, hf_line(f, 16));
        rows.near = (struct field_rows){{hf_line(f, 12) + 16}, (ptrdiff_t)f->line_floats};
        rows.near_coc = (struct field_rows){{hf_line(f, 16) + 16}, 0};
    }
    composite_row_lines(f, &rows, y, r, first);
}

static void composite_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int end = hf_min(2 * r.y1, f->s->height);
    const int packs = f->src->format == HF_FORMAT_R11G11B10F && f->dst->format == HF_FORMAT_R11G11B10F &&
                      f->s->storage != HF_STORAGE_HALF && !f->s->faithful && !hf_gather(f->s)->bicubic &&
                      !f->s->highlight.on && !f->s->part;
    // Rows 2 k - 1 and 2 k lie between the half-resolution rows k - 1 and k.
    for (int k = r.y0; 2 * k <= end && !hf_stopped(f->s->stop); k++) {
        const int y[2] = {k > r.y0 ? 2 * k - 1 : -1, 2 * k < end ? 2 * k : -1};
        int done = 0;
        if (packs) {
            const struct composite_rows rows = composite_rows_at(f, 2 * k - 1, r);
            done = composite_rows_packed(f, &rows, y, r);
        }
        for (int i = 0; i < 2 && done < r.x1 - r.x0; i++)
            if (y[i] >= 0)
                composite_row_rest(f, y[i], r, done);
    }
}
