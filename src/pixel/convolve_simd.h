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

// A row sum from the pairs h (rows of s vectors).
HF_INLINE void row_sum(const struct convolve_term *term, const struct convolve_term *end, const int s, const float *h,
                       vf *sum)
{
    HF_UNROLL(16)
    for (int v = 0; v < s; v++)
        sum[v] = vf_zero();
    for (; term < end; term++) {
        const vf w = vf_set1(term->weight);
        const char *p = (const char *)h + term->offset;
        HF_UNROLL(16)
        for (int v = 0; v < s; v++)
            sum[v] = vf_fma(w, vf_load(p + v * (int)sizeof(vf)), sum[v]);
    }
}

// Add a row sum to an output row. scale: NULL, or that of a row that is then complete.
HF_INLINE void row_add(float *out, const int s, const vf *sum, const float *scale)
{
    HF_UNROLL(16)
    for (int v = 0; v < s; v++) {
        const vf all = vf_add(vf_load(out + v * VF_N), sum[v]);
        vf_store(out + v * VF_N, scale ? vf_mul(all, vf_set1(*scale)) : all);
    }
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
HF_INLINE void row_pairs(const struct hf_taps *t, const float *p, const int symmetric, const int s, float *h)
{
    const int nx = t->nx, runs = t->runs;
    const ptrdiff_t step = t->step;
    if (!symmetric) {
        for (int j = -nx; j <= nx; j++, h += s * VF_N) {
            HF_UNROLL(16)
            for (int v = 0; v < s; v++)
                vf_store(h + v * VF_N, vf_load(p + v * VF_N + j * step));
        }
        return;
    }
    vf sum[CONVOLVE_S];
    float *run = h + (nx + 1) * s * VF_N;
    HF_UNROLL(16)
    for (int v = 0; v < s; v++) {
        vf_store(h + v * VF_N, sum[v] = vf_load(p + v * VF_N));
        if (runs)
            vf_store(run + v * VF_N, sum[v]);
    }
    for (int j = 1; j <= nx; j++) {
        h += s * VF_N;
        run += s * VF_N;
        HF_UNROLL(16)
        for (int v = 0; v < s; v++) {
            const vf pair = vf_add(vf_load(p + v * VF_N - j * step), vf_load(p + v * VF_N + j * step));
            vf_store(h + v * VF_N, pair);
            sum[v] = vf_add(sum[v], pair);
            if (runs)
                vf_store(run + v * VF_N, sum[v]);
        }
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

// What a strip of columns reads of rows, every step-th, and what it writes. NULL: all.
struct convolve_window {
    const struct convolve_row *row;
    int step;
    uint64_t reads, writes;
};

HF_INLINE int window_reads(const struct convolve_window *w, int y)
{
    return !w->row || w->row[y * w->step].filled & w->reads;
}

HF_INLINE int window_wants(const struct convolve_window *w, int y)
{
    return !w->row || w->row[y * w->step].wanted & w->writes;
}

// The rows of a strip's result.
struct convolve_out {
    float *row;
    ptrdiff_t stride;
    int height;
    const struct convolve_window *window;
};

// Row y; NULL if there is none or nobody wants it.
HF_INLINE float *out_row(const struct convolve_out *o, int y)
{
    return y >= 0 && y < o->height && window_wants(o->window, y) ? o->row + y * o->stride : NULL;
}

// Row y of the input, whose pairs are in h.
HF_INLINE void one_row(const struct hf_taps *t, const struct convolve_out *o, int y, const int symmetric, const int s,
                       const struct convolve_term *terms, const float *h)
{
    for (int k = 0; k < t->rows; k++) {
        float *above = out_row(o, symmetric ? y - k : y - k + t->ny),
              *below = symmetric && k ? out_row(o, y + k) : NULL;
        if (!above && !below)
            continue;
        vf sum[CONVOLVE_S];
        row_sum(terms + t->first[k], terms + t->first[k + 1], s, h, sum);
        if (above)
            row_add(above, s, sum, k == t->rows - 1 ? &t->scale : NULL);
        if (below)
            row_add(below, s, sum, NULL);
    }
}

// With 32 registers a strip has room for two input rows, and an output row is read and written once for both.
enum { CONVOLVE_TWO = VF_N == 16 };

// As row_sum, of two rows: the second's pairs lie `next` bytes after the first's.
HF_INLINE void row_sums(const struct convolve_term *term, const struct convolve_term *end, const int s, const float *h,
                        ptrdiff_t next, vf *a, vf *b)
{
    HF_UNROLL(16)
    for (int v = 0; v < s; v++)
        a[v] = b[v] = vf_zero();
    for (; term < end; term++) {
        const vf w = vf_set1(term->weight);
        const char *p = (const char *)h + term->offset, *q = p + next;
        HF_UNROLL(16)
        for (int v = 0; v < s; v++) {
            a[v] = vf_fma(w, vf_load(p + v * (int)sizeof(vf)), a[v]);
            b[v] = vf_fma(w, vf_load(q + v * (int)sizeof(vf)), b[v]);
        }
    }
}

HF_INLINE void row_add_two(float *out, const int s, const vf *a, const vf *b, const float *scale)
{
    HF_UNROLL(16)
    for (int v = 0; v < s; v++) {
        const vf all = vf_add(vf_add(vf_load(out + v * VF_N), a[v]), b[v]);
        vf_store(out + v * VF_N, scale ? vf_mul(all, vf_set1(*scale)) : all);
    }
}

// Rows y and y + 1, of symmetric taps: row y + k has row sum k of the first and k - 1 of the second, row y + 1 - k the
// other way around.
HF_INLINE void two_rows(const struct hf_taps *t, const struct convolve_out *o, int y, const int s,
                        const struct convolve_term *terms, const float *h)
{
    const ptrdiff_t next = (2 * t->nx + 2) * s * (ptrdiff_t)sizeof(vf);
    vf a_before[CONVOLVE_S], b_before[CONVOLVE_S];
    HF_UNROLL(16)
    for (int v = 0; v < s; v++)
        a_before[v] = b_before[v] = vf_zero();
    for (int k = 0; k <= t->ny; k++) {
        float *above = out_row(o, y + 1 - k), *below = out_row(o, y + k);
        if (!above && !below && !out_row(o, y - k) && !out_row(o, y + 1 + k))
            continue;
        vf a[CONVOLVE_S], b[CONVOLVE_S];
        row_sums(terms + t->first[k], terms + t->first[k + 1], s, h, next, a, b);
        if (k && below)
            row_add_two(below, s, a, b_before, NULL);
        if (k && above)
            row_add_two(above, s, a_before, b, k == t->ny ? &t->scale : NULL);
        HF_UNROLL(16)
        for (int v = 0; v < s; v++) {
            a_before[v] = a[v];
            b_before[v] = b[v];
        }
    }
    float *first = out_row(o, y - t->ny), *last = out_row(o, y + 1 + t->ny);
    if (first)
        row_add(first, s, a_before, &t->scale);
    if (last)
        row_add(last, s, b_before, NULL);
}

HF_INLINE void out_begin(const struct convolve_out *o, int y, const int s)
{
    if (y < o->height) {
        HF_UNROLL(16)
        for (int v = 0; v < s; v++)
            vf_store(o->row + y * o->stride + v * VF_N, vf_zero());
    }
}

// s vectors of columns. Each input row is spread over the output rows it reaches: those are sums that grow from top to
// bottom, and stay in the first-level cache while they do. Adding nothing but 0 changes no bit.
HF_INLINE void convolve_strip(const struct hf_taps *t, const float *in, ptrdiff_t in_stride,
                              const struct convolve_out *o, const int symmetric, const int s,
                              const struct convolve_term *terms, float *h, atomic_int *stop)
{
    const int ry = t->ny, n = s * VF_N, end = o->height + ry;
    for (int y = -ry; y < end && !hf_stopped(stop); y++) {
        const float *p = in + y * in_stride;
        out_begin(o, y + ry, s);
        if (!window_reads(o->window, y)) {  // it still ends the sum of the output row that it is the last of
            for (int v = 0; v < s && y >= ry; v++) {
                float *out = o->row + (y - ry) * o->stride + v * VF_N;
                vf_store(out, vf_mul(vf_load(out), vf_set1(t->scale)));
            }
            continue;
        }
        prefetch_row(p + CONVOLVE_AHEAD * in_stride - t->rx, n + 2 * t->rx);
        row_pairs(t, p, symmetric, s, h);
        if (CONVOLVE_TWO && symmetric && y + 1 < end && window_reads(o->window, y + 1)) {
            y++;
            out_begin(o, y + ry, s);
            prefetch_row(p + (CONVOLVE_AHEAD + 1) * in_stride - t->rx, n + 2 * t->rx);
            row_pairs(t, p + in_stride, symmetric, s, h + (2 * t->nx + 2) * n);
            two_rows(t, o, y - 1, s, terms, h);
        } else {
            one_row(t, o, y, symmetric, s, terms, h);
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
    HF_UNROLL(16)
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
    HF_UNROLL(16)
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

HF_INLINE void clear_rows(float *out, ptrdiff_t stride, const int s, int y0, int y1)
{
    for (int y = y0; y < y1; y++)
        for (int v = 0; v < s; v++)
            vf_store(out + y * stride + v * VF_N, vf_zero());
}

// Zeros in the rows of a plane that are not needed.
HF_INLINE void clear_rest(const struct convolve_job *j, int i, int from, int x, int height, const int s, int y0, int y1)
{
    if (!j->clears)
        return;
    clear_rows(job_out(j, i, from, x), j->out_stride[i], s, 0, y0);
    clear_rows(job_out(j, i, from, x), j->out_stride[i], s, y1, height);
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
    struct convolve_window w = {NULL, t->step, convolve_blocks(left - t->rx, right + t->rx),
                                convolve_blocks(left, right)};
    // With a step rows y, y + step and so on have nothing to do with those between.
    for (int i = 0; i < j->planes; i++)
        for (int y = y0; y < hf_min(y0 + t->step, y1); y++) {
            const ptrdiff_t out_stride = j->out_stride[i], in_stride = j->in_stride[i];
            const struct convolve_out o = {job_out(j, i, x, x) + y * out_stride, out_stride * t->step,
                                           (y1 - y + t->step - 1) / t->step, &w};
            w.row = j->row ? j->row + y : NULL;
            convolve_strip(t, j->in[i] + y * in_stride + x, in_stride * t->step, &o, symmetric, s, terms, h, j->stop);
        }
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

// The rows from the first to the last that a vector from column x gets anything in, of those that are wanted.
static void rows_filled(const struct hf_taps *t, const struct convolve_job *j, int x, int *y0, int *y1)
{
    const int left = j->x0 + x;
    const uint64_t reads = convolve_blocks(left - t->rx, left + VF_N + t->rx);
    const uint64_t writes = convolve_blocks(left, left + VF_N);
    int first = *y0 - t->ry, last = *y1 + t->ry;
    while (first < last && !(j->row[first].filled & reads))
        first++;
    while (last > first && !(j->row[last - 1].filled & reads))
        last--;
    *y0 = hf_max(first - t->ry, *y0);
    *y1 = first < last ? hf_min(last + t->ry, *y1) : *y0;
    while (*y0 < *y1 && !(j->row[*y0].wanted & writes))
        (*y0)++;
    while (*y1 > *y0 && !(j->row[*y1 - 1].wanted & writes))
        (*y1)--;
}

// s vectors for a tap set that has a column of its own: each looks for its rows.
static void convolve_columns(const struct hf_taps *t, const float *weights, const struct convolve_job *j,
                             fixed_column *column, int x, int height, int s)
{
    int y0[FIXED_STRIP], y1[FIXED_STRIP];
    for (int v = 0; v < s; v++) {
        rows_needed(j, x + v * VF_N, height, 1, &y0[v], &y1[v]);
        if (j->row)
            rows_filled(t, j, x + v * VF_N, &y0[v], &y1[v]);
    }
    for (int i = 0; i < j->planes && j->clears; i++)
        for (int v = 0; v < s; v++)
            clear_rest(j, i, x, x + v * VF_N, height, 1, y0[v], y1[v]);
    for (int i = 0; i < j->planes && !hf_stopped(j->stop); i++)
        for (int v = 0; v < s; v++)
            for (int y = y0[v]; y < hf_min(y0[v] + t->step, y1[v]); y++)
                column(weights, t->scale, j->in[i] + y * j->in_stride[i] + x + v * VF_N, j->in_stride[i] * t->step,
                       t->step, job_out(j, i, x, x + v * VF_N) + y * j->out_stride[i], j->out_stride[i] * t->step,
                       (y1[v] - y + t->step - 1) / t->step);
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
