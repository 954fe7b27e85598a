// SPDX-License-Identifier: BSD-3-Clause
// Slices composited on vectors. The order of operations is that of composite.c.
#include "engine/layers/kernels.h"
#include "simd/simd.h"

static void layers_up_simd(const float *a, const float *b, int n, float *out)
{
    const vf most = vf_set1(0.75f), least = vf_set1(0.25f);
    for (int x = 0; x < n; x += VF_N) {
        const vf before = vf_fma(least, vf_load(b + x - 1), vf_mul(most, vf_load(a + x - 1)));
        const vf at = vf_fma(least, vf_load(b + x), vf_mul(most, vf_load(a + x)));
        const vf after = vf_fma(least, vf_load(b + x + 1), vf_mul(most, vf_load(a + x + 1)));
        const vf own = vf_mul(most, at);
        vf even, odd;
        vf_zip(vf_fma(least, before, own), vf_fma(least, after, own), &even, &odd);
        vf_store(out + 2 * x, even);
        vf_store(out + 2 * x + VF_N, odd);
    }
}

// Whether any sum or weight of a vector is not 0.
HF_INLINE int layers_is_any(float *const in[5], const int channels, int x)
{
    vm any = vf_ne(vf_load(in[4] + x), vf_zero());
    for (int c = 0; c < channels; c++)
        any = vm_or(any, vf_ne(vf_load(in[c] + x), vf_zero()));
    return vm_any(any);
}

// Most of a slice's plane is 0. Such vectors are skipped.
HF_INLINE void layers_blend_of(const struct hf_stack_row *to, const int channels, float *const in[5],
                               const enum hf_layers_sums sums, int n)
{
    const vf tiny = vf_set1(1e-30f);
    for (int x = 0; x < n; x += VF_N) {
        if (!layers_is_any(in, channels, x))
            continue;
        const vf v = vf_load(in[4] + x), open = vf_load(to->open + x);
        const vf left = sums == HF_SUMS_HIDING ? vf_zero() : vf_load(to->behind + x);
        vf k = vf_div(open, vf_max(v, vf_max(sums == HF_SUMS_HIDDEN ? vf_max(left, open) : open, tiny)));
        if (sums == HF_SUMS_HELD) {
            const vf held = vf_load(to->held + x), hold = vf_min(v, held);
            k = vf_select(vf_gt(hold, vf_zero()), vf_div(vf_min(vf_sub(v, hold), open), v), k);
            vf_store(to->held + x, vf_sub(held, hold));
        }
        for (int c = 0; c < channels; c++) {
            vf_store(to->colour[c] + x, vf_fma(k, vf_load(in[c] + x), vf_load(to->colour[c] + x)));
            vf_store(in[c] + x, vf_zero());
        }
        vf_store(in[4] + x, vf_zero());
        vf_store(to->weight + x, vf_fma(k, v, vf_load(to->weight + x)));
        vf_store(to->open + x, vf_max(vf_fnma(k, v, open), vf_zero()));
        if (sums != HF_SUMS_HIDING)
            vf_store(to->behind + x, vf_max(vf_sub(left, v), vf_zero()));
    }
}

HF_INLINE void layers_blend_sums(const struct hf_stack_row *to, const int channels, float *const in[5],
                                 enum hf_layers_sums sums, int n)
{
    if (sums == HF_SUMS_HIDING)
        layers_blend_of(to, channels, in, HF_SUMS_HIDING, n);
    else if (sums == HF_SUMS_SEEN)
        layers_blend_of(to, channels, in, HF_SUMS_SEEN, n);
    else if (sums == HF_SUMS_HELD)
        layers_blend_of(to, channels, in, HF_SUMS_HELD, n);
    else
        layers_blend_of(to, channels, in, HF_SUMS_HIDDEN, n);
}

static void layers_blend_simd(const struct hf_stack_row *to, int channels, float *const in[5], enum hf_layers_sums sums,
                              int n)
{
    HF_WITH_CHANNELS(channels, layers_blend_sums(to, CHANNELS, in, sums, n));
}

// The last addition is never fused, as in the plain C.
static void layers_light_simd(const float *part, const float *in, int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        const vf v = vf_load(in + x);
        if (vm_any(vf_ne(v, vf_zero())))
            vf_store(out + x, vf_add(vf_mul(vf_load(part + x), v), vf_load(out + x)));
    }
}

static void layers_finish_simd(const struct hf_stack_row *near, const float *const far[5], const float *const light[6],
                               const float *const own[4], int channels, float faint, int n, float *const out[4])
{
    const vf tiny = vf_set1(1e-30f), one = vf_set1(1);
    for (int x = 0; x < n; x += VF_N) {
        const vf w = vf_load(near->weight + x), lit = light ? vf_load(light[4] + x) : vf_zero();
        const vf open = vf_sub(one, w), left = vf_max(light ? vf_sub(open, lit) : open, vf_zero());
        const vf enough = light ? vf_max(vf_sub(vf_set1(faint), vf_load(light[5] + x)), tiny) : vf_set1(faint);
        const vf a = far ? vf_load(far[4] + x) : vf_zero();
        const vf g = far ? vf_div(left, vf_max(a, enough)) : vf_zero();
        const vf sum = vf_fma(g, a, w), rest = vf_max(vf_sub(one, lit), vf_zero());
        const vf whole = vf_max(sum, vf_set1(HF_LAYERS_SEEN)), still = vf_sub(whole, sum);
        for (int c = 0; c < channels; c++) {
            const vf top = vf_load(near->colour[c] + x), was = vf_load(own[c] + x);
            vf v = vf_div(vf_fma(still, was, far ? vf_fma(g, vf_load(far[c] + x), top) : top), whole);
            v = light ? vf_fma(rest, v, vf_load(light[c] + x)) : v;
            if (c == 3)
                v = vf_select(vf_lt(vf_abs(vf_sub(v, one)), vf_set1(HF_LAYERS_OPAQUE)), one, v);
            vf_store(out[c] + x, vf_select(vf_eq(v, was), was, v));
        }
    }
}
