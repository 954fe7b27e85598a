// SPDX-License-Identifier: BSD-3-Clause
// Near CoC max on vectors: along x maxima of 2, 4, 8 ... values come from each other, and two overlapping ones of those
// cover any width; along y windows share what they have in common.

// Largest power of two <= 2m + 1.
HF_INLINE int max_span(int m)
{
    int span = 1;
    while (2 * span <= 2 * m + 1)
        span *= 2;
    return span;
}

// Maxima of 8 values, or of 13, the usual width, in registers: each level from the one before and itself further right.
// A level lags a vector behind the one it is made from.
HF_INLINE void max_row(const float *in, float *out, int n, const int width)
{
    enum { LAG = VF_N == 4 ? 5 : 4 }; // of the output behind the input, vectors
    const int count = (n + VF_N - 1) / VF_N, inputs = (n + width - 1 + VF_N - 1) / VF_N;
    const vf zero = vf_zero();
    vf a[2] = {zero, zero}, m2[2] = {zero, zero}, m4[3] = {zero, zero, zero}, m8[4] = {zero, zero, zero, zero};
    for (int i = 0; i < count + LAG; i++) {
        a[0] = a[1];
        if (i < inputs)
            a[1] = vf_load(in + i * VF_N);
        m2[0] = m2[1];
        m2[1] = vf_max(a[0], vf_shift(a, 1));
        m4[0] = m4[1];
        m4[1] = vf_max(m2[0], vf_shift(m2, 2));
        m8[0] = m8[1];
        m8[1] = m8[2];
        m8[LAG - 3] = vf_max(m4[0], vf_shift(m4, 4));
        if (i >= LAG)
            vf_store(out + (i - LAG) * VF_N, width == 8 ? m8[0] : vf_max(m8[0], vf_shift(m8, 5)));
    }
}

static void max_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x, span = max_span(m), n = r.x1 - r.x0;
    const struct hf_buf *b = &f->buf[HF_BUF_COC4];
    float *row = hf_line(f, 0);
    for (int y = r.y0; y < r.y1; y++) {
        const float *in = hf_at(b, 0, r.x0 - m, y);
        float *out = hf_at(&f->buf[HF_BUF_MAX_X], 0, r.x0, y);
        int len = 1;
        for (int x = 0; x < n + 2 * m + 15; x += 16) // comes from memory, in rows too short for hardware prefetchers
            __builtin_prefetch(in + 4 * b->stride + x);
        if (m == 6) {
            max_row(in, out, n, 13);
            continue;
        }
        if (span >= 8) {
            max_row(in, row, n + 2 * m - 7, 8);
            in = row;
            len = 8;
        }
        for (; len < span; len *= 2) {
            // In place: a value is read for the last time when it is replaced.
            for (int x = 0; x < n + 2 * (m - len) + 1; x += VF_N)
                vf_store(row + x, vf_max(vf_load(in + x + len), vf_load(in + x)));
            in = row;
        }
        for (int x = 0; x < n; x += VF_N)
            vf_store(out + x, vf_max(vf_load(in + x + 2 * m + 1 - span), vf_load(in + x)));
    }
}

// `rows` rows of a column, a vector wide. What their windows of 2m + 1 rows, not fewer, have in common is a core; upwards
// from it each row extends it to an earlier window's beginning, which is put into `up`, downwards to a later one's end. For 13 and
// 8 rows this takes 3 maxima and 2.5 loads a value, and `up` is in registers.
HF_INLINE void max_column(const float *in, ptrdiff_t stride, float *out, ptrdiff_t out_stride, int m, const int rows,
                          vf *up)
{
    vf window = vf_load(in + (rows - 1) * stride);
    for (int y = rows; y <= 2 * m; y++)
        window = vf_max(window, vf_load(in + y * stride));
    up[rows - 1] = window;
#pragma GCC unroll 8
    for (int y = rows - 2; y >= 0; y--)
        up[y] = window = vf_max(window, vf_load(in + y * stride));
    vf_store(out, window);
    if (rows > 1)
        window = vf_load(in + (2 * m + 1) * stride);
#pragma GCC unroll 8
    for (int y = 1; y < rows; y++) {
        if (y > 1)
            window = vf_max(window, vf_load(in + (2 * m + y) * stride));
        vf_store(out + y * out_stride, vf_max(up[y], window));
    }
}

enum { MAX_ROWS = 8, MAX_MANY = 64 };

static void max_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *b = &f->buf[HF_BUF_MAX_X], *to = &f->buf[HF_BUF_MAX];
    const int m = f->s->max_y, most = m < MAX_ROWS / 2 ? 2 * m + 1 : m < 24 ? MAX_ROWS : hf_min(2 * m + 1, MAX_MANY);
    for (int y = r.y0, rows; y < r.y1; y += rows) {
        rows = hf_min(most, r.y1 - y);
        for (int x = r.x0; x < r.x1; x += VF_N) {
            const float *in = hf_at(b, 0, x, y - m);
            float *out = hf_at(to, 0, x, y);
            vf up[MAX_MANY];
            if (rows == MAX_ROWS)
                max_column(in, b->stride, out, to->stride, m, MAX_ROWS, up);
            else
                max_column(in, b->stride, out, to->stride, m, rows, up);
        }
    }
}
