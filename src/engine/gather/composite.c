// SPDX-License-Identifier: BSD-3-Clause
// Composite: the far field, then the near one, over the picture. (1 - t) a + b never passes the larger of both, and
// of ones it is 1.
#include "engine/gather/gather.h"

// How much of a pixel the far field is: its own part, less twice what its neighbourhood has less of what is out of focus. A
// pixel beside something sharp, where that is smoothed over its edge, so stays in part what it was.
static float far_part(const struct hf_frame *f, struct hf_phase p, float coc)
{
    const struct hf_levels *l = hf_gather_levels(f->s, HF_FAR);
    const float own = hf_level_part(l, l->gain, coc);
    const float around = (2 / 16.0f) * hf_upsample(&f->buf[HF_BUF_FAR_PART], 0, p) - own;
    const float t = around < own ? around : own;
    return t > 0 ? t : 0;
}

static void blend_far(const struct hf_frame *f, struct hf_phase p, float coc, float *const colour[4], int i)
{
    const float t = far_part(f, p, coc);
    for (int c = 0; c < f->s->channels && t != 0; c++)
        colour[c][i] = (1 - t) * colour[c][i] + (t * (1 / 16.0f)) * hf_upsample(&f->buf[HF_BUF_FAR], c, p);
}

static void blend_near(const struct hf_frame *f, struct hf_phase p, float *const colour[4], int i)
{
    hf_upsampling *up = hf_fields(f->s)->bicubic ? hf_upsample_cubic : hf_upsample;
    const float scale = hf_fields(f->s)->bicubic ? 1 : 1 / 16.0f;
    const float t = scale * up(&f->buf[HF_BUF_COVER], 0, p);
    for (int c = 0; c < f->s->channels && t != 0; c++)
        colour[c][i] = (1 - t) * colour[c][i] + scale * up(&f->buf[HF_BUF_NEAR], c, p);
}

void hf_gather_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    hf_composite_with(f, r, blend_far, blend_near);
}
