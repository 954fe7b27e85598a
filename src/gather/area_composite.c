// SPDX-License-Identifier: BSD-3-Clause
// Composite by area: the far field, then the near one, over the picture. (1 - t) a + b never passes the larger of both, and
// of ones it is 1.
#include "gather/gather.h"
#include "gather/phase.h"

// How much of a pixel the far field is: its own part, less twice what its neighbourhood has less of it. A pixel beside
// something sharp, where that is smoothed over its edge, so stays in part what it was.
static float far_part(const struct hf_frame *f, struct hf_phase p, float coc)
{
    const float gain = hf_gather_levels(f->s, HF_FAR)->gain;
    const float own = gain * coc < 1 ? gain * coc : 1;
    const float around = (2 / 16.0f) * hf_upsample(&f->buf[HF_BUF_COC4], HF_AREA_FAR, p) - own;
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
    hf_upsampling *up = hf_gather(f->s)->bicubic ? hf_upsample_cubic : hf_upsample;
    const float scale = hf_gather(f->s)->bicubic ? 1 : 1 / 16.0f;
    const float t = scale * up(&f->buf[HF_BUF_COVER], 0, p);
    for (int c = 0; c < f->s->channels && t != 0; c++)
        colour[c][i] = (1 - t) * colour[c][i] + scale * up(&f->buf[HF_BUF_NEAR], c, p);
}

static void composite_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const int n = r.x1 - r.x0, ny = y & 1 ? y / 2 + 1 : y / 2 - 1;
    float *lane[2][4], *coc[4];
    for (int i = 0; i < 4; i++) {
        lane[0][i] = hf_line(f, i);
        lane[1][i] = hf_line(f, 4 + i);
        coc[i] = hf_line(f, 8 + i);
    }
    hf_read_colour(f, r.x0, y, n, lane[0], lane[1], f->counts);
    if (f->far)
        f->k->coc_row(f, r.x0, y, n, coc, NULL);
    for (int odd = 0; odd < 2; odd++) {
        for (int i = 0; i < n; i++) {
            const int x = r.x0 + i;
            const struct hf_phase p = {x, y / 2, odd ? x + 1 : x - 1, ny};
            if (f->far)
                blend_far(f, p, coc[2 + odd][i], lane[odd], i);
            if (f->near)
                blend_near(f, p, lane[odd], i);
        }
        hf_store_rgb(f, lane[odd], n);
    }
    if (f->s->channels == 3)
        lane[0][3] = lane[1][3] = NULL;
    f->counts->clamped +=
        f->k->store[f->dst->format](f->dst, r.x0, y, n, (const float *const *)lane[0], (const float *const *)lane[1]);
}

void hf_area_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height); y++)
        composite_row(f, y, r);
}
