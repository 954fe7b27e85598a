// SPDX-License-Identifier: BSD-3-Clause
// Highlights of clipped pictures on vectors, as in highlight.c. Nothing is fused.
#include <float.h>

#include "pixel/highlight.h"
#include "pixel/kernels.h"
#include "simd/simd.h"

HF_INLINE vf highlight_luminance(const vf v[3])
{
    const vf red = vf_mul(vf_set1(HF_LUMINANCE_R), vf_max(v[0], vf_zero()));
    const vf green = vf_mul(vf_set1(HF_LUMINANCE_G), vf_max(v[1], vf_zero()));
    const vf blue = vf_mul(vf_set1(HF_LUMINANCE_B), vf_max(v[2], vf_zero()));
    return vf_min(vf_add(vf_add(red, green), blue), vf_set1(FLT_MAX));
}

static void raise_row_simd(const struct hf_highlight *h, float *r, float *g, float *b, int n)
{
    float *const rgb[3] = {r, g, b};
    const vf from = vf_set1(h->from), scale = vf_set1(h->scale), more = vf_set1(h->more);
    for (int i = 0; i < n; i += VF_N) {
        const vf v[3] = {vf_load(r + i), vf_load(g + i), vf_load(b + i)};
        const vf m = highlight_luminance(v);
        const vm high = vf_gt(m, from);
        if (!vm_any(high))
            continue;
        const vf t = vf_min(vf_mul(vf_sub(m, from), scale), vf_set1(1));
        const vf part = vf_div(vf_mul(more, vf_mul(t, t)), m);
        for (int c = 0; c < 3; c++) {
            const vf raised = vf_add(v[c], vf_mul(v[c], part));
            vf_store(rgb[c] + i, vf_select(vm_and(high, vf_gt(v[c], vf_zero())), raised, v[c]));
        }
    }
}

static void lower_row_simd(const struct hf_highlight *h, float *r, float *g, float *b, int n)
{
    float *const rgb[3] = {r, g, b};
    const vf from = vf_set1(h->from), span = vf_set1(h->span), gain = vf_set1(h->gain);
    const vf more4 = vf_set1(4 * h->more), span2 = vf_set1(h->span * h->span);
    for (int i = 0; i < n; i += VF_N) {
        const vf v[3] = {vf_load(r + i), vf_load(g + i), vf_load(b + i)};
        const vf most = highlight_luminance(v);
        const vm high = vf_gt(most, from);
        if (!vm_any(high))
            continue;
        const vf below = vf_min(most, gain), d = vf_sub(below, from);
        const vf root = vf_sqrt(vf_add(span2, vf_mul(more4, d)));
        const vf t = vf_min(vf_div(vf_add(d, d), vf_add(span, root)), vf_set1(1));
        const vf m = vf_add(vf_add(from, vf_mul(span, t)), vf_sub(most, below)), part = vf_div(m, most);
        for (int c = 0; c < 3; c++)
            vf_store(rgb[c] + i, vf_select(vm_and(high, vf_gt(v[c], vf_zero())), vf_mul(v[c], part), v[c]));
    }
}
