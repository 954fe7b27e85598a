// SPDX-License-Identifier: BSD-3-Clause
// hf_level_part on vectors.
#ifndef HF_PART_VF_H
#define HF_PART_VF_H

#include "engine/gather/gather.h"
#include "simd/simd.h"

HF_INLINE vf level_part(struct hf_part_curve curve, vf gain, vf coc)
{
    const vf q = vf_min(vf_mul(gain, coc), vf_set1(1)), square = vf_mul(q, q);
    const vf rest = vf_fma(vf_set1(curve.sixth), vf_mul(square, square), vf_set1(curve.square));
    return vf_fma(square, rest, vf_mul(q, vf_set1(curve.linear)));
}

#endif
