// SPDX-License-Identifier: BSD-3-Clause
// Choosing settings by quality or by allowed error.
#include "api/sized.h"
#include "frame/ladder.h"
#include "hyperfocal/inspect.h"
#include "pass/check.h"
#include "pixel/limits.h"

// Why params as they are would not give what was asked for; NULL: they do.
static const char *misfit(const struct hf_params *p, float radius)
{
    return hf_ladder_farthest(p) < radius ? "does not reach as far as the blur that is asked for"
           : !hf_ladder_can_draw(p)       ? "does not draw the aperture's shape"
                                          : NULL;
}

// A step of the ladder, and why those below it that were good enough were passed over.
struct chosen {
    int step, passed;
    const char *why;
};

// Apply the first step, from the given one on, that can make what was asked for, or else the last step.
static struct chosen choose(struct hf_params *p, int from, float radius)
{
    struct hf_params tried = *p;
    struct chosen c = {.step = from};
    hf_ladder_apply(&tried, from);
    for (const char *here; c.step + 1 < hf_ladder_steps && (here = misfit(&tried, radius));
         hf_ladder_apply(&tried, c.step)) {
        c.why = c.why ? c.why : here;
        c.step++;
        c.passed++;
    }
    *p = tried;
    return c;
}

static int step_of_quality(enum hf_quality quality, int *step, struct hf_message *message)
{
    if (hf_check_value("quality", (int)quality, 0, HF_QUALITY_BEST, message))
        return HF_ERR_ARG;
    *step = hf_ladder_quality[quality];
    return HF_OK;
}

static int step_of_error(float error, int *step, struct hf_message *message)
{
    if (!(error > 0 && error <= 1))
        return hf_bad(message, "error", "is %g; it must be more than 0 and at most 1", error);
    *step = 0;
    while (*step + 1 < hf_ladder_steps && !(hf_ladder[*step].error <= error))
        ++*step;
    return HF_OK;
}

// Choose for copies of what the program gave: own->params become those of the step.
static int choose_from(int height, const struct hf_depth *depth, const struct hf_params *params, int step,
                       struct hf_given *own, struct chosen *chosen, struct hf_message *message)
{
    struct hf_depth z = {.type = HF_DEPTH_VIEW};
    if (height < 1)
        return hf_bad(message, "height", "is %d; it must be at least 1", height);
    if (!params)
        return hf_bad(message, "params", "is NULL");
    if ((depth && hf_given_depth(&z, depth, message)) || hf_given_params(own, params, message) ||
        hf_check_value("engine", (int)own->params.engine, 0, HF_ENGINE_COUNT - 1, message))
        return HF_ERR_ARG;
    const int display = own->params.view.display_height;
    *chosen = choose(&own->params, step, hf_asked_radius(&own->params, z.type, display > 0 ? display : height));
    return HF_OK;
}

// Choose a step that is known, and tell of it.
static int choose_step(int height, const struct hf_depth *depth, struct hf_params *params, int step,
                       struct hf_choice *choice, struct hf_message *message)
{
    struct hf_given own;
    struct chosen c;
    if (choose_from(height, depth, params, step, &own, &c, message))
        return HF_ERR_ARG;
    const struct hf_choice told = {
        .error = hf_ladder[c.step].error, .worst = hf_ladder[c.step].worst, .ms = hf_ladder[c.step].ms, .why = c.why};
    if (hf_sized_out(choice, &told, &hf_sized_choice, "choice", message))
        return HF_ERR_ARG;
    own.params.aperture.picture = params->aperture.picture;  // the program's own
    return hf_sized_out(params, &own.params, &hf_sized_params, "params", message);
}

int hf_choose_quality(int height, const struct hf_depth *depth, struct hf_params *params, enum hf_quality quality,
                      struct hf_choice *choice, struct hf_message *message)
{
    struct hf_message own = {.size = sizeof own}, lost;
    int step = 0, err = step_of_quality(quality, &step, &own);
    if (!err)
        err = choose_step(height, depth, params, step, choice, &own);
    return hf_sized_out(message, &own, &hf_sized_message, "message", &lost) ? HF_ERR_ARG : err;
}

int hf_choose_error(int height, const struct hf_depth *depth, struct hf_params *params, float error,
                    struct hf_choice *choice, struct hf_message *message)
{
    struct hf_message own = {.size = sizeof own}, lost;
    int step = 0, err = step_of_error(error, &step, &own);
    if (!err)
        err = choose_step(height, depth, params, step, choice, &own);
    return hf_sized_out(message, &own, &hf_sized_message, "message", &lost) ? HF_ERR_ARG : err;
}

int hf_inspect_get_choice(int height, const struct hf_depth *depth, const struct hf_params *params,
                          enum hf_quality quality, float error, struct hf_inspect_choice *choice)
{
    static const struct hf_sized type = HF_SIZED(hf_inspect_choice, measured);
    struct hf_message message;
    struct hf_given own;
    struct chosen c;
    int step = 0;
    if (!choice || (error == 0 ? step_of_quality(quality, &step, &message) : step_of_error(error, &step, &message)) ||
        choose_from(height, depth, params, step, &own, &c, &message))
        return HF_ERR_ARG;
    const struct hf_inspect_choice told = {.step = c.step,
                                           .steps = hf_ladder_steps,
                                           .passed = c.passed,
                                           .options = hf_ladder[c.step].options,
                                           .measured = hf_ladder_measured};
    return hf_sized_out(choice, &told, &type, "choice", &message);
}
