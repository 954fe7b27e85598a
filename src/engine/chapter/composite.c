// SPDX-License-Identifier: BSD-3-Clause
// Composite: the far field, upsampled where its CoC is like the pixel's, then the near field, over the picture.
#include <float.h>

#include "engine/chapter/chapter.h"

// Joint bilateral upsampling. A sample has its bilinear weight, 9 3 3 1 (sixteenths), over 1 + 1000 |CoC difference|.
// A sample without far CoC has no far colour, so its weight is 0; the weight grows with the CoC from there. Products
// in place of quotients keep the weights in proportion, so that one division serves all four: each weight is the
// product of the other three samples' distances, whose factors 1 3 3 9 make 81 27 27 9 of them, which is 9 3 3 1.
// Returns how far the pixel is: its CoC, limited where its neighbours are hardly far, as they have little far colour.
static float far_weights(const struct hf_buf *coc, struct hf_phase p, float f, float w[4])
{
    const float g[4] = {*hf_at(coc, 1, p.x, p.y), *hf_at(coc, 1, p.nx, p.y), *hf_at(coc, 1, p.x, p.ny),
                        *hf_at(coc, 1, p.nx, p.ny)};
    float d[4], has[4];
    static const float factor[4] = {1, 3, 3, 9};
    const float inverse = 1 / (f > FLT_MIN ? f : FLT_MIN);
    for (int i = 0; i < 4; i++) {
        const float whole = HF_FAR_WHOLE * g[i] * inverse;
        d[i] = factor[i] + 1000 * factor[i] * __builtin_fabsf(f - g[i]);
        has[i] = whole < 1 ? whole : 1;
    }
    const float p01 = d[0] * d[1], p23 = d[2] * d[3];
    w[0] = d[1] * p23 * has[0];
    w[1] = d[0] * p23 * has[1];
    w[2] = d[3] * p01 * has[2];
    w[3] = d[2] * p01 * has[3];
    const float sum = (w[0] + w[1]) + (w[2] + w[3]);
    if (!(sum > HF_FAR_LEAST))
        return 0;
    const float i = 1 / sum;
    for (int t = 0; t < 4; t++)
        w[t] *= i;
    const float own = has[0] > has[1] ? has[0] : has[1], next = has[2] > has[3] ? has[2] : has[3];
    return f * (own > next ? own : next);
}

// The published demo: the colours are those of (k, k) for an even pixel, but the CoCs compared are those of
// (k - 1, k); all four bilinear weights are equal; what is not far counts as black.
static void far_weights_faithful(const struct hf_buf *coc, struct hf_phase p, float f, float w[4])
{
    const int x0 = hf_min(p.x, p.nx), x1 = hf_max(p.x, p.nx), y0 = hf_min(p.y, p.ny), y1 = hf_max(p.y, p.ny);
    const float g[4] = {*hf_at(coc, 1, x0, y0), *hf_at(coc, 1, x1, y0), *hf_at(coc, 1, x0, y1), *hf_at(coc, 1, x1, y1)};
    float d[4];
    for (int i = 0; i < 4; i++)
        d[i] = 1 + 1000 * __builtin_fabsf(f - g[i]);
    const float p01 = d[0] * d[1], p23 = d[2] * d[3];
    w[0] = d[1] * p23;
    w[1] = d[0] * p23;
    w[2] = d[3] * p01;
    w[3] = d[2] * p01;
    const float i = 1 / ((w[0] + w[1]) + (w[2] + w[3]));
    for (int t = 0; t < 4; t++)
        w[t] *= i;
}

// Over the sum of the weights, which is 1 within rounding: what is opaque stays so.
static float alpha_mean(const float w[4], const float v[4])
{
    float sum = w[0] * v[0], weight = w[0];
    for (int i = 1; i < 4; i++) {
        sum += w[i] * v[i];
        weight += w[i];
    }
    return sum / weight;
}

static void blend_far(const struct hf_frame *f, struct hf_phase p, float coc, float *const colour[4], int i)
{
    const struct hf_buf *far = &f->buf[HF_BUF_FAR_FILL];
    float w[4];
    if (hf_chapter(f->s)->faithful) {
        far_weights_faithful(&f->buf[HF_BUF_COC4], p, coc, w);
        // Colour taps (k, k) for an even pixel, (k, k + 1) for an odd one.
        p = (struct hf_phase){p.x, p.y, hf_max(p.x, p.nx), hf_max(p.y, p.ny)};
    } else
        coc = far_weights(&f->buf[HF_BUF_COC4], p, coc, w);
    const float t = hf_fields(f->s)->blend * coc;
    for (int c = 0; c < f->s->channels && t != 0; c++) {
        const float v[4] = {*hf_at(far, c, p.x, p.y), *hf_at(far, c, p.nx, p.y), *hf_at(far, c, p.x, p.ny),
                            *hf_at(far, c, p.nx, p.ny)};
        const float own = hf_limited(colour[c][i], HF_BLENDED);
        float rest = own;  // less the far field
        for (int k = 0; k < 4 && c < 3; k++)
            rest -= w[k] * v[k];
        colour[c][i] = own - t * (c < 3 ? rest : rest - alpha_mean(w, v));
    }
}

static void blend_near(const struct hf_frame *f, struct hf_phase p, float *const colour[4], int i)
{
    hf_upsampling *up = hf_fields(f->s)->bicubic ? hf_upsample_cubic : hf_upsample;
    const float scale = hf_fields(f->s)->bicubic ? 1 : 1 / 16.0f;
    const float t = hf_fields(f->s)->blend * scale * up(&f->buf[HF_BUF_BLUR], 0, p);
    for (int c = 0; c < f->s->channels && t != 0; c++)
        colour[c][i] = hf_lerp(hf_limited(colour[c][i], HF_BLENDED), scale * up(&f->buf[HF_BUF_NEAR_FILL], c, p), t);
}

void hf_chapter_composite_c(const struct hf_frame *f, struct hf_rect r)
{
    hf_composite_with(f, r, blend_far, blend_near);
}
