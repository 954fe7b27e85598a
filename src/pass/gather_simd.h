// SPDX-License-Identifier: BSD-3-Clause
// Computation on vectors.
//
// Per input row the pairs h[j] = in[x - j] + in[x + j] are formed once, then a row sum per distinct row of weights,
// r[k] = sum over j of w[k][j] h[j]; an output row is the sum of 2 ry + 1 of those. 44 multiplications a pixel and
// plane at the default reach where the 48 bilinear taps would load 192 values. Row sums are made KB at a time for S
// vectors side by side, so that a broadcast weight serves S products and a loaded h serves KB. A strip's row sums (12
// KB) stay in the first-level cache.
#include <float.h>

#if VF_REGISTERS == 32
enum { GATHER_S = 4, GATHER_KB = 4 };
#else
enum { GATHER_S = 3, GATHER_KB = 4 };
#endif

// r[k0 .. k0 + kb): row sums of one input row, from its pairs h. Rows of h and r are S vectors.
HF_INLINE void row_sums(const float *w, int row, const int *width, const int kb, const int s, int k0,
                        const float *h, float *r)
{
    vf acc[GATHER_KB][GATHER_S];
    int columns = 0;
    for (int k = 0; k < kb; k++)
        columns = hf_max(columns, width[k0 + k]);
    for (int k = 0; k < kb; k++)
        for (int v = 0; v < s; v++)
            acc[k][v] = vf_mul(vf_set1(w[(k0 + k) * row]), vf_load(h + v * VF_N));
    for (int j = 1; j < columns; j++) {
        h += s * VF_N;
        vf pair[GATHER_S];
        for (int v = 0; v < s; v++)
            pair[v] = vf_load(h + v * VF_N);
        for (int k = 0; k < kb; k++) {
            const vf weight = vf_set1(w[(k0 + k) * row + j]);
            for (int v = 0; v < s; v++)
                acc[k][v] = vf_fma(weight, pair[v], acc[k][v]);
        }
    }
    for (int k = 0; k < kb; k++)
        for (int v = 0; v < s; v++)
            vf_store(r + ((k0 + k) * s + v) * VF_N, acc[k][v]);
}

// All row sums k in [k0, k1) of an input row.
HF_INLINE void all_row_sums(const struct hf_taps *t, const int s, int k0, int k1, const float *h, float *r)
{
    int k = k0;
    for (; k + GATHER_KB <= k1; k += GATHER_KB)
        row_sums(t->weight, t->row, t->width, GATHER_KB, s, k, h, r);
    if (k1 - k == 3)
        row_sums(t->weight, t->row, t->width, 3, s, k, h, r);
    else if (k1 - k == 2)
        row_sums(t->weight, t->row, t->width, 2, s, k, h, r);
    else if (k1 - k == 1)
        row_sums(t->weight, t->row, t->width, 1, s, k, h, r);
}

// S vectors of columns from x0, all rows of r.
HF_INLINE void convolve_strip(const struct hf_taps *t, const struct hf_buf *in, int c_in, const struct hf_buf *out,
                              int c_out, int x0, int y0, int y1, const int s, float *work)
{
    const int columns = t->symmetric ? t->rx + 1 : 2 * t->rx + 1, rows = t->symmetric ? t->ry + 1 : 2 * t->ry + 1;
    const int ring = 2 * t->ry + 1, step = s * VF_N;
    float *h = work, *sums = work + columns * step;
    for (int y = y0 - t->ry; y < y1 + t->ry; y++) {
        const float *p = hf_at(in, c_in, x0, y);
        for (int j = 0; j < columns; j++)
            for (int v = 0; v < s; v++) {
                const float *q = p + v * VF_N;
                vf pair;
                if (t->symmetric)
                    pair = j ? vf_add(vf_load(q - j), vf_load(q + j)) : vf_load(q);
                else
                    pair = vf_load(q + j - t->rx);
                vf_store(h + j * step + v * VF_N, pair);
            }
        // Only the row sums that an output row will read: near the ends of the strip those of far rows.
        float *r = sums + (size_t)((y - y0 + t->ry) % ring) * rows * step;
        int k0, k1;
        if (t->symmetric) {
            k0 = hf_max(0, hf_max(y0 - y, y - (y1 - 1)));
            k1 = rows;
        } else {
            k0 = hf_max(0, y - (y1 - 1) + t->ry);
            k1 = hf_min(rows, y - y0 + t->ry + 1);
        }
        all_row_sums(t, s, k0, k1, h, r);

        const int oy = y - t->ry;
        if (oy < y0)
            continue;
        for (int v = 0; v < s; v++) {
            vf acc = vf_zero();
            for (int dy = -t->ry, slot = (oy - y0) % ring; dy <= t->ry; dy++, slot = slot + 1 == ring ? 0 : slot + 1) {
                const int k = t->symmetric ? (dy < 0 ? -dy : dy) : dy + t->ry;
                const vf sum = vf_load(sums + ((size_t)slot * rows + k) * step + v * VF_N);
                acc = vf_add(acc, sum);
            }
            vf_store(hf_at(out, c_out, x0 + v * VF_N, oy), acc);
        }
    }
}

static void convolve_simd(const struct hf_frame *f, struct hf_rect r, enum hf_buf_id in, int c_in,
                          enum hf_buf_id out, int c_out)
{
    const struct hf_taps *t = f->s->taps;
    const struct hf_buf *a = &f->buf[in], *b = &f->buf[out];
    int x = r.x0;
    for (; x + (GATHER_S - 1) * VF_N < r.x1; x += GATHER_S * VF_N)
        convolve_strip(t, a, c_in, b, c_out, x, r.y0, r.y1, GATHER_S, f->work);
    for (; x < r.x1; x += VF_N)
        convolve_strip(t, a, c_in, b, c_out, x, r.y0, r.y1, 1, f->work);
}

static void weigh_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int rx = f->s->taps->rx, ry = f->s->taps->ry, n = r.x1 - r.x0 + 2 * rx, channels = f->s->channels;
    for (int y = r.y0 - ry; y < r.y1 + ry; y++) {
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

static void gather_near_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    for (int c = 0; c < s->channels; c++)
        convolve_simd(f, r, s->karis ? HF_BUF_COLORW4 : HF_BUF_COLOR4, c, HF_BUF_NEAR, c);
    if (s->karis)
        convolve_simd(f, r, HF_BUF_WEIGHT, 0, HF_BUF_SUM, 0);
    for (int y = r.y0; y < r.y1; y++) {
        float *near[4];
        const float *sum = s->karis ? hf_at(&f->buf[HF_BUF_SUM], 0, r.x0, y) : NULL;
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        for (int c = 0; c < s->channels; c++) {
            const float *colour = hf_at(&f->buf[HF_BUF_COLOR4], c, r.x0, y);
            for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
                vf v = vf_load(near[c] + x);
                if (sum)
                    v = vf_div(v, vf_load(sum + x));
                vf_store(near[c] + x,
                         vf_select(vf_gt(vf_load(blur + x), vf_zero()), v, vf_load(colour + x)));
            }
        }
        hf_store_rgb(f, near, r.x1 - r.x0);
    }
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
    const struct hf_taps *t = f->s->taps;
    const vi lane = vi_load(lanes);
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x += VF_N) {
            // Lanes past the row's end hold anything; within 0..1 they read nothing but the buffers.
            const vf scale = coc_saturate(vf_load(hf_at(&f->buf[HF_BUF_COC4], 1, x, y)));
            vf sum[5] = {vf_zero(), vf_zero(), vf_zero(), vf_zero(), vf_zero()};
            for (int i = 0; i < t->count; i++) {
                const vf dx = vf_mul(vf_set1(t->dx[i]), scale), dy = vf_mul(vf_set1(t->dy[i]), scale);
                const vf fx = vf_floor(dx), fy = vf_floor(dy);
                const vf ax = vf_sub(dx, fx), ay = vf_sub(dy, fy);
                const vi at = tap_index(fx, fy, colour->stride, lane);
                for (int c = 0; c < f->s->channels; c++)
                    sum[c] = vf_add(sum[c], sample_simd(hf_at(colour, c, x, y), colour->stride, at, ax, ay));
                sum[4] = vf_add(sum[4], sample_simd(hf_at(weight, 1, x, y), weight->stride,
                                                    tap_index(fx, fy, weight->stride, lane), ax, ay));
            }
            for (int c = 0; c < f->s->channels; c++)
                vf_store(hf_at(&f->buf[HF_BUF_FAR], c, x, y), sum[c]);
            vf_store(hf_at(&f->buf[HF_BUF_SUM], 1, x, y), sum[4]);
        }
}

static void gather_far_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const enum hf_buf_id colour = s->karis ? HF_BUF_COLORFARW4 : HF_BUF_COLORFAR4;
    const enum hf_buf_id weight = s->karis ? HF_BUF_WEIGHT : HF_BUF_COC4;
    if (s->per_pixel_kernel) {
        sample_taps_simd(f, r, &f->buf[colour], &f->buf[weight]);
    } else {
        for (int c = 0; c < s->channels; c++)
            convolve_simd(f, r, colour, c, HF_BUF_FAR, c);
        convolve_simd(f, r, weight, 1, HF_BUF_SUM, 1);
    }
    for (int y = r.y0; y < r.y1; y++) {
        float *far[4];
        const float *sum = hf_at(&f->buf[HF_BUF_SUM], 1, r.x0, y), *coc = hf_at(&f->buf[HF_BUF_COC4], 1, r.x0, y);
        hf_row(&f->buf[HF_BUF_FAR], s->channels, r.x0, y, far);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf divisor = vf_max(vf_load(sum + x), vf_set1(FLT_MIN));
            const vm is_far = vf_gt(vf_load(coc + x), vf_zero());
            for (int c = 0; c < s->channels; c++)
                vf_store(far[c] + x, vf_keep(is_far, vf_div(vf_load(far[c] + x), divisor)));
        }
        hf_store_rgb(f, far, r.x1 - r.x0);
    }
}

static void gather_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (f->s->karis)
        weigh_simd(f, r);
    if (f->near)
        gather_near_simd(f, r);
    if (f->far)
        gather_far_simd(f, r);
}
