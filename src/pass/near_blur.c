// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur: a box as wide as the max before it, so that the near field's edge ramps over twice the reach.
#include "pass/pass_c.h"

// Sum of `size` values from p on, made of its two halves and, if that is odd, the value between them.
static float window(const float *p, ptrdiff_t step, int size)
{
    if (size == 1)
        return *p;
    const int half = size / 2;
    const float ends = window(p, step, half) + window(p + step * (size - half), step, half);
    return size & 1 ? ends + p[step * half] : ends;
}

// Sum of the 2m + 1 values around p, m > 0: the centre, and the sum of the windows to its left and right. All this is the same
// from right to left, so that a mirrored row gives the mirrored bits; and nothing drifts, as a running sum would. The
// vector version shares the windows between neighbours.
static float box(const float *p, ptrdiff_t step, int m)
{
    return *p + (window(p - step * m, step, m) + window(p + step, step, m));
}

static void blur(const struct hf_frame *f, struct hf_rect r, const struct hf_buf *in, const struct hf_buf *out,
                 ptrdiff_t step, int m)
{
    const float scale = 1 / (float)(2 * m + 1);
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++)
            *hf_at(out, 0, x, y) = hf_round_coc(f->s->storage, box(hf_at(in, 0, x, y), step, m) * scale);
}

void hf_blur_x_c(const struct hf_frame *f, struct hf_rect r)
{
    blur(f, r, &f->buf[HF_BUF_MAX], &f->buf[HF_BUF_BLUR_X], 1, f->s->max_x);
}

void hf_blur_y_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *in = &f->buf[HF_BUF_BLUR_X];
    blur(f, r, in, &f->buf[HF_BUF_BLUR], in->stride, f->s->max_y);
}
