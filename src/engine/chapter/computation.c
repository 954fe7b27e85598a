// SPDX-License-Identifier: BSD-3-Clause
// Computation: the near and the far field at half resolution.
//
// Near is the mean of the taps' colour. Far is the mean of colour x far CoC over the mean of far CoC, so that only
// what is far counts. Both are convolutions with the fixed weights of taps.c, plane by plane. A Karis average
// convolves weighted planes and divides by the sum of the weights. With a per-pixel kernel the far taps
// lie elsewhere for every pixel, and are sampled one by one.
#include <float.h>
#include <math.h>

#include "engine/chapter/chapter.h"

static void convolve(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, int in, int c_in, int out,
                     int c_out)
{
    hf_convolve_c(f, r, t, &f->buf[in], c_in, &f->buf[out], c_out);
}

// Karis average: planes of w = 1 / (1 + luminance) times what is to be averaged, wherever taps of r reach.
static void weigh(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach taps = hf_chapter_halo(f->s, HF_HALO_TAPS);
    const int rx = taps.x, ry = taps.y, n = r.x1 - r.x0 + 2 * rx;
    for (int y = r.y0 - ry; y < r.y1 + ry && !hf_stopped(f->s->stop); y++) {
        float *colour[4], *far[4], *coc[4], *weight[4], *colour_w[4], *far_w[4];
        hf_row(&f->buf[HF_BUF_COLOR4], f->s->channels, r.x0 - rx, y, colour);
        hf_row(&f->buf[HF_BUF_COLORFAR4], f->s->channels, r.x0 - rx, y, far);
        hf_row(&f->buf[HF_BUF_COC4], 2, r.x0 - rx, y, coc);
        hf_row(&f->buf[HF_BUF_WEIGHT], 2, r.x0 - rx, y, weight);
        hf_row(&f->buf[HF_BUF_COLORW4], f->s->channels, r.x0 - rx, y, colour_w);
        hf_row(&f->buf[HF_BUF_COLORFARW4], f->s->channels, r.x0 - rx, y, far_w);
        for (int x = 0; x < n; x++) {
            const float w = hf_karis_weight(colour[0][x], colour[1][x], colour[2][x]);
            weight[0][x] = w;
            weight[1][x] = coc[1][x] * w;
            for (int c = 0; c < f->s->channels; c++) {
                colour_w[c][x] = colour[c][x] * w;
                far_w[c][x] = far[c][x] * w;
            }
        }
    }
}

static void gather_near(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    for (int c = 0; c < s->channels; c++)
        convolve(f, r, &hf_chapter_taps(s, HF_NEAR)->taps, hf_fields(s)->karis ? HF_BUF_COLORW4 : HF_BUF_COLOR4, c,
                 HF_BUF_NEAR, c);
    if (hf_fields(s)->karis)
        convolve(f, r, &hf_chapter_taps(s, HF_NEAR)->taps, HF_BUF_WEIGHT, 0, HF_BUF_SUM, 0);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        float *near[4];
        const float *sum = hf_fields(s)->karis ? hf_at(&f->buf[HF_BUF_SUM], 0, r.x0, y) : NULL;
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        for (int c = 0; c < s->channels; c++) {
            const float *colour = hf_at(&f->buf[HF_BUF_COLOR4], c, r.x0, y);
            for (int x = 0; x < r.x1 - r.x0; x++)
                near[c][x] = hf_near_part(s, colour[x], sum ? near[c][x] / sum[x] : near[c][x], blur[x]);
        }
        hf_store_rgb(f, near, r.x1 - r.x0);
    }
}

static float bilinear(const float *p, ptrdiff_t stride, float ax, float ay)
{
    const float top = p[0] + ax * (p[1] - p[0]);
    const float bottom = p[stride] + ax * (p[stride + 1] - p[stride]);
    return top + ay * (bottom - top);
}

// The far sums of one pixel, tap offsets scaled by its own CoC. Eight taps at a time are summed apart, so that many of
// them round little.
static void sample_taps(const struct hf_frame *f, int x, int y, const struct hf_buf *colour,
                        const struct hf_buf *weight)
{
    const struct hf_tap_set *t = hf_chapter_taps(f->s, HF_FAR);
    const float scale = *hf_at(&f->buf[HF_BUF_COC4], 1, x, y);
    float total[5] = {0}, sum[5];
    for (int i = 0; i < t->count; i++) {
        if (i % 8 == 0)
            memset(sum, 0, sizeof sum);
        const float dx = t->dx[i] * scale, dy = t->dy[i] * scale, fx = floorf(dx), fy = floorf(dy);
        const float share = t->share[i];
        for (int c = 0; c < f->s->channels; c++)
            sum[c] += share * bilinear(hf_at(colour, c, x + (int)fx, y + (int)fy), colour->stride, dx - fx, dy - fy);
        sum[4] += share * bilinear(hf_at(weight, 1, x + (int)fx, y + (int)fy), weight->stride, dx - fx, dy - fy);
        if (i % 8 == 7 || i == t->count - 1)
            for (int c = 0; c < 5; c++)
                total[c] += sum[c];
    }
    for (int c = 0; c < f->s->channels; c++)
        *hf_at(&f->buf[HF_BUF_FAR], c, x, y) = total[c];
    *hf_at(&f->buf[HF_BUF_SUM], 1, x, y) = total[4];
}

static void gather_far(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int colour = hf_fields(s)->karis ? HF_BUF_COLORFARW4 : HF_BUF_COLORFAR4;
    const int weight = hf_fields(s)->karis ? HF_BUF_WEIGHT : HF_BUF_COC4;
    if (hf_fields(s)->per_pixel_kernel) {
        for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
            for (int x = r.x0; x < r.x1; x++)
                sample_taps(f, x, y, &f->buf[colour], &f->buf[weight]);
    } else {
        for (int c = 0; c < s->channels; c++)
            convolve(f, r, &hf_chapter_taps(s, HF_FAR)->taps, colour, c, HF_BUF_FAR, c);
        convolve(f, r, &hf_chapter_taps(s, HF_FAR)->taps, weight, 1, HF_BUF_SUM, 1);
    }
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        float *far[4];
        const float *sum = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), *coc = hf_at(&f->buf[HF_BUF_COC4], 1, r.x0, y);
        hf_row(&f->buf[HF_BUF_FAR], s->channels, r.x0, y, far);
        for (int c = 0; c < s->channels; c++) {
            const float *own = hf_at(&f->buf[HF_BUF_COLORFAR4], c, r.x0, y);
            for (int x = 0; x < r.x1 - r.x0; x++) {
                // FLT_MIN: a CoC so small that its weighted sum is 0. Without a tap on the centre there may be no far
                // CoC under any tap: then the pixel's own colour is all there is.
                const float inverse = 1 / (sum[x] > FLT_MIN ? sum[x] : FLT_MIN);
                const float part = c == 3 ? far[c][x] / sum[x] : far[c][x] * inverse;  // what is opaque stays so
                const float mean = sum[x] > 0 ? part : own[x] / coc[x];
                far[c][x] = coc[x] > 0 ? mean : 0;
            }
        }
        hf_store_rgb(f, far, r.x1 - r.x0);
    }
}

void hf_chapter_computation_c(const struct hf_frame *f, struct hf_rect r)
{
    if (hf_fields(f->s)->karis)
        weigh(f, r);
    if (f->near)
        gather_near(f, r);
    if (f->far)
        gather_far(f, r);
}
