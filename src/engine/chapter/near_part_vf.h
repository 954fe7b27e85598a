// SPDX-License-Identifier: BSD-3-Clause
// How the near field of taps comes in, on vectors.
#ifndef HF_NEAR_PART_VF_H
#define HF_NEAR_PART_VF_H

#include "engine/chapter/chapter.h"
#include "simd/simd.h"

// Is there any near CoC so small that the near field counts in part?
HF_INLINE int near_begins_vf(vf blur)
{
    return vm_any(vm_and(vf_gt(blur, vf_zero()), vf_lt(blur, vf_set1(1 / HF_NEAR_WHOLE))));
}

// As hf_near_part, and rounded as that is.
HF_INLINE vf near_part_vf(const int faithful, vf own, vf v, vf blur)
{
    const vm is_near = vf_gt(blur, vf_zero());
    if (!faithful) {
        const vf part = vf_mul(vf_set1(HF_NEAR_WHOLE), blur);
        v = vf_select(vf_lt(part, vf_set1(1)), vf_add(own, vf_mul(part, vf_sub(v, own))), v);
    }
    return vf_select(is_near, v, own);
}

#endif
