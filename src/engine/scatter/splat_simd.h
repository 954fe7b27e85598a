// SPDX-License-Identifier: BSD-3-Clause
// Splats on vectors of four 64-bit integers. Additions are exact, so any order gives the bits of the C. The rows above
// and below a source have the same span, so each product serves both.
#include "pixel/pass_c.h"
#include "engine/scatter/kernels.h"
#include "simd/simd.h"

// The column of a span's end, in lanes. clip: it may lie outside the window; then it is moved into the margin, with
// room for `more` pixels after it.
HF_INLINE ptrdiff_t splat_column(int x, int width, int more, const int clip)
{
    return 4 * (ptrdiff_t)(clip ? hf_max(hf_min(x, width), -1 - more) : x);
}

HF_INLINE void splat_add(int64_t *p, vl a)
{
    vl_store(p, vl_add(vl_load(p), a));
}

HF_INLINE void splat_take(int64_t *p, vl a)
{
    vl_store(p, vl_sub(vl_load(p), a));
}

// Whether row y of the frame is in the window.
HF_INLINE int splat_has(const struct hf_sums *s, int y)
{
    return y >= s->y0 && y < s->y1;
}

// Draw rows `first` to `last` above and below one source. one: a unit of it times a row's weight. clip: the window may
// not contain all of them.
HF_INLINE void splat_rows(const struct hf_sums *s, const int32_t *half, int x, int y, vl one, int first, int last,
                          const int clip)
{
    const vl whole = vl_shl8(one);
    const int width = s->x1 - s->x0;
    const ptrdiff_t *row = s->row + (y - s->y0);
    for (int dy = first; dy <= last; dy++) {
        const int n = half[dy] >> 8;
        const ptrdiff_t a = splat_column(x - n, width, 1, clip), b = splat_column(x + n, width, 1, clip);
        const vl part = vl_product(one, vl_low8(half + dy)), rest = vl_sub(whole, part);
        for (int side = dy ? 0 : 1; side < 2; side++) {
            if (clip && !splat_has(s, side ? y + dy : y - dy))
                continue;
            int64_t *p = s->lane + row[side ? dy : -dy];
            splat_add(p + a, part);
            splat_add(p + a + 4, rest);
            splat_take(p + b, rest);
            splat_take(p + b + 4, part);
        }
    }
}

// Draw a source's rows from `first` on.
HF_INLINE void splat_one(const struct hf_sums *s, const struct hf_picture *p, const int32_t *half, int x, int y,
                         const int64_t *share, int first, const int clip)
{
    const vl unit = vl_load(share);
    splat_rows(s, half, x, y, vl_product(unit, vl_set1(HF_WHOLE_ROW)), first, p->rows - 2, clip);
    splat_rows(s, half, x, y, vl_product(unit, vl_set1(p->cap)), p->rows - 1, p->rows - 1, clip);
}

// Add the ends of four sources' spans that lie side by side: five additions instead of eight.
HF_INLINE void splat_four_row(int64_t *begin, int64_t *end, const vl part[4], const vl rest[4])
{
    splat_add(begin, part[0]);
    for (int k = 1; k < 4; k++)
        splat_add(begin + 4 * k, vl_add(rest[k - 1], part[k]));
    splat_add(begin + 16, rest[3]);
    splat_take(end, rest[0]);
    for (int k = 1; k < 4; k++)
        splat_take(end + 4 * k, vl_add(part[k - 1], rest[k]));
    splat_take(end + 16, part[3]);
}

// Draw the rows dy above and below four sources side by side, of weight one[]. If their spans differ by more than a
// fraction of a pixel, they are drawn one by one.
HF_INLINE void splat_four_rows(const struct hf_sums *s, const int32_t *const half[4], int x, int y, int dy,
                               const vl one[4], const int clip)
{
    const int width = s->x1 - s->x0, n = half[0][dy] >> 8;
    const ptrdiff_t *row = s->row + (y - s->y0);
    if (((half[0][dy] ^ half[1][dy]) | (half[0][dy] ^ half[2][dy]) | (half[0][dy] ^ half[3][dy])) >> 8) {
        for (int k = 0; k < 4; k++)
            splat_rows(s, half[k], x + k, y, one[k], dy, dy, clip);
        return;
    }
    const ptrdiff_t begin = splat_column(x - n, width, 4, clip), end = splat_column(x + n, width, 4, clip);
    vl part[4], rest[4];
    for (int k = 0; k < 4; k++) {
        part[k] = vl_product(one[k], vl_low8(half[k] + dy));
        rest[k] = vl_sub(vl_shl8(one[k]), part[k]);
    }
    for (int side = dy ? 0 : 1; side < 2; side++)
        if (!clip || splat_has(s, side ? y + dy : y - dy)) {
            int64_t *lane = s->lane + row[side ? dy : -dy];
            splat_four_row(lane + begin, lane + end, part, rest);
        }
}

HF_INLINE void splat_four(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list, int i,
                          const int clip)
{
    const int x = list->x[i] - s->x0, y = list->y[i];
    const struct hf_picture *p[4];
    const int32_t *half[4];
    vl one[4];
    int rows = 1 << 30, most = 0;
    for (int k = 0; k < 4; k++) {
        p[k] = &a->picture[list->picture[i + k]];
        half[k] = a->half + p[k]->first;
        one[k] = vl_product(vl_load(list->share[i + k]), vl_set1(HF_WHOLE_ROW));
        rows = hf_min(rows, p[k]->rows);
        most = hf_max(most, p[k]->rows);
    }
    for (int dy = 0; dy < rows - 1; dy++)
        splat_four_rows(s, half, x, y, dy, one, clip);
    if (rows == most) {
        for (int k = 0; k < 4; k++)
            one[k] = vl_product(vl_load(list->share[i + k]), vl_set1(p[k]->cap));
        splat_four_rows(s, half, x, y, rows - 1, one, clip);
        return;
    }
    for (int k = 0; k < 4; k++)
        splat_one(s, p[k], half[k], x + k, y, list->share[i + k], rows - 1, clip);
}

// How many sources side by side begin with source i, 4 or 1; *picture is their largest sprite.
HF_INLINE int splat_together(const struct hf_aperture *a, const struct hf_splats *list, int i,
                             const struct hf_picture **picture)
{
    int most = list->picture[i];
    *picture = &a->picture[most];
    if (i + 4 > list->count)
        return 1;
    for (int k = 1; k < 4; k++) {
        if (list->x[i + k] != list->x[i] + k || list->y[i + k] != list->y[i])
            return 1;
        most = hf_max(most, list->picture[i + k]);
    }
    *picture = &a->picture[most];
    return 4;
}

static void splat_simd(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list)
{
    for (int i = 0, n; i < list->count; i += n) {
        const struct hf_picture *p;
        n = splat_together(a, list, i, &p);
        const int x = list->x[i], y = list->y[i], right = x + n + p->reach_x, left = x - p->reach_x;
        if (right < s->x0 || left >= s->x1 || y + p->reach_y < s->y0 || y - p->reach_y >= s->y1)
            continue;
        const int clip = left < s->x0 || right > s->x1 || y - p->reach_y < s->y0 || y + p->reach_y >= s->y1;
        if (n == 4 && clip)
            splat_four(s, a, list, i, 1);
        else if (n == 4)
            splat_four(s, a, list, i, 0);
        else if (clip)
            splat_one(s, p, a->half + p->first, x - s->x0, y, list->share[i], 0, 1);
        else
            splat_one(s, p, a->half + p->first, x - s->x0, y, list->share[i], 0, 0);
    }
}

static void splat_runs_simd(const struct hf_sums *s, int x, int y, const struct hf_run *run, int rows,
                            const int64_t share[4])
{
    const vl one = vl_load(share);
    const int width = s->x1 - s->x0, end = hf_min(s->y1 - y, rows);
    x -= s->x0;
    for (int i = hf_max(s->y0 - y, 0); i < end; i++) {
        int64_t *row = s->lane + s->row[y + i - s->y0];
        const vl unit = vl_product(one, vl_set1(run[i].weight)), whole = vl_shl8(unit);
        const vl pa = vl_product(unit, vl_low8(&run[i].a)), pb = vl_product(unit, vl_low8(&run[i].b));
        int64_t *p = row + splat_column(x + (run[i].a >> 8), width, 1, 1);
        int64_t *q = row + splat_column(x + (run[i].b >> 8), width, 1, 1);
        splat_add(p, vl_sub(whole, pa));
        splat_add(p + 4, pa);
        splat_take(q, vl_sub(whole, pb));
        splat_take(q + 4, pb);
    }
}

// Differences of weights, made positive because the products need that.
HF_INLINE void splat_tap(int64_t *p, vl one, vl offset, int weight)
{
    splat_add(p, vl_sub(vl_product(one, vl_set1(weight + 65536)), offset));
}

static void splat_taps_simd(const struct hf_sums *s, int x, int y, const int16_t *tap, int columns, int rows,
                            const int64_t share[4])
{
    const vl one = vl_load(share), offset = vl_shl8(vl_shl8(one));
    const int width = s->x1 - s->x0, end = hf_min(s->y1 - y, rows);
    x -= s->x0;
    // Columns left of the window are summed into its first column; those right of it are not needed.
    const int first = hf_max(hf_min(-x, columns), 0), last = hf_max(hf_min(columns, width - x), first);
    for (int j = hf_max(s->y0 - y, 0); j < end; j++) {
        const int16_t *t = tap + (ptrdiff_t)j * columns;
        int64_t *row = s->lane + s->row[y + j - s->y0], *p = row + 4 * (ptrdiff_t)(x + first);
        int before = 0;
        for (int i = 0; i < first; i++)
            before += t[i];
        if (first)
            splat_tap(row, one, offset, before);
        for (int i = first; i < last; i++, p += 4)
            splat_tap(p, one, offset, t[i]);
    }
}

HF_INLINE void settle_bins(int64_t *const lane[HF_BINS], const int count, int n, int channels,
                           const double (*unscale)[4], float *const out[4])
{
    const vl zero = vl_set1(0);
    vl sum[HF_BINS];
    for (int b = 0; b < count; b++) {
        sum[b] = zero;
        for (int x = -HF_SUMS_MARGIN; x < 0; x++) {
            sum[b] = vl_add(sum[b], vl_load(lane[b] + 4 * x));
            vl_store(lane[b] + 4 * x, zero);
        }
    }
    for (int x = 0; x < n; x += 4) {
        v4 pixel[4];
        for (int i = 0; i < 4; i++) {
            for (int b = 0; b < count; b++) {
                sum[b] = vl_add(sum[b], vl_load(lane[b] + 4 * (x + i)));
                vl_store(lane[b] + 4 * (x + i), zero);
            }
            pixel[i] = vl_scaled(sum, count, unscale);
        }
        v4_transpose(pixel);
        for (int c = 0; c < 4; c++)
            if (c < channels || c == 3)
                v4_store(out[c] + x, pixel[c]);
    }
    for (int b = 0; b < count; b++)
        for (int x = n; x < n + HF_SUMS_MARGIN; x++)
            vl_store(lane[b] + 4 * x, zero);
}

static void settle_simd(int64_t *const lane[HF_BINS], int bins, int n, int channels, const double (*unscale)[4],
                        float *const out[4])
{
    if (bins == 1)
        settle_bins(lane, 1, n, channels, unscale, out);
    else if (bins == 2)
        settle_bins(lane, 2, n, channels, unscale, out);
    else if (bins == 3)
        settle_bins(lane, 3, n, channels, unscale, out);
    else if (bins == 4)
        settle_bins(lane, 4, n, channels, unscale, out);
    else
        settle_bins(lane, bins, n, channels, unscale, out);
}
