// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur on vectors. Bytes are summed as whole numbers, in words: any order gives the same sum, a running one
// does not drift. Halves and floats are summed as floats: the windows that the C sums for each pixel are shared between
// pixels, 5 additions a value for 13 wide, and the bits do not depend on where a tile starts.
#include "pixel/fields.h"
#include "pixel/near_max_simd.h"
#include "pixel/format_vf.h"

// ---- bytes, up to 255 wide: no sum is larger than a word ----

enum { BLUR_BYTES = 127 };  // largest reach

// The nearest whole number to a sum by its odd count: (sum + add) * factor, of which the upper word, times shift, again
// the upper word. With the factor rounded up, or else rounded down and 1 added to the sum, that is exact (Robison,
// N-bit unsigned division via N-bit multiply-add).
struct blur_mean {
    vi add, factor, shift;
};

static struct blur_mean blur_mean(int m)
{
    const uint32_t count = 2 * (uint32_t)m + 1, k = 31 - (uint32_t)__builtin_clz(count);
    const uint32_t factor = (1u << (16 + k)) / count, rest = (1u << (16 + k)) % count, up = count - rest <= 1u << k;
    return (struct blur_mean){vi_set16((uint16_t)((uint32_t)m + !up)), vi_set16((uint16_t)(factor + up)),
                              vi_set16((uint16_t)(1u << (16 - k)))};
}

// Even and odd bytes are in a word each, and so are the sums of both: nothing is unpacked.
HF_INLINE vi even_bytes(vi a)
{
    return vi_and(a, vi_set16(255));
}

HF_INLINE vi odd_bytes(vi a)
{
    return vi_shr16(a, 8);
}

HF_INLINE vi byte_pairs(vi a)
{
    return vi_add16(even_bytes(a), odd_bytes(a));
}

// Bytes from their sums with blur_mean.add.
HF_INLINE vi mean_bytes(const struct blur_mean *mean, vi even, vi odd)
{
    even = vi_mulhi16(vi_mulhi16(even, mean->factor), mean->shift);
    odd = vi_mulhi16(vi_mulhi16(odd, mean->factor), mean->shift);
    return vi_or(even, vi_shl16(odd, 8));
}

// 13 wide, in registers: an even byte's sum is that of 6 pairs and the byte behind them, an odd one's that of the byte
// before the next 6 pairs. A level lags a vector behind the one it is made from.
HF_INLINE void blur_bytes_13(const char *in, char *out, int n)
{
    const struct blur_mean mean = blur_mean(6);
    const vi zero = vi_set1(0);
    vi a[4] = {zero, zero, zero, zero}, p1[2] = {zero, zero}, p2[2] = {zero, zero}, p6[2] = {zero, zero};
    for (int i = 0; i < n + 3 * VECTOR; i += VECTOR) {
        for (int k = 0; k < 3; k++)
            a[k] = a[k + 1];
        if (i < n + 12)
            a[3] = vi_load(in + i);
        p1[0] = p1[1];
        p1[1] = byte_pairs(a[3]);
        p2[0] = p2[1];
        p2[1] = vi_add16(p1[0], vi_shift(p1, 2));
        p6[0] = p6[1];
        p6[1] = vi_add16(vi_add16(p2[0], vi_shift(p2, 4)), vi_add16(vi_shift(p2, 8), mean.add));
        if (i >= 3 * VECTOR)
            vi_store(out + i - 3 * VECTOR, mean_bytes(&mean, vi_add16(p6[0], even_bytes(vi_shift(a, 12))),
                                                      vi_add16(odd_bytes(a[0]), vi_shift(p6, 2))));
    }
}

// Any width: windows of m pairs grow bit by bit of m, in place, as in blur_line.
HF_INLINE void blur_bytes(const char *in, char *work, char *out, int n, int m)
{
    const struct blur_mean mean = blur_mean(m);
    int size = 1;
    for (int i = 0; i < n + 2 * m; i += VECTOR)
        vi_store(work + i, byte_pairs(vi_load(in + i)));
    for (int bit = 30 - __builtin_clz((unsigned)m); bit >= 0; bit--) {
        const int odd = m >> bit & 1, next = 2 * size + odd;
        for (int i = 0; i < n + 2 * (m - next) + 2; i += VECTOR) {
            vi v = vi_add16(vi_load(work + i), vi_load(work + i + 2 * (size + odd)));
            if (odd)
                v = vi_add16(v, byte_pairs(vi_load(in + i + 2 * size)));
            vi_store(work + i, v);
        }
        size = next;
    }
    for (int i = 0; i < n; i += VECTOR) {
        const vi even = vi_add16(vi_load(work + i), even_bytes(vi_load(in + i + 2 * m)));
        const vi odd = vi_add16(vi_load(work + i + 2), odd_bytes(vi_load(in + i)));
        vi_store(out + i, mean_bytes(&mean, vi_add16(even, mean.add), vi_add16(odd, mean.add)));
    }
}

// A column as wide as a vector, of which `columns` are wanted: a running sum, whatever the height.
HF_INLINE void blur_byte_column(const char *in, ptrdiff_t stride, float *out, ptrdiff_t out_stride, int columns, int n,
                                int m)
{
    const struct blur_mean mean = blur_mean(m);
    const vf unit = vf_set1(1 / 255.0f);
    vi even = mean.add, odd = mean.add;
    for (int y = 0; y < n + 2 * m; y++) {
        const vi last = vi_load(in + y * stride);
        even = vi_add16(even, even_bytes(last));
        odd = vi_add16(odd, odd_bytes(last));
        if (y < 2 * m)
            continue;
        char byte[VECTOR];
        vi_store(byte, mean_bytes(&mean, even, odd));
        for (int x = 0; x < columns; x += VF_N)
            vf_store(out + x, vf_mul(vi_to_vf(vi_load_u8(byte + x)), unit));
        const vi first = vi_load(in + (y - 2 * m) * stride);
        even = vi_sub16(even, even_bytes(first));
        odd = vi_sub16(odd, odd_bytes(first));
        out += out_stride;
    }
}

// ---- floats; narrow numbers become floats on the way ----

HF_INLINE vf blur_sum(vf centre, vf left, vf right)
{
    return vf_add(centre, vf_add(left, right));
}

// A row or a column: where it begins, and how far apart its vectors and the values that a sum adds lie.
struct blur_line {
    float *p;
    ptrdiff_t advance, step;
};

// n values of a line of any width from n + 2m; per: how many of them a vector makes. Windows of the m values to either
// side grow bit by bit of m, in place: a value is read for the last time when it is replaced. edge: how much the outermost
// count. out_advance: bytes.
HF_INLINE void blur_line(const int bytes, const int widen, struct blur_line in, struct blur_line sum, char *out,
                         ptrdiff_t out_advance, int m, float edge, int n, int per)
{
    const vf scale = vf_set1(hf_blur_scale(m, edge)), less = vf_set1(1 - edge);
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
        const float *first = in.p + i * in.advance;
        vf total = blur_sum(vf_load(first + m * in.step), vf_load(p), vf_load(p + (m + 1) * w.step));
        if (edge < 1)
            total = vf_sub(total, vf_mul(less, vf_add(vf_load(first), vf_load(first + 2 * m * in.step))));
        narrow_store(bytes, widen, out + i * out_advance, vf_mul(total, scale));
    }
}

// 13 wide, the usual case, in registers: windows of 3, then of 6. A level lags a vector behind the one it is made from.
HF_INLINE void blur_row_13(const int bytes, const char *in, char *out, int n)
{
    enum { LAG = VF_N == 4 ? 4 : 3 };  // of the output behind the input, vectors
    const int count = (n + VF_N - 1) / VF_N, inputs = (n + 12 + VF_N - 1) / VF_N, size = VF_N * bytes;
    const vf scale = vf_set1(1 / 13.0f), zero = vf_zero();
    vf a[LAG + 1], w3[3] = {zero, zero, zero}, w6[4] = {zero, zero, zero, zero};
    for (int k = 0; k <= LAG; k++)
        a[k] = zero;
    for (int i = 0; i < count + LAG; i++) {
        for (int k = 0; k < LAG; k++)
            a[k] = a[k + 1];
        if (i < inputs)
            a[LAG] = narrow_load(bytes, in + i * size);
        const vf *last = a + LAG - 1;
        w3[0] = w3[1];
        w3[1] = vf_add(vf_add(last[0], vf_shift(last, 2)), vf_shift(last, 1));
        for (int k = 0; k < LAG - 2; k++)
            w6[k] = w6[k + 1];
        w6[LAG - 2] = vf_add(w3[0], vf_shift(w3, 3));
        if (i >= LAG)
            narrow_store(bytes, 0, out + (i - LAG) * size,
                         vf_mul(blur_sum(vf_shift(a, 6), w6[0], vf_shift(w6, 7)), scale));
    }
}

HF_INLINE void blur_row_wide(const struct hf_frame *f, const int bytes, char *in, char *out, int n, int m, float edge)
{
    struct blur_line from = {hf_line(f, 0), VF_N, 1}, sum = {hf_line(f, 1), VF_N, 1};
    if (bytes == 4)
        from.p = (float *)(void *)in;
    else
        for (int x = 0; x < n + 2 * m; x += VF_N)
            vf_store(from.p + x, narrow_load(bytes, in + x * bytes));
    blur_line(bytes, 0, from, sum, out, VF_N * bytes, m, edge, n, VF_N);
}

HF_INLINE void blur_rows(const struct hf_frame *f, struct hf_rect r, const int bytes)
{
    const int m = hf_fields(f->s)->blur_x, n = r.x1 - r.x0;
    const float edge = hf_fields(f->s)->edge_x;
    for (int y = r.y0; y < r.y1; y++) {
        char *in = hf_narrow_at(&f->buf[HF_BUF_MAX], 0, r.x0 - m, y, bytes);
        char *out = hf_narrow_at(&f->buf[HF_BUF_BLUR_X], 0, r.x0, y, bytes);
        if (edge < 1)
            blur_row_wide(f, bytes, in, out, n, m, edge);
        else if (m == 6 && bytes == 1)
            blur_bytes_13(in, out, n);
        else if (m == 6)
            blur_row_13(bytes, in, out, n);
        else if (bytes == 1 && m <= BLUR_BYTES)
            blur_bytes(in, (char *)hf_line(f, 0), out, n, m);
        else
            blur_row_wide(f, bytes, in, out, n, m, 1);
    }
}

static void blur_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int bytes = hf_narrow_bytes(f->s->storage);
    if (bytes == 1)
        blur_rows(f, r, 1);
    else if (bytes == 2)
        blur_rows(f, r, 2);
    else
        blur_rows(f, r, 4);
}

// 13 high, a vector wide: the windows in reach stay in registers on the way down, and so do halves made floats. Until
// the first row there are only windows to make, and nothing to write.
HF_INLINE void blur_column_13(const int bytes, const char *in, ptrdiff_t stride, float *out, ptrdiff_t out_stride,
                              int n)
{
    enum { ROWS = 8 };
    const vf scale = vf_set1(1 / 13.0f);
    vf a[ROWS + 6], w3[ROWS + 3], w6[ROWS + 7], first[10];  // a: from the centre on
    for (int y = 0; y < 10; y++)
        first[y] = vf_add(vf_add(narrow_load(bytes, in + y * stride), narrow_load(bytes, in + (y + 2) * stride)),
                          narrow_load(bytes, in + (y + 1) * stride));
    for (int y = 0; y < 7; y++)
        w6[y] = vf_add(first[y], first[y + 3]);
    for (int y = 0; y < 3; y++)
        w3[y] = first[y + 7];
    for (int y = 0; y < 6; y++)
        a[y] = narrow_load(bytes, in + (y + 6) * stride);
    for (int y = 0; y < n; y += ROWS) {
        HF_UNROLL(8)
        for (int k = 0; k < ROWS; k++) {
            if (y + k == n)
                return;
            const vf centre = bytes == 4 ? vf_load(in + 6 * stride) : a[k];
            a[k + 6] = narrow_load(bytes, in + 12 * stride);
            w3[k + 3] = vf_add(vf_add(a[k + 4], a[k + 6]), a[k + 5]);
            w6[k + 7] = vf_add(w3[k], w3[k + 3]);
            narrow_store(bytes, 1, (char *)out, vf_mul(blur_sum(centre, w6[k], w6[k + 7]), scale));
            in += stride;
            out += out_stride;
        }
        for (int k = 0; k < 6; k++)
            a[k] = a[ROWS + k];
        for (int k = 0; k < 3; k++)
            w3[k] = w3[ROWS + k];
        for (int k = 0; k < 7; k++)
            w6[k] = w6[ROWS + k];
    }
}

HF_INLINE void blur_column_wide(const struct hf_frame *f, const int bytes, char *in, ptrdiff_t stride, float *out,
                                ptrdiff_t out_stride, int n, int m, float edge)
{
    const struct blur_line sum = {f->work, VF_N, VF_N};
    struct blur_line from = {f->work + (ptrdiff_t)(n + 2 * m) * VF_N, VF_N, VF_N};
    if (bytes == 4)
        from = (struct blur_line){(float *)(void *)in, stride / 4, stride / 4};
    else
        for (int y = 0; y < n + 2 * m; y++)
            vf_store(from.p + y * VF_N, narrow_load(bytes, in + y * stride));
    blur_line(bytes, 1, from, sum, (char *)out, out_stride * (ptrdiff_t)sizeof(float), m, edge, n, 1);
}

// 3 high, row by row: nothing is shared that would be worth keeping.
HF_INLINE void blur_rows_3(const struct hf_frame *f, struct hf_rect r, const int bytes)
{
    const struct hf_buf *b = &f->buf[HF_BUF_BLUR_X];
    const ptrdiff_t stride = b->stride * (ptrdiff_t)sizeof(float);
    const vf scale = vf_set1(1 / 3.0f);
    for (int y = r.y0; y < r.y1; y++) {
        const char *in = hf_narrow_at(b, 0, r.x0, y, bytes);
        float *out = hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, y);
        for (int x = 0; x < r.x1 - r.x0; x += VF_N) {
            const char *p = in + x * bytes;
            const vf above = narrow_load(bytes, p - stride), below = narrow_load(bytes, p + stride);
            narrow_store(bytes, 1, (char *)(out + x), vf_mul(blur_sum(narrow_load(bytes, p), above, below), scale));
        }
    }
}

HF_INLINE void blur_columns(const struct hf_frame *f, struct hf_rect r, const int bytes)
{
    const struct hf_buf *b = &f->buf[HF_BUF_BLUR_X], *to = &f->buf[HF_BUF_BLUR];
    const float edge = hf_fields(f->s)->edge_y;
    const int m = hf_fields(f->s)->blur_y, n = r.y1 - r.y0, is_sum = bytes == 1 && m <= BLUR_BYTES && !(edge < 1),
              width = is_sum ? VECTOR : VF_N;
    const ptrdiff_t stride = b->stride * (ptrdiff_t)sizeof(float);
    if (m == 1 && bytes > 1 && !(edge < 1)) {
        blur_rows_3(f, r, bytes);
        return;
    }
    for (int x = r.x0; x < r.x1; x += width) {
        char *in = hf_narrow_at(b, 0, x, r.y0 - m, bytes);
        float *out = hf_at(to, 0, x, r.y0);
        if (is_sum)
            blur_byte_column(in, stride, out, to->stride, hf_min(r.x1 - x, VECTOR), n, m);
        else if (m == 6 && !(edge < 1))
            blur_column_13(bytes, in, stride, out, to->stride, n);
        else
            blur_column_wide(f, bytes, in, stride, out, to->stride, n, m, edge);
    }
}

static void blur_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int bytes = hf_narrow_bytes(f->s->storage);
    if (bytes == 1)
        blur_columns(f, r, 1);
    else if (bytes == 2)
        blur_columns(f, r, 2);
    else
        blur_columns(f, r, 4);
}
