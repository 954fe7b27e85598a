// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur: a box as wide as the max before it, so that the near field's edge ramps over twice the reach. Its first and
// last value count as much as there.
#include "pixel/fields.h"

// Sum of `size` values from p on, made of its two halves and, if that is odd, the value between them. step: bytes.
static float window(enum hf_storage storage, const char *p, ptrdiff_t step, int size)
{
    if (size == 1)
        return hf_narrow_load(storage, p);
    const int half = size / 2;
    const float ends = window(storage, p, step, half) + window(storage, p + step * (size - half), step, half);
    return size & 1 ? ends + hf_narrow_load(storage, p + step * half) : ends;
}

// Mean of the 2m + 1 values around p, m > 0: the centre, and the sum of the windows to its left and right, less what the
// outermost do not count. All this is the same from right to left, so that a mirrored row gives the mirrored bits; and
// nothing drifts, as a running sum would. The vector version shares the windows between neighbours.
static float mean(enum hf_storage storage, const char *p, ptrdiff_t step, int m, float edge)
{
    const float ends = window(storage, p - step * m, step, m) + window(storage, p + step, step, m);
    const float last = hf_narrow_load(storage, p - step * m) + hf_narrow_load(storage, p + step * m);
    return ((hf_narrow_load(storage, p) + ends) - (1 - edge) * last) * hf_blur_scale(m, edge);
}

// Of bytes, in whole numbers: floor(mean + 1/2), which is what hf_round_coc makes of the exact mean. An odd number of
// bytes has no mean halfway between two: the nearest is half a byte divided by their number away.
static int mean_byte(const uint8_t *p, ptrdiff_t step, int m, float edge)
{
    int sum = 0;
    for (int i = -m; i <= m; i++)
        sum += p[step * i];
    if (edge < 1)
        return (int)(((float)sum - (1 - edge) * (float)(p[-step * m] + p[step * m])) * hf_blur_scale(m, edge) + 0.5f);
    return (sum + m) / (2 * m + 1);
}

static float blurred(enum hf_storage storage, const char *p, ptrdiff_t step, int m, float edge)
{
    if (storage == HF_STORAGE_PACKED)
        return (float)mean_byte((const uint8_t *)p, step, m, edge) * (1 / 255.0f);
    return hf_round_coc(storage, mean(storage, p, step, m, edge));
}

void hf_blur_x_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *in = &f->buf[HF_BUF_MAX], *out = &f->buf[HF_BUF_BLUR_X];
    const struct hf_fields *g = hf_fields(f->s);
    const enum hf_storage storage = f->s->storage;
    const int bytes = hf_narrow_bytes(storage);
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++)
            hf_narrow_store(storage, hf_narrow_at(out, 0, x, y, bytes),
                            blurred(storage, hf_narrow_at(in, 0, x, y, bytes), bytes, g->blur_x, g->edge_x));
}

void hf_blur_y_c(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *in = &f->buf[HF_BUF_BLUR_X];
    const struct hf_fields *g = hf_fields(f->s);
    const int bytes = hf_narrow_bytes(f->s->storage);
    const ptrdiff_t step = in->stride * (ptrdiff_t)sizeof(float);
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++)
            *hf_at(&f->buf[HF_BUF_BLUR], 0, x, y) =
                blurred(f->s->storage, hf_narrow_at(in, 0, x, y, bytes), step, g->blur_y, g->edge_y);
}
