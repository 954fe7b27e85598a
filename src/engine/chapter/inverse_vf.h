// SPDX-License-Identifier: BSD-3-Clause
// Reciprocals, exact or not. Where this is not exact, bits are those of one kind of processor.
#ifndef HF_INVERSE_VF_H
#define HF_INVERSE_VF_H

#include "engine/chapter/chapter.h"
#include "simd/simd.h"

// 1 / x, x finite and at least FLT_MIN; what other lanes hold may come to anything, NaN included. Each step of Newton's
// leaves the square of the relative error.
HF_INLINE vf inverse_vf(const enum hf_division division, vf x)
{
    if (division == HF_DIVISION_EXACT)
        return vf_div(vf_set1(1), x);
    vf r = vf_reciprocal(x);
    for (int step = HF_DIVISION_ESTIMATE; step < (int)division; step++)
        r = vf_mul(r, vf_fnma(x, r, vf_set1(2)));
    return r;
}

#endif
