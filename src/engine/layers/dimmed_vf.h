// SPDX-License-Identifier: BSD-3-Clause
// How much bright samples count in a mean; and stores that skip unchanged values.
#ifndef HF_LAYERS_DIMMED_VF_H
#define HF_LAYERS_DIMMED_VF_H

#include "engine/layers/kernels.h"
#include "simd/simd.h"

// Store a vector unless its values are there already, as they mostly are from the frame before: then no line is written
// back.
HF_INLINE void layers_leave(float *p, vf v)
{
    if (vi_any(vi_xor(vi_load(p), vf_as_vi(v))))
        vf_store(p, v);
}

// As hf_layers_dimmed. Bright lanes are rare.
HF_INLINE vf layers_dimmed(vf light, vf plain)
{
    const vm bright = vf_gt(light, plain);
    if (!vm_any(bright))
        return vf_set1(1);
    const vf some = vf_max(vf_div(plain, light), vf_set1(HF_LAYERS_FAINTEST)), square = vf_mul(some, some);
    return vf_select(bright, vf_mul(square, square), vf_set1(1));
}

#endif
