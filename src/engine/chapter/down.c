// SPDX-License-Identifier: BSD-3-Clause
// Downsample: half-resolution colour and near CoC for the near field, colour x far CoC and far CoC for the far one.
#include "engine/chapter/chapter.h"

// Weights of a 2x2 quad for the far field: like pixels count, relative to its top left one. The chapter has w00 =
// 1000 and w = 1 / (|df| + 0.001); a thousandth of that is w00 = 1 and w = 1 / (1000 |df| + 1), exactly 1 for equal
// CoC. One division: with d = 1 / w, the products of the other d's are in the weights' proportion.
static void quad_weights(enum hf_downsample how, const float f[4], float w[4])
{
    for (int t = 0; t < 4; t++)
        w[t] = how == HF_DOWNSAMPLE_LINEAR ? 0.25f : t == 0;
    if (how != HF_DOWNSAMPLE_BILATERAL)
        return;
    const float d1 = 1 + 1000 * __builtin_fabsf(f[0] - f[1]);
    const float d2 = 1 + 1000 * __builtin_fabsf(f[0] - f[2]);
    const float d3 = 1 + 1000 * __builtin_fabsf(f[0] - f[3]);
    const float p23 = d2 * d3;
    w[0] = d1 * p23;
    w[1] = p23;
    w[2] = d1 * d3;
    w[3] = d1 * d2;
    const float i = 1 / ((w[0] + w[1]) + (w[2] + w[3]));
    for (int t = 0; t < 4; t++)
        w[t] *= i;
}

static void down_row(const struct hf_frame *f, int y, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const enum hf_downsample how = hf_chapter(s)->downsample;
    const int n = r.x1 - r.x0, y1 = hf_min(2 * y + 1, s->height - 1);
    float *lane[2][2][4];  // [row][odd][channel]
    for (int i = 0; i < 16; i++)
        lane[i >> 3][i >> 2 & 1][i & 3] = hf_line(f, i);
    hf_read_colour(f, r.x0, 2 * y, n, lane[0][0], lane[0][1], f->seen);
    hf_read_colour(f, r.x0, y1, n, lane[1][0], lane[1][1], f->seen);

    const struct hf_buf *coc = &f->buf[HF_BUF_COC];
    float *colour[4], *far[4];
    hf_row(&f->buf[HF_BUF_COLOR4], s->channels, r.x0, y, colour);
    hf_row(&f->buf[HF_BUF_COLORFAR4], s->channels, r.x0, y, far);
    for (int x = 0; x < n; x++) {
        const float quad[4] = {*hf_at(coc, 2, r.x0 + x, 2 * y), *hf_at(coc, 3, r.x0 + x, 2 * y),
                               *hf_at(coc, 2, r.x0 + x, y1), *hf_at(coc, 3, r.x0 + x, y1)};
        float w[4];
        quad_weights(how, quad, w);
        for (int c = 0; c < s->channels; c++) {
            const float c00 = lane[0][0][c][x], c10 = lane[0][1][c][x];
            const float c01 = lane[1][0][c][x], c11 = lane[1][1][c][x];
            const float sum = 0.25f * ((c00 + c10) + (c01 + c11));
            f->counts->clamped += !(__builtin_fabsf(sum) <= HF_LARGEST);
            if (f->near)
                colour[c][x] = hf_limited(how == HF_DOWNSAMPLE_POINT ? c00 : sum, HF_LARGEST);
            if (f->far) {
                float mean = (w[0] * c00 + w[1] * c10) + (w[2] * c01 + w[3] * c11);
                if (c == 3)  // weights add up to 1 within rounding, and what is opaque stays so
                    mean /= (w[0] + w[1]) + (w[2] + w[3]);
                far[c][x] = hf_limited(mean, HF_LARGEST) * quad[0];
            }
        }
        if (f->near)
            *hf_at(&f->buf[HF_BUF_COC4], 0, r.x0 + x, y) = *hf_at(coc, 0, r.x0 + x, 2 * y);
        if (f->far)
            *hf_at(&f->buf[HF_BUF_COC4], 1, r.x0 + x, y) = quad[0];
    }
    if (f->near)
        hf_store_rgb(f, colour, n);
    if (f->far)
        hf_store_rgb(f, far, n);
}

void hf_chapter_down_c(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        down_row(f, y, r);
}
