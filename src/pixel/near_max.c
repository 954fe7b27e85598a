// SPDX-License-Identifier: BSD-3-Clause
// Near CoC max: the first half of the near field's outward blur, 2 max_x + 1 wide, then 2 max_y + 1 high. The first
// and the last value of a window are multiplied by the edge factor, which grows continuously from 0 as the radius
// reaches them.
#include "pixel/fields.h"

void hf_max_x_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_fields *g = hf_fields(f->s);
    const int m = g->max_x, bytes = hf_narrow_bytes(f->s->storage);
    for (int y = r.y0; y < r.y1; y++) {
        const float *in = hf_at(&f->buf[HF_BUF_COC4], g->near_coc, 0, y);
        for (int x = r.x0; x < r.x1; x++) {
            float v = g->edge_x * hf_larger(in[x - m], in[x + m]);
            for (int i = x - m + 1; i < x + m; i++)
                v = hf_larger(in[i], v);
            hf_narrow_store(f->s->storage, hf_narrow_at(&f->buf[HF_BUF_MAX_X], 0, x, y, bytes), v);
        }
    }
}

void hf_max_y_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_fields *g = hf_fields(f->s);
    const int m = g->max_y, bytes = hf_narrow_bytes(f->s->storage);
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++) {
            float most = 0;
            for (int i = y - m; i <= y + m; i++) {
                const float v = hf_narrow_load(f->s->storage, hf_narrow_at(&f->buf[HF_BUF_MAX_X], 0, x, i, bytes));
                most = hf_larger(i == y - m || i == y + m ? g->edge_y * v : v, most);
            }
            hf_narrow_store(f->s->storage, hf_narrow_at(&f->buf[HF_BUF_MAX], 0, x, y, bytes), most);
        }
}
