// SPDX-License-Identifier: BSD-3-Clause
// Highlights on vectors. The order of operations is that of highlights.c.
#include <math.h>

#include "engine/layers/dimmed_vf.h"
#include "engine/layers/highlights.h"
#include "simd/simd.h"

HF_INLINE vf layers_light(const float *const in[3], int x)
{
    return vf_add(vf_add(vf_load(in[0] + x), vf_load(in[1] + x)), vf_load(in[2] + x));
}

static void layers_roots_simd(const float *const above[3], const float *const below[3], int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        vf sum[2], even, odd;
        for (int i = 0; i < 2; i++) {
            const int at = 2 * x + i * VF_N;
            sum[i] = vf_add(vf_sqrt(vf_max(layers_light(above, at), vf_zero())),
                            vf_sqrt(vf_max(layers_light(below, at), vf_zero())));
        }
        vf_unzip(sum[0], sum[1], &even, &odd);
        vf_store(out + x, vf_mul(vf_add(even, odd), vf_set1(0.25f)));
    }
}

static void layers_nine_simd(const float *const in[9], int n, float *out)
{
    for (int x = 0; x < n; x += VF_N) {
        vf sum = vf_load(in[4] + x);
        for (int i = 1; i <= 4; i++)
            sum = vf_add(sum, vf_add(vf_load(in[4 - i] + x), vf_load(in[4 + i] + x)));
        vf_store(out + x, vf_mul(sum, vf_set1(1.0f / 9)));
    }
}

// below_cap() of highlights.c for two vectors of pixels, as far as `some` of them have a sample.
HF_INLINE void layers_below_cap(const float *const in[6], const float *const around[5], const float *const covered[5],
                                int x, const vm some[2], vf part[2])
{
    vf light[2], least[2] = {vf_set1(HUGE_VALF), vf_set1(HUGE_VALF)};
    for (int j = 0; j < 2; j++)
        light[j] = vf_keep(some[j], layers_light(in, x + j * VF_N));
    for (int i = 0; i < 5; i++) {
        const vf mean = vf_load(around[i] + x / 2), m = i ? vf_mul(mean, vf_set1(HF_LAYERS_BESIDE)) : mean;
        vf v[2];
        vf_zip(m, m, &v[0], &v[1]);
        if (covered) {
            const vf open = vf_max(vf_sub(vf_set1(1), vf_load(covered[i] + x / 2)), vf_zero());
            vf of[2];
            vf_zip(open, open, &of[0], &of[1]);
            for (int j = 0; j < 2; j++)
                v[j] = vf_fma(of[j], vf_sqrt(vf_max(light[j], vf_zero())), v[j]);
        }
        for (int j = 0; j < 2; j++)
            least[j] = vf_min(v[j], least[j]);
    }
    for (int j = 0; j < 2; j++) {
        const vf r = vf_keep(some[j], vf_load(in[5] + x + j * VF_N));
        const vf cap =
            vf_mul(vf_mul(least[j], least[j]), vf_fma(vf_mul(r, r), vf_set1(HF_LAYERS_BRIGHT_LEAST * 3.14159265f),
                                                      vf_set1(HF_LAYERS_BRIGHT_PLAIN)));
        const vm bright = vm_and(vf_gt(vf_abs(r), vf_set1(HF_LAYERS_FINE)), vf_gt(light[j], cap));
        part[j] = vm_any(bright) ? vf_select(bright, vf_div(cap, light[j]), vf_set1(1)) : vf_set1(1);
    }
}

// Exchange the samples of some pixels.
HF_INLINE void layers_change_places(float *const seen[6], float *const mixed[6], int x, vm where)
{
    for (int i = 0; i < 6; i++) {
        if (!seen[i])
            continue;
        const vf a = vf_load(seen[i] + x), b = vf_load(mixed[i] + x);
        vf_store(seen[i] + x, vf_select(where, b, a));
        vf_store(mixed[i] + x, vf_select(where, a, b));
    }
}

// Let the brighter highlights of two vectors of pixels be the visible ones. share: the visible samples'; it becomes the pixels'.
HF_INLINE void layers_brighter_first(float *const seen[6], float *const mixed[6], const float *const around[5],
                                     const float *const covered[5], int x, vf share[2])
{
    const vf one = vf_set1(1), zero = vf_zero();
    const vm some[2] = {vf_gt(vf_load(mixed[4] + x), zero), vf_gt(vf_load(mixed[4] + x + VF_N), zero)};
    vf part[2];
    if (!vm_any(some[0]) && !vm_any(some[1]))
        return;
    layers_below_cap((const float *const *)mixed, around, covered, x, some, part);
    for (int j = 0; j < 2; j++) {
        const int at = x + j * VF_N;
        part[j] = vf_mul(part[j], vf_set1(HF_LAYERS_BEHIND));
        const vm bright = vf_lt(part[j], one);
        if (!vm_any(bright))
            continue;
        const vf other = vf_keep(bright, vf_mul(vf_load(mixed[4] + at), vf_sub(one, part[j])));
        const vf own_light = vf_mul(share[j], layers_light((const float *const *)seen, at));
        const vf other_light = vf_keep(bright, vf_mul(other, layers_light((const float *const *)mixed, at)));
        const vm brighter = vf_gt(other_light, own_light);
        const vf less = vf_div(vf_min(own_light, other_light), vf_max(own_light, other_light));
        const vf winner = vf_select(brighter, other, share[j]);
        share[j] = vf_select(vf_gt(other_light, zero), vf_fnma(winner, less, winner), share[j]);
        if (vm_any(brighter))
            layers_change_places(seen, mixed, at, brighter);
    }
}

static void layers_shares_simd(float *const seen[6], float *const mixed[6], const uint8_t *mixes,
                               const float *const around[5], const float *const covered[5], int n, float *out,
                               uint8_t *any)
{
    const vf one = vf_set1(1);
    const vm all = vf_lt(vf_zero(), one);
    for (int x = 0; x < n; x += 2 * VF_N) {
        vf share[2];
        layers_below_cap((const float *const *)seen, around, covered, x, (const vm[]){all, all}, share);
        for (int j = 0; j < 2; j++)
            share[j] = vf_mul(vf_load(seen[4] + x + j * VF_N), vf_sub(one, share[j]));
        if (mixes[x / 16] | (VF_N == 16 && x + 16 < n ? mixes[x / 16 + 1] : 0))
            layers_brighter_first(seen, mixed, around, covered, x, share);
        for (int j = 0; j < 2; j++) {
            const int at = x + j * VF_N;
            if (vm_any(vf_gt(share[j], vf_zero())))
                any[at / 16] = 1;
            layers_leave(out + at, share[j]);
        }
    }
}

// The nearest radius of a row of quads' pixels, and the mean of their alpha.
HF_INLINE vf layers_nearest_of(const float *const row[2], int x)
{
    vf even, odd;
    vf_unzip(vf_min(vf_load(row[0] + x), vf_load(row[1] + x)),
             vf_min(vf_load(row[0] + x + VF_N), vf_load(row[1] + x + VF_N)), &even, &odd);
    return vf_min(even, odd);
}

HF_INLINE vf layers_mean_of(const float *const row[2], int x)
{
    vf even, odd;
    vf_unzip(vf_add(vf_load(row[0] + x), vf_load(row[1] + x)),
             vf_add(vf_load(row[0] + x + VF_N), vf_load(row[1] + x + VF_N)), &even, &odd);
    return vf_mul(vf_add(even, odd), vf_set1(0.25f));
}

// The brightness at a tap. What is open of it is as bright as the quad itself.
HF_INLINE vf layers_at_tap(const struct hf_lamp_tap *tap, int x, vf own)
{
    const vf root = vf_load(tap->root + x);
    if (!tap->alpha[0])
        return root;
    return vf_fma(vf_max(vf_sub(vf_set1(1), layers_mean_of(tap->alpha, 2 * x)), vf_zero()), own, root);
}

static void layers_lamps_simd(const float *const in[6], const struct hf_lamp_tap tap[HF_LAYERS_LAMP_TAPS], int n,
                              float *weight)
{
    const vf one = vf_set1(1), zero = vf_zero();
    for (int x = 0; x < n; x += VF_N) {
        const vf r = vf_load(in[5] + x), w = vf_load(in[4] + x);
        vf light = zero, seen = zero, sum = zero;
        for (int c = 0; c < 3; c++) {
            const vf v = vf_load(in[c] + x);
            light = vf_fma(v, vf_abs(v), light);
        }
        const vf own = vf_sqrt(vf_max(light, zero));
        vf most = own, least = vf_load(tap[HF_LAYERS_LAMP_NEXT].root + x);
        for (int i = 0; i < HF_LAYERS_LAMP_NEXT; i++)
            most = vf_max(layers_at_tap(&tap[i], x, own), most);
        for (int i = HF_LAYERS_LAMP_NEXT + 1; i < HF_LAYERS_LAMP_TAPS; i++)
            least = vf_min(vf_load(tap[i].root + x), least);
        // Most vectors have no lamp: none of their quads is bright even beside the darkest around, and the mean is at least
        // that, rounding aside.
        const vf lowest = vf_mul(vf_mul(least, least), vf_set1(0.99f * HF_LAYERS_LAMP));
        if (!vm_any(vm_and(vf_gt(w, zero), vf_gt(vf_mul(most, most), lowest))))
            continue;
        vf whole = most = own;
        for (int i = 0; i < HF_LAYERS_LAMP_TAPS; i++) {
            const vf part = vf_saturate(vf_add(vf_sub(layers_nearest_of(tap[i].radius, 2 * x), r), vf_set1(2)));
            const vf v = layers_at_tap(&tap[i], x, own);
            if (i < HF_LAYERS_LAMP_NEXT) {
                most = vf_max(vf_mul(part, v), most);
                whole = vf_max(v, whole);
                continue;
            }
            seen = vf_add(seen, part);
            sum = vf_fma(part, v, sum);
        }
        const vf mean =
            vf_max(vf_keep(vf_gt(seen, zero), vf_div(sum, seen)), vf_mul(whole, vf_set1(HF_LAYERS_LAMP_DARK)));
        const vf cap = vf_mul(vf_mul(mean, mean), vf_set1(HF_LAYERS_LAMP));
        const vf brightest = vf_mul(most, most);
        const vm bright = vm_and(vf_gt(w, zero), vf_gt(brightest, cap));
        if (!vm_any(bright))
            continue;
        const vf lamp = vf_sub(one, vf_saturate(vf_sub(vf_div(vf_add(cap, cap), brightest), one)));
        vf_store(weight + x, vf_select(bright, vf_mul(w, vf_fnma(vf_saturate(seen), lamp, one)), w));
    }
}
