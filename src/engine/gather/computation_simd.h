// SPDX-License-Identifier: BSD-3-Clause
// Computation on vectors.
//
// Per input row the pairs h[j] = in[x - j] + in[x + j] are formed once, then a row sum per distinct row of weights,
// r[k] = sum over j of w[k][j] h[j]; an output row is the sum of 2 ry + 1 of those. 36 multiplications a pixel and
// plane at the default reach where the 48 bilinear taps would load 192 values. Tap sets that are known when this is
// compiled are fixed_simd.h's. For all others columns are worked off in strips of up to GATHER_S vectors: enough
// independent sums to hide the latency of the multiply-add, one broadcast weight for all of them, and output rows that
// stay in the first-level cache.
#include "engine/gather/gather.h"
#include "engine/gather/inverse_vf.h"
#include "engine/gather/near_part_vf.h"
#include "pixel/coc_vf.h"
#include "pixel/format_vf.h"
#include <float.h>

#include "engine/gather/fixed_simd.h"

enum { GATHER_S = VF_N == 16 ? 5 : 9 };

// A weight and the byte offset of its pairs: what the inner loop needs, worked out once a strip.
struct gather_term {
    float weight;
    int32_t offset;
};

// One row sum from the pairs h (rows of s vectors), added to the output rows above and below. scale: NULL, or that of the
// one above, which is then complete.
HF_INLINE void row_sum(const struct gather_term *term, const struct gather_term *end, const int s, const float *h,
                       float *above, float *below, const float *scale)
{
    vf acc[GATHER_S];
#pragma GCC unroll 16
    for (int v = 0; v < s; v++)
        acc[v] = vf_zero();
    for (; term < end; term++) {
        const vf w = vf_set1(term->weight);
        const char *p = (const char *)h + term->offset;
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            acc[v] = vf_fma(w, vf_load(p + v * (int)sizeof(vf)), acc[v]);
    }
    if (above && scale)
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            vf_store(above + v * VF_N, vf_mul(vf_add(vf_load(above + v * VF_N), acc[v]), vf_set1(*scale)));
    else if (above)
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            vf_store(above + v * VF_N, vf_add(vf_load(above + v * VF_N), acc[v]));
    if (below)
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            vf_store(below + v * VF_N, vf_add(vf_load(below + v * VF_N), acc[v]));
}

// Rows of a frame lie on pages of their own, where no hardware prefetcher follows. Fetching ahead is worth some 4 % of
// the pass.
enum { GATHER_AHEAD = 6 };

HF_INLINE void prefetch_row(const float *p, int floats)
{
    for (int i = 0; i < floats + 15; i += 16)
        __builtin_prefetch(p + i);
}

// Pairs h[j] of an input row (or, without symmetry, its shifted values); of areas their sums from the middle on, too.
HF_INLINE void row_pairs(const float *p, int rx, const int symmetric, int runs, const int s, float *h)
{
    const float *pairs = h;
    if (!symmetric) {
        for (int j = -rx; j <= rx; j++, h += s * VF_N)
#pragma GCC unroll 16
            for (int v = 0; v < s; v++)
                vf_store(h + v * VF_N, vf_load(p + v * VF_N + j));
        return;
    }
#pragma GCC unroll 16
    for (int v = 0; v < s; v++)
        vf_store(h + v * VF_N, vf_load(p + v * VF_N));
    for (int j = 1; j <= rx; j++) {
        h += s * VF_N;
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            vf_store(h + v * VF_N, vf_add(vf_load(p + v * VF_N - j), vf_load(p + v * VF_N + j)));
    }
    if (!runs)
        return;
    vf sum[GATHER_S];
    h += s * VF_N;
#pragma GCC unroll 16
    for (int v = 0; v < s; v++)
        vf_store(h + v * VF_N, sum[v] = vf_load(pairs + v * VF_N));
    for (int j = 1; j <= rx; j++) {
        h += s * VF_N;
        pairs += s * VF_N;
#pragma GCC unroll 16
        for (int v = 0; v < s; v++)
            vf_store(h + v * VF_N, sum[v] = vf_add(sum[v], vf_load(pairs + v * VF_N)));
    }
}

// s vectors of columns. Each input row is spread over the output rows it reaches: those are sums that grow from top to
// bottom, and stay in the first-level cache while they do.
HF_INLINE void convolve_strip(const struct hf_taps *t, const float *in, ptrdiff_t in_stride, float *out,
                              ptrdiff_t out_stride, int height, const int symmetric, const int s,
                              const struct gather_term *terms, float *h, atomic_int *stop)
{
    const int ry = t->ry, step = s * VF_N;
    for (int y = -ry; y < height + ry && !hf_stopped(stop); y++) {
        prefetch_row(in + (y + GATHER_AHEAD) * in_stride - t->rx, step + 2 * t->rx);
        row_pairs(in + y * in_stride, t->rx, symmetric, t->runs, s, h);
        if (y + ry < height)  // reached for the first time
#pragma GCC unroll 16
            for (int v = 0; v < s; v++)
                vf_store(out + (y + ry) * out_stride + v * VF_N, vf_zero());
        for (int k = 0; k < t->rows; k++) {
            const int up = symmetric ? y - k : y - k + ry, down = y + k;
            float *above = up >= 0 && up < height ? out + up * out_stride : NULL;
            float *below = symmetric && k && down >= 0 && down < height ? out + down * out_stride : NULL;
            if (above || below)
                row_sum(terms + t->first[k], terms + t->first[k + 1], s, h, above, below,
                        k == t->rows - 1 && t->scale != 1 ? &t->scale : NULL);
        }
    }
}

enum { HF_JOB_PLANES = 7 };

// Planes to convolve together, and where: only rows with need > 0 are wanted, those within reach of some, or all.
struct gather_job {
    const float *in[HF_JOB_PLANES];
    float *out[HF_JOB_PLANES];
    ptrdiff_t in_stride[HF_JOB_PLANES], out_stride[HF_JOB_PLANES];
    int of_strip[HF_JOB_PLANES];  // out is a strip's own, see strip_plane
    int planes;
    const float *need;  // NULL: all
    ptrdiff_t need_stride;
    struct hf_reach reach;
    int clears;         // the other rows become 0
    const float *full;  // rows where gain times this is 1 throughout are not wanted after all; NULL: there are none
    ptrdiff_t full_stride;
    float gain;
    atomic_int *stop;
};

static void gather_plane(struct gather_job *j, const struct hf_frame *f, struct hf_rect r, enum hf_gather_buf in,
                         int c_in, enum hf_gather_buf out, int c_out)
{
    const int i = j->planes++;
    j->stop = f->s->stop;
    j->in[i] = hf_at(&f->buf[in], c_in, r.x0, r.y0);
    j->in_stride[i] = f->buf[in].stride;
    j->out[i] = hf_at(&f->buf[out], c_out, r.x0, r.y0);
    j->out_stride[i] = f->buf[out].stride;
}

// Sums that are used up strip by strip: a strip's rows, on lines that lie an odd number of cache lines apart, at the
// beginning of f->work.
static float *strip_plane(const struct hf_frame *f, int i, int height)
{
    return f->work + (ptrdiff_t)i * height * HF_STRIP;
}

static void gather_strip_plane(struct gather_job *j, const struct hf_frame *f, struct hf_rect r, enum hf_gather_buf in,
                               int c_in, int plane)
{
    const int i = j->planes++;
    j->stop = f->s->stop;
    j->in[i] = hf_at(&f->buf[in], c_in, r.x0, r.y0);
    j->in_stride[i] = f->buf[in].stride;
    j->out[i] = strip_plane(f, plane, r.y1 - r.y0);
    j->out_stride[i] = HF_STRIP;
    j->of_strip[i] = 1;
}

// Where column x of a strip that begins at column `from` goes.
HF_INLINE float *job_out(const struct gather_job *j, int i, int from, int x)
{
    return j->out[i] + (j->of_strip[i] ? x - from : x);
}

// Does a row of a strip have any need? Lanes past the row's end may hold anything, and NaN is no need.
HF_INLINE int row_needed(const float *need, const int s)
{
    vm any = vf_gt(vf_load(need), vf_zero());
#pragma GCC unroll 16
    for (int v = 1; v < s; v++)
        any = vm_or(any, vf_gt(vf_load(need + v * VF_N), vf_zero()));
    return vm_any(any);
}

// Is there any need in a row from reach before a strip to reach after it?
HF_INLINE int row_needed_around(const float *need, int reach, const int s)
{
    vm any = vf_gt(vf_load(need - reach), vf_zero());
    for (int x = VF_N - reach; x < s * VF_N + reach; x += VF_N)  // the last may reach a little further
        any = vm_or(any, vf_gt(vf_load(need + hf_min(x, (s - 1) * VF_N + reach)), vf_zero()));
    return vm_any(any);
}

HF_INLINE int row_full(const float *full, float gain, const int s)
{
    vf least = vf_load(full);
#pragma GCC unroll 16
    for (int v = 1; v < s; v++)
        least = vf_min(vf_load(full + v * VF_N), least);  // of NaN the other
    return !vm_any(vf_lt(vf_mul(vf_set1(gain), least), vf_set1(1)));
}

// The rows from the first to the last that a strip of s vectors from column x needs.
HF_INLINE void rows_reached(const struct gather_job *j, int x, int height, const int s, int *y0, int *y1)
{
    const int ry = j->reach.y;
    *y0 = 0;
    *y1 = height;
    if (!j->need)
        return;
    const float *p = j->need + x;
    if (!j->reach.x && !ry) {
        while (*y0 < *y1 && !row_needed(p + *y0 * j->need_stride, s))
            (*y0)++;
        while (*y1 > *y0 && !row_needed(p + (*y1 - 1) * j->need_stride, s))
            (*y1)--;
        return;
    }
    int first = -ry, last = height + ry;
    while (first < last && !row_needed_around(p + first * j->need_stride, j->reach.x, s))
        first++;
    while (last > first && !row_needed_around(p + (last - 1) * j->need_stride, j->reach.x, s))
        last--;
    *y0 = hf_max(first - ry, 0);
    *y1 = hf_max(hf_min(last + ry, height), *y0);
    if (first == last)
        *y1 = *y0;
}

HF_INLINE void rows_needed(const struct gather_job *j, int x, int height, const int s, int *y0, int *y1)
{
    rows_reached(j, x, height, s, y0, y1);
    if (!j->full)
        return;
    const float *p = j->full + x;
    while (*y0 < *y1 && row_full(p + *y0 * j->full_stride, j->gain, s))
        (*y0)++;
    while (*y1 > *y0 && row_full(p + (*y1 - 1) * j->full_stride, j->gain, s))
        (*y1)--;
}

// Zeros in the rows of a plane that are not needed.
HF_INLINE void clear_rest(const struct gather_job *j, int i, int from, int x, int height, const int s, int y0, int y1)
{
    float *out = job_out(j, i, from, x);
    for (int y = 0; j->clears && y < height; y++)
        for (int v = 0; v < s && (y < y0 || y >= y1); v++)
            vf_store(out + y * j->out_stride[i] + v * VF_N, vf_zero());
}

// A strip of s vectors from column x of all planes.
HF_INLINE void gather_strip(const struct hf_taps *t, const struct gather_job *j, int x, int height, const int symmetric,
                            const int s, float *work)
{
    struct gather_term *terms = (struct gather_term *)work;
    const int n = t->first[t->rows];
    float *h = work + ((2 * n + 15) & ~15);
    for (int i = 0; i < n; i++)
        terms[i] = (struct gather_term){t->weight[i], t->column[i] * s * (int)sizeof(vf)};
    int y0, y1;
    rows_needed(j, x, height, s, &y0, &y1);
    for (int i = 0; i < j->planes; i++)
        clear_rest(j, i, x, x, height, s, y0, y1);
    for (int i = 0; i < j->planes && y0 < y1; i++)
        convolve_strip(t, j->in[i] + y0 * j->in_stride[i] + x, j->in_stride[i],
                       job_out(j, i, x, x) + y0 * j->out_stride[i], j->out_stride[i], y1 - y0, symmetric, s, terms, h,
                       j->stop);
}

HF_INLINE void gather_any(const struct hf_taps *t, const struct gather_job *j, int x, int height, const int symmetric,
                          int s, float *work)
{
#define STRIP(n)                                                                                                       \
    case n:                                                                                                            \
        gather_strip(t, j, x, height, symmetric, n <= GATHER_S ? n : GATHER_S, work);                                  \
        break;
    switch (s) {
        STRIP(1) STRIP(2) STRIP(3) STRIP(4) STRIP(5) STRIP(6) STRIP(7) STRIP(8) STRIP(9)
    }
#undef STRIP
}

// s vectors for a tap set that has a column of its own: each looks for its rows.
static void gather_columns(const struct hf_taps *t, const float *weights, const struct gather_job *j,
                           fixed_column *column, int x, int height, int s)
{
    int y0[FIXED_STRIP], y1[FIXED_STRIP];
    for (int v = 0; v < s; v++)
        rows_needed(j, x + v * VF_N, height, 1, &y0[v], &y1[v]);
    for (int i = 0; i < j->planes && j->clears; i++)
        for (int v = 0; v < s; v++)
            clear_rest(j, i, x, x + v * VF_N, height, 1, y0[v], y1[v]);
    for (int i = 0; i < j->planes && !hf_stopped(j->stop); i++)
        for (int v = 0; v < s; v++)
            if (y0[v] < y1[v])
                column(weights, t->scale, j->in[i] + y0[v] * j->in_stride[i] + x + v * VF_N, j->in_stride[i],
                       job_out(j, i, x, x + v * VF_N) + y0[v] * j->out_stride[i], j->out_stride[i], y1[v] - y0[v]);
}

// Convolves strip by strip, and finishes each while it is in the cache. A first vector lies wherever r begins, all
// others are aligned; where the two overlap, the second writes everything again.
static void gather_jobs(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t,
                        const struct gather_job *jobs, int count, hf_kernel *finish)
{
    const int width = r.x1 - r.x0, height = r.y1 - r.y0;
    float *work = hf_gather(f->s)->area ? strip_plane(f, HF_STRIP_PLANES, height) : f->work;
    fixed_column *column = fixed_column_for(t);
    const float *weights = column ? fixed_weights(t, work) : NULL;
    const int most = column ? FIXED_STRIP : GATHER_S;
    for (int x = 0, next; x < width && !hf_stopped(f->s->stop); x = next) {
        const int odd = (r.x0 + x) & (VF_N - 1), left = (width - x + VF_N - 1) / VF_N;
        const int strips = (left + most - 1) / most;
        const int s = odd ? 1 : (left + strips - 1) / strips;
        next = x + s * VF_N - odd;
        for (int i = 0; i < count; i++) {
            if (column)
                gather_columns(t, weights, &jobs[i], column, x, height, s);
            else if (t->symmetric)
                gather_any(t, &jobs[i], x, height, 1, s, work);
            else
                gather_any(t, &jobs[i], x, height, 0, s, work);
        }
        if (finish)
            finish(f, (struct hf_rect){r.x0 + x, r.y0, r.x0 + hf_min(next, width), r.y1});
    }
}

static void job_needs(struct gather_job *j, const struct hf_frame *f, struct hf_rect r, enum hf_gather_buf need,
                      int channel)
{
    j->need = hf_at(&f->buf[need], channel, r.x0, r.y0);
    j->need_stride = f->buf[need].stride;
}

static void gather_run(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, struct gather_job *j,
                       enum hf_gather_buf need, int channel, hf_kernel *finish)
{
    job_needs(j, f, r, need, channel);
    gather_jobs(f, r, t, j, 1, finish);
}

static void weigh_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_reach taps = hf_gather_halo(f->s, HF_HALO_TAPS);
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
        const float *sum = hf_gather(s)->karis ? hf_at(&f->buf[HF_BUF_SUM], 0, r.x0, y) : NULL;
        const float *blur = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        hf_row(&f->buf[HF_BUF_NEAR], s->channels, r.x0, y, near);
        hf_row(&f->buf[HF_BUF_COLOR4], s->channels, r.x0, y, colour);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const vf coc = vf_load(blur + x);
            for (int c = 0; c < s->channels; c++) {
                vf v = vf_load(near[c] + x);
                if (sum)
                    v = vf_div(v, vf_load(sum + x));
                vf_store(near[c] + x,
                         round_stored(s->storage, near_part_vf(s->faithful, vf_load(colour[c] + x), v, coc), c));
            }
        }
    }
}

static void gather_near_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    struct gather_job j = {.planes = 0};
    for (int c = 0; c < s->channels; c++)
        gather_plane(&j, f, r, hf_gather(s)->karis ? HF_BUF_COLORW4 : HF_BUF_COLOR4, c, HF_BUF_NEAR, c);
    if (hf_gather(s)->karis)
        gather_plane(&j, f, r, HF_BUF_WEIGHT, 0, HF_BUF_SUM, 0);
    gather_run(f, r, hf_gather_taps(s, HF_NEAR), &j, HF_BUF_BLUR, 0, finish_near);
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
    const struct hf_taps *t = hf_gather_taps(f->s, HF_FAR);
    const vi lane = vi_load(lanes);
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        for (int x = r.x0; x < r.x1; x += VF_N) {
            // Lanes past the row's end hold anything; within 0..1 they read nothing but the buffers.
            const vf scale = coc_saturate(vf_load(hf_at(&f->buf[HF_BUF_COC4], 1, x, y)));
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
    const enum hf_division division = hf_gather(s)->division;
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

static void gather_far_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_setup *s = f->s;
    const enum hf_gather_buf colour = hf_gather(s)->karis ? HF_BUF_COLORFARW4 : HF_BUF_COLORFAR4;
    const enum hf_gather_buf weight = hf_gather(s)->karis ? HF_BUF_WEIGHT : HF_BUF_COC4;
    if (hf_gather(s)->per_pixel_kernel) {
        sample_taps_simd(f, r, &f->buf[colour], &f->buf[weight]);
        finish_far(f, r);
        return;
    }
    struct gather_job j = {.planes = 0};
    for (int c = 0; c < s->channels; c++)
        gather_plane(&j, f, r, colour, c, HF_BUF_FAR, c);
    gather_plane(&j, f, r, weight, 1, HF_BUF_SUM, 1);
    gather_run(f, r, hf_gather_taps(s, HF_FAR), &j, HF_BUF_COC4, 1, finish_far);
}

#include "engine/gather/area_lights_simd.inc"
#include "engine/gather/area_computation_simd.inc"

static void gather_simd(const struct hf_frame *f, struct hf_rect r)
{
    if (hf_gather(f->s)->area) {
        area_gather_simd(f, r);
        return;
    }
    if (hf_gather(f->s)->karis)
        weigh_simd(f, r);
    if (f->near)
        gather_near_simd(f, r);
    if (f->far)
        gather_far_simd(f, r);
}
