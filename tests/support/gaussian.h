// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the gaussian engine share.
#ifndef HF_TESTS_GAUSSIAN_H
#define HF_TESTS_GAUSSIAN_H

#include <math.h>

#include "support/check.h"
#include "support/render.h"

static inline struct hf_params gaussian_params(void)
{
    struct hf_params p = hf_default_params();
    p.engine = HF_ENGINE_GAUSSIAN;
    p.focus = 20;
    p.max_radius = 12;
    return p;
}

static inline struct hf_params random_params(struct rng *rng)
{
    static const float strengths[] = {1, 1, 0.6f, 0.2f};
    struct hf_params p = gaussian_params();
    p.gaussian.iterations = rng_below(rng, 5) ? 1 + rng_below(rng, 4) : rng_below(rng, 12);
    p.gaussian.resolution = (enum hf_resolution)(rng_below(rng, 2) * rng_below(rng, 3));
    p.focus = rng_below(rng, 3) ? 20 : HF_DERIVE;
    p.gaussian.faithful = rng_below(rng, 3) == 0;
    p.range.blend = (enum hf_blend)rng_below(rng, 2);
    p.range.strength = strengths[rng_below(rng, 4)];
    p.range.distance = rng_below(rng, 2) ? HF_DERIVE : 10;
    p.model = rng_below(rng, 4) ? HF_MODEL_RANGE : HF_MODEL_LENS;
    p.lens.f_number = 0.05f;
    if (rng_below(rng, 4) == 0)
        p.gaussian.sigma = rng_below(rng, 2) ? rng_range(rng, 0.2f, 8) : rng_range(rng, 8, 256);
    return p;
}

#endif
