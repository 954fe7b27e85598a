// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur: a box as wide as the max before it, so that the near field's edge ramps over twice the reach.
#include "pass/pass_c.h"

// Sum of the 2m + 1 values around p: the centre plus windows of 2^i values, laid outwards from the ends to the
// centre on both sides alike. Each window is summed as a balanced tree. So nothing drifts as a running sum would,
// and a mirrored row gives the mirrored bits. The vector version shares the windows between neighbours.
static float window(const float *p, ptrdiff_t step, int size)
{
    return size == 1 ? *p : window(p, step, size / 2) + window(p + step * (size / 2), step, size / 2);
}

static float box(const float *p, ptrdiff_t step, int m)
{
    float sum = *p;
    int covered = 0;  // next to the centre
    for (int size = 1; size <= m; size *= 2)
        if (m & size) {
            const float *right = p + step * (covered + 1), *left = p - step * (covered + size);
            sum += window(left, step, size) + window(right, step, size);
            covered += size;
        }
    return sum;
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
