// SPDX-License-Identifier: BSD-3-Clause
// Near CoC max: the first half of the near field's outward blur, 2 max_x + 1 wide, then 2 max_y + 1 high.
#include "pass/pass_c.h"

void hf_max_x_c(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x;
    for (int y = r.y0; y < r.y1; y++) {
        const float *in = hf_at(&f->buf[HF_BUF_COC4], 0, 0, y);
        float *out = hf_at(&f->buf[HF_BUF_MAX_X], 0, 0, y);
        for (int x = r.x0; x < r.x1; x++) {
            float v = in[x - m];
            for (int i = x - m + 1; i <= x + m; i++)
                v = in[i] > v ? in[i] : v;
            out[x] = v;
        }
    }
}

void hf_max_y_c(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_y;
    const struct hf_buf *in = &f->buf[HF_BUF_MAX_X];
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++) {
            const float *p = hf_at(in, 0, x, y - m);
            float v = *p;
            for (int i = 0; i < 2 * m; i++) {
                p += in->stride;
                v = *p > v ? *p : v;
            }
            *hf_at(&f->buf[HF_BUF_MAX], 0, x, y) = v;
        }
}
