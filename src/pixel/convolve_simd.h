// SPDX-License-Identifier: BSD-3-Clause
// Convolution on vectors.
//
// Per input row the pairs h[j] = in[x - j] + in[x + j] are formed once, then a row sum per distinct row of weights,
// r[k] = sum over j of w[k][j] h[j]; an output row is the sum of 2 ry + 1 of those. 36 multiplications a pixel and
// plane at the chapter's reach where the 48 bilinear taps would load 192 values. Tap sets that are known when this is
// compiled have a column of convolve_fixed_simd.h. For all others columns are worked off in strips of up to CONVOLVE_S vectors:
// enough independent sums to hide the latency of the multiply-add, one broadcast weight for all of them, and output rows
// that stay in the first-level cache.
#ifndef HF_CONVOLVE_SIMD_H
#define HF_CONVOLVE_SIMD_H

#include "pass/engine.h"
#include "pixel/convolve_fixed_simd.h"

enum { CONVOLVE_S = VF_N == 16 ? 5 : 9 };

// A weight and the byte offset of its pairs: what the inner loop needs, worked out once a strip.
struct convolve_term {
    float weight;
    int32_t offset;
};

// One row sum from the pairs h (rows of s vectors), added to the output rows above and below. scale: NULL, or that of the
// one above, which is then complete.
HF_INLINE void row_sum(const struct convolve_term *term, const struct convolve_term *end, const int s, const float *h,
                       float *above, float *below, const float *scale)
{
    vf acc[CONVOLVE_S];
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
enum { CONVOLVE_AHEAD = 6 };

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
    vf sum[CONVOLVE_S];
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

// Of a row, which blocks of 16 columns of the input hold something else than 0, and which of the result are wanted: bits, see
// convolve_blocks. What is not wanted may be anything.
struct convolve_row {
    uint64_t filled, wanted;
};

// The blocks that have columns x0 to x1 - 1: column x is in block x / 16, and every 64th shares a bit.
HF_INLINE uint64_t convolve_blocks(int x0, int x1)
{
    const int first = x0 >> 4, n = ((x1 - 1) >> 4) - first + 1, at = first & 63;
    const uint64_t run = n < 64 ? ((uint64_t)1 << n) - 1 : ~(uint64_t)0;
    return run << at | run >> (-at & 63);
}

// What a strip of columns reads of rows, and what it writes. NULL: all.
struct convolve_window {
    const struct convolve_row *row;
    uint64_t reads, writes;
};

HF_INLINE int window_reads(const struct convolve_window *w, int y)
{
    return !w->row || w->row[y].filled & w->reads;
}

HF_INLINE int window_wants(const struct convolve_window *w, int y)
{
    return !w->row || w->row[y].wanted & w->writes;
}

// An input row that holds nothing still ends the sum of the output row that it is the last of.
HF_INLINE void row_end(const struct hf_taps *t, const int s, float *above)
{
    for (int v = 0; v < s && t->scale != 1; v++)
        vf_store(above + v * VF_N, vf_mul(vf_load(above + v * VF_N), vf_set1(t->scale)));
}

// s vectors of columns. Each input row is spread over the output rows it reaches: those are sums that grow from top to
// bottom, and stay in the first-level cache while they do. Adding nothing but 0 changes no bit.
HF_INLINE void convolve_strip(const struct hf_taps *t, const float *in, ptrdiff_t in_stride, float *out,
                              ptrdiff_t out_stride, int height, const int symmetric, const int s,
                              const struct convolve_window *w, const struct convolve_term *terms, float *h,
                              atomic_int *stop)
{
    const int ry = t->ry, step = s * VF_N;
    for (int y = -ry; y < height + ry && !hf_stopped(stop); y++) {
        if (y + ry < height)  // reached for the first time
#pragma GCC unroll 16
            for (int v = 0; v < s; v++)
                vf_store(out + (y + ry) * out_stride + v * VF_N, vf_zero());
        if (!window_reads(w, y)) {
            if (y >= ry)
                row_end(t, s, out + (y - ry) * out_stride);
            continue;
        }
        prefetch_row(in + (y + CONVOLVE_AHEAD) * in_stride - t->rx, step + 2 * t->rx);
        row_pairs(in + y * in_stride, t->rx, symmetric, t->runs, s, h);
        for (int k = 0; k < t->rows; k++) {
            const int up = symmetric ? y - k : y - k + ry, down = y + k;
            float *above = up >= 0 && up < height && window_wants(w, up) ? out + up * out_stride : NULL;
            float *below =
                symmetric && k && down >= 0 && down < height && window_wants(w, down) ? out + down * out_stride : NULL;
            if (above || below)
                row_sum(terms + t->first[k], terms + t->first[k + 1], s, h, above, below,
                        k == t->rows - 1 && t->scale != 1 ? &t->scale : NULL);
        }
    }
}

enum { CONVOLVE_PLANES = 7 };

// Planes to convolve together, and where: only rows with need > 0 are wanted, those within reach of some, or all.
struct convolve_job {
    const float *in[CONVOLVE_PLANES];
    float *out[CONVOLVE_PLANES];
    ptrdiff_t in_stride[CONVOLVE_PLANES], out_stride[CONVOLVE_PLANES];
    int of_strip[CONVOLVE_PLANES];  // out is a strip's own, see strip_plane
    int planes;
    const float *need;  // NULL: all
    ptrdiff_t need_stride;
    struct hf_reach reach;
    int clears;         // the other rows become 0
    const float *full;  // rows where gain times this is 1 throughout are not wanted after all; NULL: there are none
    ptrdiff_t full_stride;
    float gain;
    const struct convolve_row *row;  // the first row's; NULL: nothing is known. Tap sets without a column of their own
    int x0;                          // the first column
    atomic_int *stop;
};

HF_INLINE void convolve_plane(struct convolve_job *j, const struct hf_frame *f, struct hf_rect r, int in, int c_in,
                              int out, int c_out)
{
    const int i = j->planes++;
    j->stop = f->s->stop;
    j->in[i] = hf_at(&f->buf[in], c_in, r.x0, r.y0);
    j->in_stride[i] = f->buf[in].stride;
    j->out[i] = hf_at(&f->buf[out], c_out, r.x0, r.y0);
    j->out_stride[i] = f->buf[out].stride;
}

// Where column x of a strip that begins at column `from` goes.
HF_INLINE float *job_out(const struct convolve_job *j, int i, int from, int x)
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
HF_INLINE void rows_reached(const struct convolve_job *j, int x, int height, const int s, int *y0, int *y1)
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

HF_INLINE void rows_needed(const struct convolve_job *j, int x, int height, const int s, int *y0, int *y1)
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
HF_INLINE void clear_rest(const struct convolve_job *j, int i, int from, int x, int height, const int s, int y0, int y1)
{
    float *out = job_out(j, i, from, x);
    for (int y = 0; j->clears && y < height; y++)
        for (int v = 0; v < s && (y < y0 || y >= y1); v++)
            vf_store(out + y * j->out_stride[i] + v * VF_N, vf_zero());
}

// A strip of s vectors from column x of all planes.
HF_INLINE void convolve_planes(const struct hf_taps *t, const struct convolve_job *j, int x, int height,
                               const int symmetric, const int s, float *work)
{
    struct convolve_term *terms = (struct convolve_term *)work;
    const int n = t->first[t->rows];
    float *h = work + ((2 * n + 15) & ~15);
    for (int i = 0; i < n; i++)
        terms[i] = (struct convolve_term){t->weight[i], t->column[i] * s * (int)sizeof(vf)};
    int y0, y1;
    rows_needed(j, x, height, s, &y0, &y1);
    for (int i = 0; i < j->planes; i++)
        clear_rest(j, i, x, x, height, s, y0, y1);
    const int left = j->x0 + x, right = left + s * VF_N;
    const struct convolve_window w = {j->row ? j->row + y0 : NULL, convolve_blocks(left - t->rx, right + t->rx),
                                      convolve_blocks(left, right)};
    for (int i = 0; i < j->planes && y0 < y1; i++)
        convolve_strip(t, j->in[i] + y0 * j->in_stride[i] + x, j->in_stride[i],
                       job_out(j, i, x, x) + y0 * j->out_stride[i], j->out_stride[i], y1 - y0, symmetric, s, &w, terms,
                       h, j->stop);
}

HF_INLINE void convolve_any(const struct hf_taps *t, const struct convolve_job *j, int x, int height,
                            const int symmetric, int s, float *work)
{
#define STRIP(n)                                                                                                       \
    case n:                                                                                                            \
        convolve_planes(t, j, x, height, symmetric, n <= CONVOLVE_S ? n : CONVOLVE_S, work);                           \
        break;
    switch (s) {
        STRIP(1) STRIP(2) STRIP(3) STRIP(4) STRIP(5) STRIP(6) STRIP(7) STRIP(8) STRIP(9)
    }
#undef STRIP
}

// s vectors for a tap set that has a column of its own: each looks for its rows.
static void convolve_columns(const struct hf_taps *t, const float *weights, const struct convolve_job *j,
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
// others are aligned; where the two overlap, the second writes everything again. column: of these taps, or NULL.
static void convolve_jobs(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, fixed_column *column,
                          float *work, const struct convolve_job *jobs, int count, hf_kernel *finish)
{
    const int width = r.x1 - r.x0, height = r.y1 - r.y0;
    const float *weights = column ? fixed_weights(t, work) : NULL;
    const int most = column ? FIXED_STRIP : CONVOLVE_S;
    for (int x = 0, next; x < width && !hf_stopped(f->s->stop); x = next) {
        const int odd = (r.x0 + x) & (VF_N - 1), left = (width - x + VF_N - 1) / VF_N;
        const int strips = (left + most - 1) / most;
        const int s = odd ? 1 : (left + strips - 1) / strips;
        next = x + s * VF_N - odd;
        for (int i = 0; i < count; i++) {
            if (column)
                convolve_columns(t, weights, &jobs[i], column, x, height, s);
            else if (t->symmetric)
                convolve_any(t, &jobs[i], x, height, 1, s, work);
            else
                convolve_any(t, &jobs[i], x, height, 0, s, work);
        }
        if (finish)
            finish(f, (struct hf_rect){r.x0 + x, r.y0, r.x0 + hf_min(next, width), r.y1});
    }
}

HF_INLINE void job_needs(struct convolve_job *j, const struct hf_frame *f, struct hf_rect r, int need, int channel)
{
    j->need = hf_at(&f->buf[need], channel, r.x0, r.y0);
    j->need_stride = f->buf[need].stride;
}

#endif
