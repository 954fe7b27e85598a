// SPDX-License-Identifier: BSD-3-Clause
// Near CoC max on vectors. Maxima of 2, 4, 8 ... values come from each other, and two overlapping ones of those cover
// any width: 4 maxima a value for 13, 5 for 25.

// Largest power of two <= 2m + 1.
HF_INLINE int max_span(int m)
{
    int span = 1;
    while (2 * span <= 2 * m + 1)
        span *= 2;
    return span;
}

static void max_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x, span = max_span(m), n = r.x1 - r.x0 + 2 * m;
    float *row = hf_line(f, 0);
    for (int y = r.y0; y < r.y1; y++) {
        const float *in = hf_at(&f->buf[HF_BUF_COC4], 0, r.x0 - m, y);
        float *out = hf_at(&f->buf[HF_BUF_MAX_X], 0, r.x0, y);
        for (int len = 1; len < span; len *= 2) {
            // In place: a value is read for the last time when it is replaced.
            for (int x = 0; x < n - 2 * len + 1; x += VF_N)
                vf_store(row + x, vf_max(vf_load(in + x + len), vf_load(in + x)));
            in = row;
        }
        for (int x = 0; x < r.x1 - r.x0; x += VF_N)
            vf_store(out + x, vf_max(vf_load(in + x + 2 * m + 1 - span), vf_load(in + x)));
    }
}

// Columns are worked off in strips whose rows stay in the first-level cache.
enum { NEAR_STRIP = 32 };

static void max_y_strip(const struct hf_frame *f, struct hf_rect r, float *rows)
{
    const int m = f->s->max_y, span = max_span(m), width = r.x1 - r.x0, n = r.y1 - r.y0 + 2 * m;
    const struct hf_buf *b = &f->buf[HF_BUF_MAX_X];
    const float *in = hf_at(b, 0, r.x0, r.y0 - m);
    ptrdiff_t stride = b->stride;
    for (int len = 1; len < span; len *= 2) {
        for (int y = 0; y < n - 2 * len + 1; y++)
            for (int x = 0; x < width; x += VF_N)
                vf_store(rows + y * NEAR_STRIP + x,
                         vf_max(vf_load(in + (y + len) * stride + x), vf_load(in + y * stride + x)));
        in = rows;
        stride = NEAR_STRIP;
    }
    for (int y = 0; y < r.y1 - r.y0; y++)
        for (int x = 0; x < width; x += VF_N)
            vf_store(hf_at(&f->buf[HF_BUF_MAX], 0, r.x0 + x, r.y0 + y),
                     vf_max(vf_load(in + (y + 2 * m + 1 - span) * stride + x), vf_load(in + y * stride + x)));
}

static void max_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int x = r.x0; x < r.x1; x += NEAR_STRIP)
        max_y_strip(f, (struct hf_rect){x, r.y0, hf_min(x + NEAR_STRIP, r.x1), r.y1}, f->work);
}
