// SPDX-License-Identifier: BSD-3-Clause
// Near CoC max on vectors: along x maxima of 2, 4, 8 ... values come from each other, and two overlapping ones of those
// cover any width; along y windows share what they have in common. Values are bytes, halves or floats, whichever the
// storage has; none is negative, so that all are compared as integers.
#ifndef HF_NEAR_MAX_SIMD_H
#define HF_NEAR_MAX_SIMD_H

#include "pixel/fields.h"
#include "pixel/format_vf.h"

enum { VECTOR = (int)sizeof(vi) };  // bytes

HF_INLINE vi narrow_max(const int bytes, vi a, vi b)
{
    return bytes == 1 ? vi_max8(a, b) : bytes == 2 ? vi_max16(a, b) : vi_max(a, b);
}

// The vector that begins n bytes, or values, into consecutive vectors v[0], v[1] ...; n is a literal.
#define vi_shift(v, n) vi_align((v)[(n) / VECTOR], (v)[(n) / VECTOR + 1], (n) % VECTOR)
#define narrow_shift(bytes, v, n)                                                                                      \
    ((bytes) == 1 ? vi_shift(v, n) : (bytes) == 2 ? vi_shift(v, 2 * (n)) : vi_shift(v, 4 * (n)))

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
HF_INLINE void max_row(const int bytes, const char *in, char *out, int n, const int width)
{
    const int lag = VECTOR == 4 * bytes ? 5 : 4;  // of the output behind the input, vectors
    const int size = n * bytes, inputs = (n + width - 1) * bytes;
    const vi zero = vi_set1(0);
    vi a[2] = {zero, zero}, m2[2] = {zero, zero}, m4[3] = {zero, zero, zero}, m8[4] = {zero, zero, zero, zero};
    for (int i = 0; i < size + lag * VECTOR; i += VECTOR) {
        a[0] = a[1];
        if (i < inputs)
            a[1] = vi_load(in + i);
        m2[0] = m2[1];
        m2[1] = narrow_max(bytes, a[0], narrow_shift(bytes, a, 1));
        m4[0] = m4[1];
        m4[1] = narrow_max(bytes, m2[0], narrow_shift(bytes, m2, 2));
        m8[0] = m8[1];
        m8[1] = m8[2];
        m8[lag - 3] = narrow_max(bytes, m4[0], narrow_shift(bytes, m4, 4));
        if (i >= lag * VECTOR)
            vi_store(out + i - lag * VECTOR, width == 8 ? m8[0] : narrow_max(bytes, m8[0], narrow_shift(bytes, m8, 5)));
    }
}

// Maxima of 5 values, in registers.
HF_INLINE void max_row_5(const int bytes, const char *in, char *out, int n)
{
    const int size = n * bytes, inputs = (n + 4) * bytes;
    const vi zero = vi_set1(0);
    vi a[3] = {vi_load(in), zero, zero};  // the third for vectors of 4 values
    if (VECTOR == 4 * bytes && VECTOR < inputs)
        a[1] = vi_load(in + VECTOR);
    for (int i = 0; i < size; i += VECTOR) {
        const int last = VECTOR == 4 * bytes ? 2 : 1;
        if (i + last * VECTOR < inputs)
            a[last] = vi_load(in + i + last * VECTOR);
        const vi m2 = narrow_max(bytes, narrow_shift(bytes, a, 1), narrow_shift(bytes, a, 2));
        const vi m4 = narrow_max(bytes, narrow_shift(bytes, a, 3), narrow_shift(bytes, a, 4));
        vi_store(out + i, narrow_max(bytes, a[0], narrow_max(bytes, m2, m4)));
        a[0] = a[1];
        a[1] = a[2];
    }
}

// A row of any width, from its first value; work: room for a row.
HF_INLINE void max_row_wide(const int bytes, const char *in, char *work, char *out, int n, int m)
{
    const int span = max_span(m);
    int len = 1;
    if (span >= 8) {
        max_row(bytes, in, work, n + 2 * m - 7, 8);
        in = work;
        len = 8;
    }
    for (; len < span; len *= 2) {
        // In place: a value is read for the last time when it is replaced.
        for (int x = 0; x < (n + 2 * (m - len) + 1) * bytes; x += VECTOR)
            vi_store(work + x, narrow_max(bytes, vi_load(in + x + len * bytes), vi_load(in + x)));
        in = work;
    }
    const int second = (2 * m + 1 - span) * bytes;
    for (int x = 0; x < n * bytes; x += VECTOR)
        vi_store(out + x, narrow_max(bytes, vi_load(in + x + second), vi_load(in + x)));
}

// Halves of 0..1: what has no sign and needs no clamp is cheaper where there are no instructions for halves.
#ifdef VF_SOFT_HALF
HF_INLINE vf coc_load_half(const void *p)
{
    return vf_mul(vi_as_vf(vi_shl(vi_load_u16(p), 13)), vf_set1(0x1p112f));
}

HF_INLINE void coc_store_half(void *p, vf v)
{
    vi_store_u16(p, encode_small(v, 10));
}
#else
HF_INLINE vf coc_load_half(const void *p)
{
    return vf_load_half(p);
}

HF_INLINE void coc_store_half(void *p, vf v)
{
    vf_store_half(p, v);
}
#endif

// A row of n CoCs that the storage holds exactly, as it holds them. Returns where: out, or for floats where they are.
HF_INLINE const char *narrow_row(const int bytes, const float *in, int n, char *out)
{
    if (bytes == 4)
        return (const char *)in;
    for (int x = 0; x < n; x += VF_N)
        if (bytes == 1)
            vi_store_u8(out + x, vf_to_vi(vf_add(vf_mul(vf_load(in + x), vf_set1(255)), vf_set1(0.5f))));
        else
            coc_store_half(out + 2 * x, vf_load(in + x));
    return out;
}

// A stored CoC, bytes as whole numbers.
HF_INLINE vf narrow_load(const int bytes, const char *p)
{
    return bytes == 1 ? vi_to_vf(vi_load_u8(p)) : bytes == 2 ? coc_load_half(p) : vf_load(p);
}

// As the storage holds it: in its own width, or in a float.
HF_INLINE void narrow_store(const int bytes, const int widen, char *p, vf v)
{
    if (bytes == 1) {
        const vi k = vf_to_vi(vf_add(v, vf_set1(0.5f)));
        if (widen)
            vf_store(p, vf_mul(vi_to_vf(k), vf_set1(1 / 255.0f)));
        else
            vi_store_u8(p, k);
    } else if (bytes == 2) {
        uint16_t half[VF_N];
        coc_store_half(widen ? (char *)half : p, v);
        if (widen)
            vf_store(p, coc_load_half(half));
    } else {
        vf_store(p, v);
    }
}

// Bytes as fractions: their products are rounded as those of the C are.
HF_INLINE vf narrow_value(const int bytes, const char *p)
{
    const vf v = narrow_load(bytes, p);
    return bytes == 1 ? vf_mul(v, vf_set1(1 / 255.0f)) : v;
}

// Maxima of a row with a window's first and last values, which lie in rows or columns of their own, times the edge.
HF_INLINE void max_edges(const int bytes, const char *first, const char *last, char *out, int n, float edge)
{
    for (int x = 0; x < n * bytes; x += VF_N * bytes) {
        const vf ends = vf_max(narrow_value(bytes, first + x), narrow_value(bytes, last + x));
        const vf most = vf_max(vf_mul(vf_set1(edge), ends), narrow_value(bytes, out + x));
        narrow_store(bytes, 0, out + x, bytes == 1 ? vf_mul(most, vf_set1(255)) : most);
    }
}

HF_INLINE void max_rows(const struct hf_frame *f, struct hf_rect r, const int bytes)
{
    const int m = hf_fields(f->s)->max_x, n = r.x1 - r.x0;
    const float edge = hf_fields(f->s)->edge_x;
    const struct hf_buf *b = &f->buf[HF_BUF_COC4];
    for (int y = r.y0; y < r.y1; y++) {
        const float *coc = hf_at(b, hf_fields(f->s)->near_coc, r.x0 - m, y);
        char *out = hf_narrow_at(&f->buf[HF_BUF_MAX_X], 0, r.x0, y, bytes);
        for (int x = 0; x < n + 2 * m + 15; x += 16)  // comes from memory, in rows too short for hardware prefetchers
            __builtin_prefetch(coc + 4 * b->stride + x);
        const char *in = narrow_row(bytes, coc, n + 2 * m, (char *)hf_line(f, 0));
        if (edge < 1) {
            max_row_wide(bytes, in + bytes, (char *)hf_line(f, 1), out, n, m - 1);
            max_edges(bytes, in, in + 2 * m * bytes, out, n, edge);
        } else if (m == 6) {
            max_row(bytes, in, out, n, 13);
        } else if (m == 2) {
            max_row_5(bytes, in, out, n);
        } else {
            max_row_wide(bytes, in, (char *)hf_line(f, 1), out, n, m);
        }
    }
}

static void max_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int bytes = hf_narrow_bytes(f->s->storage);
    if (bytes == 1)
        max_rows(f, r, 1);
    else if (bytes == 2)
        max_rows(f, r, 2);
    else
        max_rows(f, r, 4);
}

// `rows` rows of a column, a vector wide. What their windows of 2m + 1 rows, not fewer, have in common is a core;
// upwards from it each row extends it to an earlier window's beginning, which is put into `up`, downwards to a later
// one's end. For 13 and 8 rows this takes 3 maxima and 2.5 loads a value, and `up` is in registers.
HF_INLINE void max_column(const int bytes, const char *in, ptrdiff_t stride, char *out, ptrdiff_t out_stride, int m,
                          const int rows, vi *up)
{
    vi window = vi_load(in + (rows - 1) * stride);
    for (int y = rows; y <= 2 * m; y++)
        window = narrow_max(bytes, window, vi_load(in + y * stride));
    up[rows - 1] = window;
    HF_UNROLL(8)
    for (int y = rows - 2; y >= 0; y--)
        up[y] = window = narrow_max(bytes, window, vi_load(in + y * stride));
    vi_store(out, window);
    if (rows > 1)
        window = vi_load(in + (2 * m + 1) * stride);
    HF_UNROLL(8)
    for (int y = 1; y < rows; y++) {
        if (y > 1)
            window = narrow_max(bytes, window, vi_load(in + (2 * m + y) * stride));
        vi_store(out + y * out_stride, narrow_max(bytes, up[y], window));
    }
}

enum { MAX_ROWS = 8, MAX_MANY = 64 };

HF_INLINE void max_columns(const struct hf_frame *f, struct hf_rect r, const int bytes)
{
    const struct hf_buf *b = &f->buf[HF_BUF_MAX_X], *to = &f->buf[HF_BUF_MAX];
    const ptrdiff_t stride = b->stride * (ptrdiff_t)sizeof(float), out_stride = to->stride * (ptrdiff_t)sizeof(float);
    const float edge = hf_fields(f->s)->edge_y;
    const int reach = hf_fields(f->s)->max_y, m = reach - (edge < 1);
    const int most = m < MAX_ROWS / 2 ? 2 * m + 1 : m < 24 ? MAX_ROWS : hf_min(2 * m + 1, MAX_MANY);
    for (int y = r.y0, rows; y < r.y1; y += rows) {
        rows = hf_min(most, r.y1 - y);
        for (int x = r.x0; x < r.x1; x += VECTOR / bytes) {
            const char *in = hf_narrow_at(b, 0, x, y - m, bytes);
            char *out = hf_narrow_at(to, 0, x, y, bytes);
            vi up[MAX_MANY];
            if (rows == MAX_ROWS)
                max_column(bytes, in, stride, out, out_stride, m, MAX_ROWS, up);
            else if (rows == 5 && m == 2)
                max_column(bytes, in, stride, out, out_stride, 2, 5, up);
            else
                max_column(bytes, in, stride, out, out_stride, m, rows, up);
        }
    }
    for (int y = r.y0; y < r.y1 && edge < 1; y++)
        max_edges(bytes, hf_narrow_at(b, 0, r.x0, y - reach, bytes), hf_narrow_at(b, 0, r.x0, y + reach, bytes),
                  hf_narrow_at(to, 0, r.x0, y, bytes), r.x1 - r.x0, edge);
}

static void max_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int bytes = hf_narrow_bytes(f->s->storage);
    if (bytes == 1)
        max_columns(f, r, 1);
    else if (bytes == 2)
        max_columns(f, r, 2);
    else
        max_columns(f, r, 4);
}

#endif
