// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/level.h"

void view_levels_open(struct view_levels *l)
{
    // What the ladder was measured with, until this machine has rendered something.
    *l = (struct view_levels){.ms = {30, 60}};
}

void view_levels_tell(struct view_levels *l, enum view_stage stage, double megapixels, double ms)
{
    double *known = &l->ms[stage != VIEW_QUICK];
    const double now = ms / megapixels;
    // Small pictures do not take less time in proportion, and other programs make a frame late: learn quickly that the machine is
    // fast, and slowly that it is not.
    if (stage == VIEW_STANDARD || (megapixels < 0.1 && now > *known))
        return;
    *known += 0.2 * (now - *known);
}

// The engines whose look the ladder's cheaper steps keep.
static int has_draft(enum hf_engine engine)
{
    return engine == HF_ENGINE_LAYERS || engine == HF_ENGINE_SCATTER;
}

static int height_of(const struct hf_params *p)
{
    return p->view.display_height > 0 ? p->view.display_height : 1080;
}

int view_levels_choose(const struct view_levels *l, const struct hf_params *final, const struct hf_depth *depth,
                       double pixels, int n, struct hf_params *params, enum view_stage *stage)
{
    const double megapixels = pixels / 1e6;
    *params = *final;
    *stage = VIEW_FINAL;
    if (l->ms[1] * megapixels / (n * n) <= VIEW_TARGET_MS)
        return n;
    *stage = VIEW_QUICK;
    const int draft = has_draft(final->engine) &&
                      hf_choose_quality(height_of(final), depth, params, HF_QUALITY_DRAFT, NULL, NULL) == HF_OK;
    const double ms = l->ms[draft ? 0 : 1];
    int k = n;
    while (k < 4 * n && k < 8 && ms * megapixels / (k * k) > VIEW_TARGET_MS)
        k++;
    return k;
}

int view_levels_standard(const struct hf_params *final, const struct hf_depth *depth, struct hf_params *params)
{
    *params = *final;
    return final->engine == HF_ENGINE_LAYERS && final->layers.quality > HF_LAYERS_DRAFT &&
           hf_choose_quality(height_of(final), depth, params, HF_QUALITY_STANDARD, NULL, NULL) == HF_OK;
}
