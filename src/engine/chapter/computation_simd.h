// SPDX-License-Identifier: BSD-3-Clause
// Computation on vectors.
#include <float.h>

#include "engine/chapter/chapter.h"
#include "engine/chapter/inverse_vf.h"
#include "engine/chapter/near_part_vf.h"
#include "pixel/coc_vf.h"
#include "pixel/convolve_simd.h"

// Whole rings at kernel scale 1, radius 4, 6 and 8: 12 pixels of a picture of 1080 lines, and the same at 720 and 1440.
static const uint16_t rings_4[] = {0x15, 0x1e, 0x1f, 0x0e, 0x07};
static const uint16_t rings_6[] = {0x55, 0x7e, 0x7f, 0x6e, 0x37, 0x3e, 0x0f};
static const uint16_t rings_8[] = {0x155, 0x1fe, 0x1ff, 0x1ee, 0x1f7, 0x0fe, 0x07f, 0x03e, 0x01f};
FIXED_COLUMN(rings_4, rings_4, 4, 0, NULL)
FIXED_COLUMN(rings_6, rings_6, 6, 0, NULL)
FIXED_COLUMN(rings_8, rings_8, 8, 0, NULL)

static int rings_are(const struct hf_taps *t, const uint16_t *rows, int r)
{
    if (!fixed_are(t, rows, r, 0))
        return 0;
    // Taps on the axes hit lattice points, all with one weight; see fixed_sum.
    for (int i = 2; i <= r; i += 2)
        if (t->weight[t->first[i]] != t->weight[1] || t->weight[i / 2] != t->weight[1])
            return 0;
    return 1;
}

// Convolves where a buffer says that there is need.
static void convolve_needed(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, struct convolve_job *j,
                            int need, int channel, hf_kernel *finish)
{
    fixed_column *column = rings_are(t, rings_6, 6)   ? rings_6_column
                           : rings_are(t, rings_4, 4) ? rings_4_column
                           : rings_are(t, rings_8, 8) ? rings_8_column
                                                      : NULL;
    job_needs(j, f, r, need, channel);
    convolve_jobs(f, r, t, column, f->work, j, 1, finish);
}

static void weigh_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach taps = hf_chapter_halo(f->s, HF_HALO_TAPS);
    const int rx = taps.x, ry = taps.y, n = r.x1 - r.x0 + 2 * rx, channels = f->s->channels;
    for (int y = r.y0 - ry; y < r.y1 + ry && !hf_stopped(f->s->stop); y++) {
        float *colour[4], *far[4], *coc[4], *weight[4], *colour_w[4], *far_w[4];
        hf_row(&f->buf[HF_BUF_COLOR4], channels, r.x0 - rx, y, colour);
        hf_row(&f->buf[HF_BUF_COLORFAR4], channels, r.x0 - rx, y, far);
        hf_row(&f->buf[HF_BUF_COC4], 2, r.x0 - rx, y, coc);
        hf_row(&f->buf[HF_BUF_WEIGHT], 2, r.x0 - rx, y, weight);
        hf_row(&f->buf[HF_BUF_COLORW4], channels, r.x0 - rx, y, colour_w);
        hf_row(&f->buf[HF_BUF_COLORFARW4], channels, r.x0 - rx, y, far_w);
        for (int x = 0; x < n; x += VF_N) {
            vf luma = vf_mul(vf_set1(0.2126f), vf_load(colour[0] + x));
            luma = vf_fma(vf_set1(0.7152f), vf_load(colour[1] + x), luma);
            luma = vf_fma(vf_set1(0.0722f), vf_load(colour[2] + x), luma);
            const vf w = vf_div(vf_set1(1), vf_add(vf_set1(1), vf_max(luma, vf_zero())));
            vf_store(weight[0] + x, w);
            vf_store(weight[1] + x, vf_mul(vf_load(coc[1] + x), w));
            for (int c = 0; c < channels; c++) {
                vf_store(colour_w[c] + x, vf_mul(vf_load(colour[c] + x), w));
                vf_store(far_w[c] + x, vf_mul(vf_load(far[c] + x), w));
            }
        }
    }
}

// The gathered mean where there is near CoC, else the pixel's own colour.
static void finish_near(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    for (int y = r.y0; y < r.y1; y++) {
        float *near[4], *colour[4];
        const float *sum = hf_fields(s)->karis ? hf_at(&f->buf[HF_BUF_SUM], 0, r.x0, y) : NULL;
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        hf_row(&f->buf[HF_BUF_COLOR4], s->channels, r.x0, y, colour);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf coc = vf_load(blur + x);
            for (int c = 0; c < s->channels; c++) {
                vf v = vf_load(near[c] + x);
                if (sum)
                    v = vf_div(v, vf_load(sum + x));
                vf_store(
                    near[c] + x,
                    round_stored(s->storage, near_part_vf(hf_chapter(s)->faithful, vf_load(colour[c] + x), v, coc), c));
            }
        }
    }
}

static void near_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    struct convolve_job j = {.planes = 0};
    for (int c = 0; c < s->channels; c++)
        convolve_plane(&j, f, r, hf_fields(s)->karis ? HF_BUF_COLORW4 : HF_BUF_COLOR4, c, HF_BUF_NEAR, c);
    if (hf_fields(s)->karis)
        convolve_plane(&j, f, r, HF_BUF_WEIGHT, 0, HF_BUF_SUM, 0);
    convolve_needed(f, r, &hf_chapter_taps(s, HF_NEAR)->taps, &j, HF_BUF_BLUR, 0, finish_near);
}

// Four bilinear neighbours of VF_N pixels, wherever they are.
HF_INLINE vf sample_simd(const float *p, ptrdiff_t stride, vi index, vf ax, vf ay)
{
    const vf a = vf_gather(p, index), b = vf_gather(p + 1, index);
    const vf c = vf_gather(p + stride, index), d = vf_gather(p + stride + 1, index);
    const vf top = vf_fma(ax, vf_sub(b, a), a), bottom = vf_fma(ax, vf_sub(d, c), c);
    return vf_fma(ay, vf_sub(bottom, top), top);
}

// Offset of (fx, fy) in a plane; exact in float, all are integers below 2^24.
HF_INLINE vi tap_index(vf fx, vf fy, ptrdiff_t stride, vi lane)
{
    return vi_add(vf_to_vi(vf_add(vf_mul(fy, vf_set1((float)stride)), fx)), lane);
}

// The per-pixel kernel: every lane has taps of its own.
static void sample_taps_simd(const struct hf_frame *f, struct hf_rect r, const struct hf_buf *colour,
                             const struct hf_buf *weight)
{
    static const int32_t lanes[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const struct hf_tap_set *t = hf_chapter_taps(f->s, HF_FAR);
    const vi lane = vi_load(lanes);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < r.x1; x += VF_N) {
            // Lanes past the row's end hold anything; within 0..1 they read nothing but the buffers.
            const vf scale = vf_saturate(vf_load(hf_at(&f->buf[HF_BUF_COC4], 1, x, y)));
            vf total[5] = {vf_zero(), vf_zero(), vf_zero(), vf_zero(), vf_zero()}, sum[5];
            for (int i = 0; i < t->count; i++) {
                if (i % 8 == 0)
                    for (int c = 0; c < 5; c++)
                        sum[c] = vf_zero();
                const vf dx = vf_mul(vf_set1(t->dx[i]), scale), dy = vf_mul(vf_set1(t->dy[i]), scale);
                const vf share = vf_set1(t->share[i]);
                const vf fx = vf_floor(dx), fy = vf_floor(dy);
                const vf ax = vf_sub(dx, fx), ay = vf_sub(dy, fy);
                const vi at = tap_index(fx, fy, colour->stride, lane);
                for (int c = 0; c < f->s->channels; c++)
                    sum[c] = vf_fma(share, sample_simd(hf_at(colour, c, x, y), colour->stride, at, ax, ay), sum[c]);
                sum[4] = vf_fma(share,
                                sample_simd(hf_at(weight, 1, x, y), weight->stride,
                                            tap_index(fx, fy, weight->stride, lane), ax, ay),
                                sum[4]);
                if (i % 8 == 7 || i == t->count - 1)
                    for (int c = 0; c < 5; c++)
                        total[c] = vf_add(total[c], sum[c]);
            }
            for (int c = 0; c < f->s->channels; c++)
                vf_store(hf_at(&f->buf[HF_BUF_FAR], c, x, y), total[c]);
            vf_store(hf_at(&f->buf[HF_BUF_SUM], 1, x, y), total[4]);
        }
}

// Sums of colour over the sum of weights.
static void finish_far(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const enum hf_division division = hf_chapter(s)->division;
    for (int y = r.y0; y < r.y1; y++) {
        float *far[4];
        const float *sum = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), *coc = hf_at(&f->buf[HF_BUF_COC4], 1, r.x0, y);
        hf_row(&f->buf[HF_BUF_FAR], s->channels, r.x0, y, far);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf own = vf_load(coc + x), total = vf_load(sum + x);
            const vm is_far = vf_gt(own, vf_zero()), alone = vm_and(is_far, vm_not(vf_gt(total, vf_zero())));
            const vf inverse = inverse_vf(division, vf_max(total, vf_set1(FLT_MIN)));
            for (int c = 0; c < s->channels; c++) {
                const vf v = vf_load(far[c] + x), mean = c == 3 ? vf_div(v, total) : vf_mul(v, inverse);
                vf_store(far[c] + x, round_stored(s->storage, vf_keep(is_far, mean), c));
            }
            if (vm_any(alone))
                for (int c = 0; c < s->channels; c++) {
                    const vf v = vf_div(vf_load(hf_at(&f->buf[HF_BUF_COLORFAR4], c, r.x0 + x, y)), own);
                    vf_store(far[c] + x, round_stored(s->storage, vf_select(alone, v, vf_load(far[c] + x)), c));
                }
        }
    }
}

static void far_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const int colour = hf_fields(s)->karis ? HF_BUF_COLORFARW4 : HF_BUF_COLORFAR4;
    const int weight = hf_fields(s)->karis ? HF_BUF_WEIGHT : HF_BUF_COC4;
    if (hf_fields(s)->per_pixel_kernel) {
        sample_taps_simd(f, r, &f->buf[colour], &f->buf[weight]);
        finish_far(f, r);
        return;
    }
    struct convolve_job j = {.planes = 0};
    for (int c = 0; c < s->channels; c++)
        convolve_plane(&j, f, r, colour, c, HF_BUF_FAR, c);
    convolve_plane(&j, f, r, weight, 1, HF_BUF_SUM, 1);
    convolve_needed(f, r, &hf_chapter_taps(s, HF_FAR)->taps, &j, HF_BUF_COC4, 1, finish_far);
}

static void computation_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (hf_fields(f->s)->karis)
        weigh_simd(f, r);
    if (f->near)
        near_simd(f, r);
    if (f->far)
        far_simd(f, r);
}
