// SPDX-License-Identifier: BSD-3-Clause
// What cuts lamps on vectors. The order of operations is that of cut.c.
#include "engine/layers/kernels.h"
#include "simd/simd.h"

static void layers_dim_simd(const float *part, const float *in, int n, float *out)
{
    const vf zero = vf_zero(), more = vf_set1(HF_LAYERS_DIM_MORE);
    for (int x = 0; x < n; x += VF_N) {
        const vf was = vf_load(out + x), left = vf_fnma(vf_mul(vf_load(part + x), vf_load(in + x)), more, was);
        vf_store(out + x, vf_select(vf_lt(was, zero), vf_min(left, zero), vf_max(left, zero)));
    }
}

// Places are small whole numbers and the size a power of 2, so this and the plain C find the same two samples. Pixels beyond n
// look within the line, and what they find is not added.
static int layers_passed_simd(const struct hf_layers_rays *r, int n, float *out)
{
    static const float lanes[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const vf one = vf_set1(1), most = vf_set1(r->most), first = vf_set1((float)r->first),
             last = vf_set1((float)(r->samples - 1));
    vm any = vf_lt(one, vf_zero());
    for (int x = 0; x < r->samples; x += VF_N)
        vf_store(r->line + x,
                 vf_fma(vf_set1(r->below), vf_load(r->lower + x), vf_mul(vf_set1(r->above), vf_load(r->upper + x))));
    for (int x = 0; x < n; x += VF_N) {
        const vf i = vf_add(vf_set1((float)(r->x + x)), vf_load(lanes)), at = vf_add(vf_add(i, i), one);
        const vf off = vf_mul(vf_set1(r->part), vf_sub(vf_set1(r->lamp), at));
        const vf u =
            vf_sub(vf_mul(vf_add(at, vf_between(off, vf_sub(vf_zero(), most), most)), vf_set1(r->size)), vf_set1(0.5f));
        const vf whole = vf_floor(u), left = vf_sub(whole, first), right = vf_add(left, one);
        const vf a = vf_gather(r->line, vf_to_vi(vf_min(vf_max(left, vf_zero()), last)));
        const vf b = vf_gather(r->line, vf_to_vi(vf_min(vf_max(right, vf_zero()), last)));
        const vf found = vf_keep(vf_lt(i, vf_set1((float)(r->x + n))), vf_fma(vf_sub(u, whole), vf_sub(b, a), a));
        const vf sum = vf_add(vf_load(out + x), found);
        any = vm_or(any, vf_gt(found, vf_zero()));
        vf_store(out + x, vf_select(vf_gt(found, vf_zero()), vf_min(sum, one), vf_load(out + x)));
    }
    return vm_any(any);
}
