// SPDX-License-Identifier: BSD-3-Clause
// CoC generation: near and far CoC of every pixel of a chunk, in even and odd lanes.
#include "engine/gather/gather.h"

// Most of most pictures is sharp or has been looked at before: two comparisons a pixel say so.
static int is_sharp(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++)
        if (!f->k->sharp_row(f, r.x0, y, r.x1 - r.x0))
            return 0;
    return 1;
}

// r in half-resolution pixels: the rows 2y and 2y + 1 of each.
void hf_gather_coc(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *b = &f->buf[HF_BUF_COC];
    if (f->looking && is_sharp(f, r)) {
        f->counts->sharp_pixels += (uint64_t)(hf_min(2 * r.x1, f->s->width) - 2 * r.x0) *
                                   (uint64_t)(hf_min(2 * r.y1, f->s->height) - 2 * r.y0);
        return;
    }
    for (int y = 2 * r.y0; y < hf_min(2 * r.y1, f->s->height) && !hf_stopped(f->s->stop); y++) {
        float *const out[4] = {hf_at(b, 0, r.x0, y), hf_at(b, 1, r.x0, y), hf_at(b, 2, r.x0, y), hf_at(b, 3, r.x0, y)};
        f->k->coc_row(f, r.x0, y, r.x1 - r.x0, out, f->counts);
        hf_count_row(f->counts, y);
    }
}
