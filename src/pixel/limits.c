// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/limits.h"

#include <math.h>

float hf_most_picture_radius(const struct hf_params *p)
{
    const float wide = 1 / (p->view.pixel_aspect * p->aperture.squeeze);
    return wide > 4 ? 512 / sqrtf(wide) : 256;
}

float hf_model_radius(int display_height)
{
    return fminf(12 * (float)display_height / 1080, HF_MAX_RADIUS);
}

float hf_asked_radius(const struct hf_params *p, enum hf_depth_type type, int display_height)
{
    if (p->max_radius != HF_DERIVE)
        return p->max_radius;
    return type == HF_DEPTH_COC || p->model == HF_MODEL_LENS ? HF_MAX_RADIUS : hf_model_radius(display_height);
}
