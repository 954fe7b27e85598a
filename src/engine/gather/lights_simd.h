// SPDX-License-Identifier: BSD-3-Clause
// What samples weigh, on vectors: with Karis average, and lights behind near pixels as in lights.c.
#include "engine/gather/gather.h"
#include "simd/simd.h"

static void area_weigh(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach reach = hf_gather_halo(f->s, HF_HALO_TAPS);
    const int x0 = r.x0 - reach.x, n = r.x1 + reach.x - x0;
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y && !hf_stopped(f->s->stop); y++) {
        float *colour[4], *out = hf_at(&f->buf[HF_BUF_WEIGHT], 0, x0, y);
        hf_row(&f->buf[HF_BUF_COLOR4], 3, x0, y, colour);
        for (int x = 0; x < n; x += VF_N) {
            vf luma = vf_mul(vf_set1(0.2126f), vf_load(colour[0] + x));
            luma = vf_fma(vf_set1(0.7152f), vf_load(colour[1] + x), luma);
            luma = vf_fma(vf_set1(0.0722f), vf_load(colour[2] + x), luma);
            vf_store(out + x, vf_div(vf_set1(1), vf_add(vf_set1(1), vf_max(luma, vf_zero()))));
        }
    }
}

static void area_largest_row(const struct hf_frame *f, int x0, int n, int y)
{
    const int width = f->s->half_width;
    float *colour[4], *out = hf_at(&f->buf[HF_BUF_WEIGHT], 1, x0, y);
    hf_row(&f->buf[HF_BUF_COLOR4], 3, x0, y, colour);
    for (int x = 0; x < n; x += VF_N)
        vf_store(out + x, vf_max(vf_max(vf_load(colour[0] + x), vf_load(colour[1] + x)), vf_load(colour[2] + x)));
    const int beyond = y < 0 || y >= f->s->half_height;
    for (int x = 0; x < (beyond ? n : hf_min(n, -x0)); x++)
        out[x] = HF_AREA_LARGEST;
    for (int x = hf_max(width - x0, 0); x < n; x++)
        out[x] = HF_AREA_LARGEST;
}

// As far as these taps reach.
static void area_lights(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t)
{
    const struct hf_buf *b = &f->buf[HF_BUF_WEIGHT];
    const int apart = hf_gather(f->s)->lights;
    const struct hf_reach reach = {t->rx + apart, t->ry + apart};
    const int x0 = r.x0 - reach.x, n = r.x1 + reach.x - x0;
    for (int y = r.y0 - reach.y; y < r.y1 + reach.y && !hf_stopped(f->s->stop); y++)
        area_largest_row(f, x0, n, y);
    for (int y = r.y0 - reach.y + apart; y < r.y1 + reach.y - apart && !hf_stopped(f->s->stop); y++) {
        const float *at = hf_at(b, 1, x0 + apart, y), *up = at - apart * b->stride, *down = at + apart * b->stride;
        float *out = hf_at(b, 2, x0 + apart, y);
        for (int x = 0; x < n - 2 * apart; x += VF_N) {
            const vf sides = vf_min(vf_load(at + x - apart), vf_load(at + x + apart));
            const vf beside = vf_max(sides, vf_min(vf_load(up + x), vf_load(down + x)));
            const vf most = vf_max(vf_mul(vf_set1(HF_LIGHT), beside), vf_zero()), own = vf_load(at + x);
            vf_store(out + x, vf_select(vf_gt(own, most), vf_div(most, own), vf_set1(1)));
        }
    }
}
