// SPDX-License-Identifier: BSD-3-Clause
// Scatter's first and last steps on vectors. Nothing is fused: this engine has the same bits everywhere.
#ifndef HF_SCATTER_COMPOSITE_SIMD_H
#define HF_SCATTER_COMPOSITE_SIMD_H

#include "pixel/pass_c.h"
#include "engine/scatter/kernels.h"
#include "engine/scatter/walk.h"
#include "simd/simd.h"

// Bits of the exponents of v >= 0, 0 for 0, as exponent_bit() in composite.c. 1 << k is computed by converting 2^k to
// an integer.
HF_INLINE vi scatter_exponent_bits(vf v)
{
    const vi bits = vf_as_vi(vf_min(v, vf_set1(0x1p120f)));
    const vi power = vi_add(vi_and(vi_shr(bits, 3), vi_set1(0x0f800000)), vi_set1(0x3f800000));
    return vf_to_vi(vf_keep(vf_gt(v, vf_zero()), vi_as_vf(power)));
}

static void scatter_note_simd(const float *radius, float *const colour[4], int channels, int n,
                              struct hf_counts *counts)
{
    const int whole = n / VF_N * VF_N;
    vf most[2] = {vf_zero(), vf_zero()};
    vi other = vi_set1(0), bits[2] = {other, other};
    for (int x = 0; x < whole; x += VF_N) {
        const vm drawn = vf_ne(vf_load(radius + x), vf_zero());
        for (int c = 0; c < channels; c++) {
            const vf v = vf_keep(drawn, vf_abs(vf_load(colour[c] + x)));
            most[c == 3] = vf_max(v, most[c == 3]);
            bits[c == 3] = vi_or(bits[c == 3], scatter_exponent_bits(v));
        }
        if (channels == 4)
            other = vi_count(other, vf_ne(vf_load(colour[3] + x), vf_set1(1)));
    }
    float lane[VF_N];
    for (int k = 0; k < 2; k++) {
        vf_store(lane, most[k]);
        for (int i = 0; i < VF_N; i++)
            counts->largest[k] = lane[i] > counts->largest[k] ? lane[i] : counts->largest[k];
        vi_store(lane, bits[k]);
        const uint32_t *bit = (const uint32_t *)(const void *)lane;
        for (int i = 0; i < VF_N; i++)
            counts->exponents[k] |= bit[i];
    }
    counts->transparent += vi_sum(other);
    float *const rest[4] = {colour[0] + whole, colour[1] + whole, colour[2] + whole,
                            channels == 4 ? colour[3] + whole : NULL};
    hf_scatter_note_c(radius + whole, rest, channels, n - whole, counts);
}

HF_INLINE vf scatter_mix(vf a, vf b, vf t)
{
    const vf v = vf_add(a, vf_mul(t, vf_sub(b, a)));
    return vf_select(vf_lt(t, vf_set1(1)), vf_select(vf_eq(t, vf_zero()), a, v), b);
}

// As hf_field_colour() in walk.h.
HF_INLINE vf scatter_field_colour(const struct hf_scatter *t, vf own, vf sum, vf weight)
{
    const vf part = vf_mul(weight, vf_set1(t->trust));
    const vf v = scatter_mix(own, vf_div(sum, weight), vf_smoothstep(vf_saturate(part)));
    return vf_select(vf_gt(weight, vf_zero()), v, own);
}

HF_INLINE vf scatter_segment(vf d)
{
    const vf t = vf_select(vf_lt(d, vf_set1(1)), d, vf_set1(1)), q = vf_mul(t, t);
    const vf inner = vf_sub(vf_set1(-0.10610f), vf_mul(q, vf_set1(0.03052f)));
    return vf_add(vf_set1(0.5f), vf_mul(t, vf_add(vf_set1(0.63662f), vf_mul(q, inner))));
}

// As inside() in composite.c.
HF_INLINE vf scatter_inside(const struct hf_setup *s, vf reach_x, vf reach_y, vf px, int y)
{
    const vf ix = vf_div(vf_set1(1), reach_x), iy = vf_div(vf_set1(1), reach_y), half = vf_set1(0.5f);
    const vf left = vf_mul(vf_add(px, half), ix);
    const vf right = vf_mul(vf_sub(vf_sub(vf_set1((float)s->width), px), half), ix);
    const vf above = vf_mul(vf_set1((float)y + 0.5f), iy), below = vf_mul(vf_set1((float)(s->height - y) - 0.5f), iy);
    return vf_mul(vf_sub(vf_add(scatter_segment(left), scatter_segment(right)), vf_set1(1)),
                  vf_sub(vf_add(scatter_segment(above), scatter_segment(below)), vf_set1(1)));
}

static void scatter_blend_simd(const struct hf_scatter_row *row, float *out)
{
    static const float steps[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const struct hf_scatter *t = hf_scatter(row->setup);
    const vf zero = vf_zero(), one = vf_set1(1), scale_x = vf_set1(t->aperture.key.scale_x);
    for (int x = 0; x < row->n; x += VF_N) {
        const vf bright = vf_load(out + x), own = vf_mul(bright, vf_set1(t->dim));
        const vf r = vf_load(row->radius + x), size = vf_abs(r);
        const vf fade = vf_mul(vf_sub(vf_set1(t->fade), size), vf_set1(t->fade_slope));
        const vf show = vf_saturate(fade);
        vf v = own, far = zero, near = zero, front = own;
        if (row->far) {
            far = vf_load(row->far_weight + x);
            v = scatter_field_colour(t, own, vf_load(row->far + x), far);
        }
        if (row->near) {
            near = vf_load(row->near_weight + x);
            front = scatter_field_colour(t, own, vf_load(row->near + x), near);
        }
        const vm is_near = vf_lt(r, zero);
        vf cover = near, back = show;
        if (row->near) {
            const vf px = row->column ? vf_load(row->column + x) : vf_add(vf_set1((float)(row->x + x)), vf_load(steps));
            const vf part = scatter_inside(row->setup, vf_mul(size, scale_x), size, px, row->y);
            cover = vf_select(is_near, vf_div(near, part), near);
            const vf left = vf_sub(one, cover);
            back = vf_select(is_near, vf_select(vf_lt(show, left), vf_div(show, left), one), show);
        }
        const vf reached = vf_mul(vf_set1(16), far);
        const vf hidden = row->behind ? vf_load(row->behind + x) : scatter_mix(front, v, vf_saturate(reached));
        v = vf_select(is_near, hidden, v);
        v = scatter_mix(own, v, vf_sub(one, back));
        if (row->near)
            v = vf_select(vf_gt(near, zero), scatter_mix(v, front, cover), v);
        v = vf_max(vf_min(v, vf_set1(t->most)), vf_set1(-t->most));
        vf_store(out + x, vf_select(vf_eq(v, own), bright, vf_mul(v, vf_set1(t->undim))));
    }
}

#endif
