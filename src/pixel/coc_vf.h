// SPDX-License-Identifier: BSD-3-Clause
// CoC of a vector of depth. Nothing is fused, so whether a pixel has any CoC is the same on every machine.
#ifndef HF_COC_VF_H
#define HF_COC_VF_H

#include "pixel/depth_rows.h"
#include "pixel/format_vf.h"

// Call CALL with FORM as a constant, so that the compiler makes a loop for each form.
#define HF_WITH_FORM_(form, call)                                                                                      \
    case form: {                                                                                                       \
        enum { FORM = form };                                                                                          \
        call;                                                                                                          \
        break;                                                                                                         \
    }
#define HF_WITH_FORM(of, call)                                                                                         \
    switch (of) {                                                                                                      \
        HF_WITH_FORM_(HF_FORM_Z, call)                                                                                 \
        HF_WITH_FORM_(HF_FORM_RAY, call)                                                                               \
        HF_WITH_FORM_(HF_FORM_IZ, call)                                                                                \
        HF_WITH_FORM_(HF_FORM_COC, call)                                                                               \
    }

HF_INLINE vf coc_round_unorm(vf t)
{
    // The sum is positive, so truncation is floor.
    const vf k = vi_to_vf(vf_to_vi(vf_add(vf_mul(t, vf_set1(255)), vf_set1(0.5f))));
    return vf_mul(k, vf_set1(1 / 255.0f));
}

HF_INLINE vf coc_round(enum hf_storage storage, vf t)
{
    if (storage == HF_STORAGE_PACKED)
        return coc_round_unorm(t);
    return storage == HF_STORAGE_HALF ? round_half_vf(t) : t;
}

// The variable that CoC is linear in, from view depths.
HF_INLINE vf coc_of_z(const struct hf_setup *s, vf z)
{
    return s->lens ? vf_div(vf_set1(-1), z) : z;
}

// The same from depth samples d. none: lanes without a surface. px, py: pixel centres
// relative to the optical axis.
HF_INLINE vf coc_variable(const struct hf_setup *s, const enum hf_depth_form form, vf d, vf px, vf py, vm *none)
{
    const vf infinity = vf_set1(__builtin_inff());
    vf z;
    if (form == HF_FORM_COC) {
        *none = vm_not(vf_lt(d, vf_set1(1e10f)));
        return d;
    }
    if (form == HF_FORM_IZ) {
        const vf e = vf_add(vf_set1(s->e_a), vf_mul(vf_set1(s->e_b), d));
        const vf iz = vf_add(vf_set1(s->iz_a), vf_mul(vf_set1(s->iz_b), e));
        z = vf_select(vf_gt(iz, vf_set1(1e-10f)), vf_div(vf_set1(1), iz), infinity);
    } else {
        const vm surface = vm_and(vf_gt(d, vf_zero()), vf_lt(d, vf_set1(1e10f)));
        z = vf_select(surface, d, infinity);
        *none = vm_not(surface);
        if (form == HF_FORM_RAY) {
            const vf x2 = vf_mul(vf_mul(px, px), vf_set1(s->ray_sx)), y2 = vf_mul(vf_mul(py, py), vf_set1(s->ray_sy));
            z = vf_div(z, vf_sqrt(vf_add(vf_set1(1), vf_add(x2, y2))));
        }
    }
    if (form != HF_FORM_Z)
        *none = vm_not(vf_lt(z, vf_set1(1e10f)));
    return coc_of_z(s, z);
}

// Is any of these view depths, whose bits these are, none of a surface? The bits of surfaces lie between those of 0 and of 1e10,
// and bits less 1 as unsigned numbers are larger for all else.
HF_INLINE int coc_misses_some(vi a, vi b, vi c, vi d)
{
    const vi one = vi_set1(1), last = vi_set1(hf_bits(1e10f) - 2);
    const vi most = vi_max(vi_max(vi_sub(a, one), vi_sub(b, one)), vi_max(vi_sub(c, one), vi_sub(d, one)));
    return vi_any(vi_xor(vi_max(most, last), last));
}

// The CoC from 0 to 1, linear or smoothstep.
HF_INLINE vf coc_ramp(const struct hf_setup *s, vf t)
{
    t = vf_saturate(t);
    return s->smoothstep ? vf_smoothstep(t) : t;
}

HF_INLINE vf coc_near(const struct hf_setup *s, vf v)
{
    return coc_round(s->storage, coc_ramp(s, vf_mul(vf_sub(vf_set1(s->near_0), v), vf_set1(s->near_i))));
}

// Far CoC before it is bound and shaped.
HF_INLINE vf coc_far_line(const struct hf_setup *s, vf v)
{
    return vf_mul(vf_sub(v, vf_set1(s->far_0)), vf_set1(s->far_i));
}

HF_INLINE vf coc_far(const struct hf_setup *s, vf v)
{
    return coc_round(s->storage, coc_ramp(s, coc_far_line(s, v)));
}

// What most frames have becomes a constant: linear CoC of view depth, which buffers hold as it is; of the range model and of a
// lens.
enum coc_how { COC_ANY, COC_RANGE, COC_LENS };

HF_INLINE enum coc_how coc_how(const struct hf_setup *s)
{
    if (s->form != HF_FORM_Z || s->smoothstep || s->storage != HF_STORAGE_FLOAT)
        return COC_ANY;
    return s->lens ? COC_LENS : COC_RANGE;
}

// Far CoC of the range model from view depths, if coc_how says so.
HF_INLINE vf coc_far_plain(const struct hf_setup *s, vf z)
{
    return vf_saturate(coc_far_line(s, z));
}

#endif
