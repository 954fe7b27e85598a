// SPDX-License-Identifier: BSD-3-Clause
// Scatter's disocclusion fill on vectors. Nothing is fused: this engine has the same bits everywhere.
#include "pixel/coc_vf.h"
#include "engine/scatter/behind.h"
#include "engine/scatter/composite_simd.h"

static int seen_weights_simd(const struct hf_scatter *t, const float *radius, const float *widest, int first, int n,
                             float *const out[2])
{
    const int whole = first + (n - first) / (2 * VF_N) * 2 * VF_N;
    const vf zero = vf_zero(), quarter = vf_set1(0.25f);
    vm some[2] = {vf_gt(zero, zero), vf_gt(zero, zero)};
    for (int x = first; x < whole; x += 2 * VF_N) {
        const vf quad = vf_mul(vf_set1(0.5f), vf_load(widest + x / 2));
        vf wide[2];
        vf_zip(quad, quad, &wide[0], &wide[1]);
        for (int k = 0; k < 2; k++) {
            const vf r = vf_load(radius + x + k * VF_N);
            const vf nearer = vf_saturate(vf_add(wide[k], r)), hardly = vf_saturate(vf_add(vf_set1(1.5f), r));
            const vf fade = vf_saturate(vf_mul(vf_sub(vf_set1(t->fade), r), vf_set1(t->fade_slope)));
            const vm is_far = vf_gt(r, zero);
            const vf own = vf_select(is_far, fade, vf_smoothstep(vf_max(nearer, hardly))), sharp = vf_mul(quarter, own);
            const vf far = vf_keep(is_far, vf_mul(quarter, vf_sub(vf_set1(1), own)));
            vf_store(out[0] + x + k * VF_N, sharp);
            vf_store(out[1] + x + k * VF_N, far);
            some[0] = vm_or(some[0], vf_gt(sharp, zero));
            some[1] = vm_or(some[1], vf_gt(far, zero));
        }
    }
    return hf_seen_weights_c(t, radius, widest, whole, n, out) | vm_any(some[0]) | vm_any(some[1]) << 1;
}

static void behind_blend_simd(const struct hf_scatter_row *row, const float *const weight[2],
                              const float *const colour[2], const float *own, float *out)
{
    const struct hf_scatter *t = hf_scatter(row->setup);
    const vf zero = vf_zero(), nothing = vf_set1(HF_SCATTER_NOTHING), dim = vf_set1(t->dim);
    for (int i = 0; i < row->n; i += VF_N) {
        const vf mine = vf_mul(vf_load(own + i), dim);
        vf front = mine, far = mine, far_weight = zero;
        if (row->near)
            front = scatter_field_colour(t, mine, vf_load(row->near + i), vf_load(row->near_weight + i));
        if (row->far) {
            far_weight = vf_load(row->far_weight + i);
            far = scatter_field_colour(t, mine, vf_load(row->far + i), far_weight);
        }
        const vf reached = vf_saturate(vf_mul(vf_set1(16), far_weight));
        const vf sharp = vf_load(weight[0] + i), blurred = vf_load(weight[1] + i), both = vf_add(sharp, blurred);
        const vf v = scatter_mix(front, far, reached);
        const vf trusted = vf_saturate(far_weight);
        vf seen =
            vf_select(vf_gt(blurred, zero), scatter_mix(vf_div(vf_load(colour[1] + i), blurred), far, trusted), v);
        seen = vf_select(vf_gt(sharp, zero),
                         scatter_mix(seen, vf_div(vf_load(colour[0] + i), sharp), vf_div(sharp, both)), seen);
        const vf some = scatter_mix(seen, v, vf_div(nothing, vf_add(both, nothing)));
        vf_store(out + i, vf_select(vf_gt(both, zero), some, v));
    }
}
