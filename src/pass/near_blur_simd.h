// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur on vectors: the windows that the C sums for each pixel are shared between pixels, 5 additions a value
// for 13 wide. No running sum: nothing drifts, and the bits do not depend on where a tile starts.

HF_INLINE vf blur_value(const struct hf_setup *s, vf centre, vf left, vf right, vf scale)
{
    return coc_round(s->storage, vf_mul(vf_add(centre, vf_add(left, right)), scale));
}

// A row or a column: where it begins, how far apart its vectors lie, and how far apart the values that a sum adds.
struct blur_line {
    float *p;
    ptrdiff_t advance, step;
};

// n values of a line of any width from n + 2m; per: how many of them a vector makes. Windows of the m values to either
// side grow bit by bit of m, in place: a value is read for the last time when it is replaced.
static void blur_line(const struct hf_setup *s, struct blur_line in, struct blur_line sum, struct blur_line out, int m,
                      int n, int per)
{
    const vf scale = vf_set1(1 / (float)(2 * m + 1));
    struct blur_line w = in;
    int size = 1;
    for (int bit = 30 - __builtin_clz((unsigned)m); bit >= 0; bit--) {
        const int odd = m >> bit & 1, next = 2 * size + odd;
        for (int i = 0; i * per < n + 2 * m - next + 1; i++) {
            const float *p = w.p + i * w.advance;
            vf v = vf_add(vf_load(p), vf_load(p + (size + odd) * w.step));
            if (odd)
                v = vf_add(v, vf_load(in.p + i * in.advance + size * in.step));
            vf_store(sum.p + i * sum.advance, v);
        }
        w = sum;
        size = next;
    }
    for (int i = 0; i * per < n; i++) {
        const float *p = w.p + i * w.advance;
        vf_store(out.p + i * out.advance, blur_value(s, vf_load(in.p + i * in.advance + m * in.step), vf_load(p),
                                                     vf_load(p + (m + 1) * w.step), scale));
    }
}

// 13 wide, the usual case, in registers: windows of 3, then of 6. A level lags a vector behind the one it is made from.
HF_INLINE void blur_row_13(const struct hf_setup *s, const float *in, float *out, int n)
{
    enum { LAG = VF_N == 4 ? 4 : 3 }; // of the output behind the input, vectors
    const int count = (n + VF_N - 1) / VF_N, inputs = (n + 12 + VF_N - 1) / VF_N;
    const vf scale = vf_set1(1 / 13.0f), zero = vf_zero();
    vf a[LAG + 1], w3[3] = {zero, zero, zero}, w6[4] = {zero, zero, zero, zero};
    for (int k = 0; k <= LAG; k++)
        a[k] = zero;
    for (int i = 0; i < count + LAG; i++) {
        for (int k = 0; k < LAG; k++)
            a[k] = a[k + 1];
        if (i < inputs)
            a[LAG] = vf_load(in + i * VF_N);
        const vf *last = a + LAG - 1;
        w3[0] = w3[1];
        w3[1] = vf_add(vf_add(last[0], vf_shift(last, 2)), vf_shift(last, 1));
        for (int k = 0; k < LAG - 2; k++)
            w6[k] = w6[k + 1];
        w6[LAG - 2] = vf_add(w3[0], vf_shift(w3, 3));
        if (i >= LAG)
            vf_store(out + (i - LAG) * VF_N, blur_value(s, vf_shift(a, 6), w6[0], vf_shift(w6, 7), scale));
    }
}

static void blur_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x, n = r.x1 - r.x0;
    for (int y = r.y0; y < r.y1; y++) {
        float *in = hf_at(&f->buf[HF_BUF_MAX], 0, r.x0 - m, y), *out = hf_at(&f->buf[HF_BUF_BLUR_X], 0, r.x0, y);
        const struct blur_line from = {in, VF_N, 1}, sum = {hf_line(f, 0), VF_N, 1}, to = {out, VF_N, 1};
        if (m == 6)
            blur_row_13(f->s, in, out, n);
        else
            blur_line(f->s, from, sum, to, m, n, VF_N);
    }
}

// 13 high, a vector wide: the windows in reach stay in registers on the way down. Until the first row there are only
// windows to make, and nothing to write.
HF_INLINE void blur_column_13(const struct hf_setup *s, const float *in, ptrdiff_t stride, float *out,
                              ptrdiff_t out_stride, int n)
{
    enum { ROWS = 8 };
    const vf scale = vf_set1(1 / 13.0f);
    vf a[ROWS + 2], w3[ROWS + 3], w6[ROWS + 7], first[10];
    for (int y = 0; y < 10; y++)
        first[y] =
            vf_add(vf_add(vf_load(in + y * stride), vf_load(in + (y + 2) * stride)), vf_load(in + (y + 1) * stride));
    for (int y = 0; y < 7; y++)
        w6[y] = vf_add(first[y], first[y + 3]);
    for (int y = 0; y < 3; y++)
        w3[y] = first[y + 7];
    a[0] = vf_load(in + 10 * stride);
    a[1] = vf_load(in + 11 * stride);
    for (int y = 0; y < n; y += ROWS) {
#pragma GCC unroll 8
        for (int k = 0; k < ROWS; k++) {
            if (y + k == n)
                return;
            a[k + 2] = vf_load(in + 12 * stride);
            w3[k + 3] = vf_add(vf_add(a[k], a[k + 2]), a[k + 1]);
            w6[k + 7] = vf_add(w3[k], w3[k + 3]);
            vf_store(out, blur_value(s, vf_load(in + 6 * stride), w6[k], w6[k + 7], scale));
            in += stride;
            out += out_stride;
        }
        a[0] = a[ROWS];
        a[1] = a[ROWS + 1];
        for (int k = 0; k < 3; k++)
            w3[k] = w3[ROWS + k];
        for (int k = 0; k < 7; k++)
            w6[k] = w6[ROWS + k];
    }
}

static void blur_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_buf *b = &f->buf[HF_BUF_BLUR_X], *to = &f->buf[HF_BUF_BLUR];
    const int m = f->s->max_y, n = r.y1 - r.y0;
    for (int x = r.x0; x < r.x1; x += VF_N) {
        float *in = hf_at(b, 0, x, r.y0 - m), *out = hf_at(to, 0, x, r.y0);
        const struct blur_line from = {in, b->stride, b->stride}, sum = {f->work, VF_N, VF_N},
                               column = {out, to->stride, to->stride};
        if (m == 6)
            blur_column_13(f->s, in, b->stride, out, to->stride, n);
        else
            blur_line(f->s, from, sum, column, m, n, 1);
    }
}
