// SPDX-License-Identifier: BSD-3-Clause
// The depths at which near CoC ends and far CoC begins. Both are monotone in depth, rounding included, so one
// comparison says whether a pixel has any. The first sweep asks only that, and need not compute the CoC.
#include <math.h>

#include "base/small_float.h"
#include "engine/gaussian/kernels.h"
#include "pixel/pass_c.h"

// Surfaces end at this depth; pixels without a surface have infinite depth.
static const float no_surface = 1e10f;

static float variable(const struct hf_setup *s, float z)
{
    return s->lens ? -1 / z : z;
}

float hf_gaussian_near(const struct hf_setup *s, float z)
{
    return hf_round_coc(s->storage, hf_ramp(s, (s->near_0 - variable(s, z)) * s->near_i));
}

float hf_gaussian_far(const struct hf_setup *s, float z)
{
    return hf_round_coc(s->storage, hf_ramp(s, (variable(s, z) - s->far_0) * s->far_i));
}

// The first depth of a surface at which near CoC has ended, or far CoC has begun; no_surface if there is none. A
// bisection over the bits of positive floats, which increase with the floats.
static float turn(const struct hf_setup *s, int near)
{
    uint32_t a = 0, b = hf_bits(no_surface);  // at a nothing has changed yet, or a is 0; at b it has
    while (b - a > 1) {
        const uint32_t middle = a + (b - a) / 2;
        const float z = hf_from_bits(middle);
        if (near ? !(hf_gaussian_near(s, z) > 0) : hf_gaussian_far(s, z) > 0)
            b = middle;
        else
            a = middle;
    }
    return hf_from_bits(b);
}

void hf_gaussian_limits(const struct hf_setup *s, struct hf_gaussian *g)
{
    // Smoothstep rounds up or down along its slope, so its largest value need not be at the end.
    if (g->by_depth || s->form != HF_FORM_Z || s->smoothstep)
        return;
    const float near_end = turn(s, 1), far_begin = turn(s, 0);
    g->near_last = hf_gaussian_near(s, INFINITY) > 0 ? INFINITY : hf_from_bits(hf_bits(near_end) - 1);
    g->far_first = far_begin < no_surface ? far_begin : hf_gaussian_far(s, INFINITY) > 0 ? INFINITY : NAN;
    g->by_limits = !(g->far_first <= g->near_last);
}
