// SPDX-License-Identifier: BSD-3-Clause
// Choosing settings by quality or by allowed error.
#include "frame/ladder.h"
#include "pixel/limits.h"

// The reason why params cannot make what was asked for; NULL: they can.
static const char *misfit(const struct hf_params *p, float radius)
{
    return hf_ladder_farthest(p) < radius ? "does not reach as far as the blur that is asked for"
           : !hf_ladder_can_draw(p)       ? "does not draw the aperture's shape"
                                          : NULL;
}

// Apply the first step, from the given one on, that can make what was asked for, or else the last step.
static void choose(struct hf_params *p, int step, float radius, struct hf_choice *choice)
{
    struct hf_params chosen = *p;
    const char *why = NULL;
    const int from = step;
    hf_ladder_apply(&chosen, step);
    for (const char *here; step + 1 < hf_ladder_steps && (here = misfit(&chosen, radius));
         hf_ladder_apply(&chosen, step)) {
        why = why ? why : here;
        step++;
    }
    *p = chosen;
    if (choice)
        *choice = (struct hf_choice){
            .step = step,
            .steps = hf_ladder_steps,
            .options = hf_ladder[step].options,
            .error = hf_ladder[step].error,
            .worst = hf_ladder[step].worst,
            .ms = hf_ladder[step].ms,
            .passed = step - from,
            .why = why,
            .measured = hf_ladder_measured,
        };
}

// The radius that the parameters ask for, in a picture of this height with this kind of depth.
static float asked_radius(int height, const struct hf_depth *depth, const struct hf_params *p)
{
    const int display = p->view.display_height;
    return hf_asked_radius(p, depth ? depth->type : HF_DEPTH_VIEW, display > 0 ? display : height);
}

int hf_choose_quality(int height, const struct hf_depth *depth, struct hf_params *params, enum hf_quality quality,
                      struct hf_choice *choice)
{
    if (!params || height < 1 || !hf_name(HF_NAMES_QUALITY, (int)quality))
        return HF_ERR_ARG;
    choose(params, hf_ladder_quality[quality], asked_radius(height, depth, params), choice);
    return HF_OK;
}

int hf_choose_error(int height, const struct hf_depth *depth, struct hf_params *params, float error,
                    struct hf_choice *choice)
{
    int step = 0;
    if (!params || height < 1 || !(error > 0 && error <= 1))
        return HF_ERR_ARG;
    while (step + 1 < hf_ladder_steps && !(hf_ladder[step].error <= error))
        step++;
    choose(params, step, asked_radius(height, depth, params), choice);
    return HF_OK;
}
