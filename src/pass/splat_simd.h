// SPDX-License-Identifier: BSD-3-Clause
// Splats on vectors of four 64-bit integers: additions are exact, so these are the bits of the C in any order. Rows
// above
// and below a source have the same run: each product serves eight additions.

// Columns are clamped to the window unless the picture is known to lie inside.
HF_INLINE int64_t *splat_column(int64_t *row, int x, int width, const int clamp)
{
    return row + 4 * (ptrdiff_t)(clamp ? hf_max(hf_min(x, width), 0) : x);
}

HF_INLINE void splat_row(int64_t *row, int x, int n, int width, vl part, vl rest, const int clamp)
{
    int64_t *a = splat_column(row, x - n, width, clamp), *b = splat_column(row, x - n + 1, width, clamp);
    int64_t *c = splat_column(row, x + n, width, clamp), *d = splat_column(row, x + n + 1, width, clamp);
    vl_store(a, vl_add(vl_load(a), part));
    vl_store(b, vl_add(vl_load(b), rest));
    vl_store(c, vl_sub(vl_load(c), rest));
    vl_store(d, vl_sub(vl_load(d), part));
}

// Rows `first` to `last` above and below a source.
HF_INLINE void splat_rows(const struct hf_sums *s, const int32_t *half, int x, int y, vl one, int first, int last,
                          const int clamp)
{
    const vl whole = vl_shl8(one);
    const int width = s->x1 - s->x0;
    const int down0 = hf_max(first, s->y0 - y), down1 = hf_min(last, s->y1 - 1 - y);
    const int up0 = hf_max(hf_max(first, 1), y - s->y1 + 1), up1 = hf_min(last, y - s->y0);
    const int both0 = hf_max(down0, up0), both1 = hf_min(down1, up1);
    const ptrdiff_t *row = s->row + (y - s->y0);
    for (int dy = both0; dy <= both1; dy++) {
        const int n = half[dy] >> 8;
        const vl part = vl_times(one, (uint32_t)half[dy] & 255), rest = vl_sub(whole, part);
        splat_row(s->lane + row[dy], x, n, width, part, rest, clamp);
        splat_row(s->lane + row[-dy], x, n, width, part, rest, clamp);
    }
    // Rows of which the window holds but one: before, and after, those that it holds both of.
    for (int side = 0; side < 2; side++)
        for (int dy = side ? up0 : down0; dy <= (side ? up1 : down1); dy++) {
            if (dy == both0 && both1 >= both0) {
                dy = both1;
                continue;
            }
            const vl part = vl_times(one, (uint32_t)half[dy] & 255);
            splat_row(s->lane + row[side ? -dy : dy], x, half[dy] >> 8, width, part, vl_sub(whole, part), clamp);
        }
}

HF_INLINE void splat_one(const struct hf_sums *s, const struct hf_picture *p, const int32_t *half, int x, int y,
                         const int64_t *share, const int clamp)
{
    const vl unit = vl_load(share);
    if (p->rows > 1)
        splat_rows(s, half, x, y, vl_times(unit, HF_WHOLE_ROW), 0, p->rows - 2, clamp);
    splat_rows(s, half, x, y, vl_times(unit, (uint32_t)p->cap), p->rows - 1, p->rows - 1, clamp);
}

// Four sources side by side with the same picture: their ends lie side by side too, and five additions do for eight.
HF_INLINE void splat_four_row(int64_t *row, int x, int n, const vl *left, const vl *right)
{
    int64_t *a = row + 4 * (ptrdiff_t)(x - n), *b = row + 4 * (ptrdiff_t)(x + n);
    for (int i = 0; i < 5; i++)
        vl_store(a + 4 * i, vl_add(vl_load(a + 4 * i), left[i]));
    for (int i = 0; i < 5; i++)
        vl_store(b + 4 * i, vl_sub(vl_load(b + 4 * i), right[i]));
}

HF_INLINE void splat_four_rows(const struct hf_sums *s, const int32_t *half, int x, int y, const int64_t *share,
                               uint32_t weight, int first, int last)
{
    vl one[4], whole[4], left[5], right[5];
    for (int k = 0; k < 4; k++) {
        one[k] = vl_times(vl_load(share + 4 * k), weight);
        whole[k] = vl_shl8(one[k]);
    }
    for (int dy = first; dy <= last; dy++) {
        const int above = y - dy >= s->y0 && y - dy < s->y1, below = y + dy >= s->y0 && y + dy < s->y1;
        const int n = half[dy] >> 8;
        vl part[4], rest[4];
        if (!above && !below)
            continue;
        for (int k = 0; k < 4; k++) {
            part[k] = vl_times(one[k], (uint32_t)half[dy] & 255);
            rest[k] = vl_sub(whole[k], part[k]);
        }
        left[0] = part[0];
        right[0] = rest[0];
        for (int k = 1; k < 4; k++) {
            left[k] = vl_add(rest[k - 1], part[k]);
            right[k] = vl_add(part[k - 1], rest[k]);
        }
        left[4] = rest[3];
        right[4] = part[3];
        if (below)
            splat_four_row(s->lane + s->row[y + dy - s->y0], x, n, left, right);
        if (above && dy)
            splat_four_row(s->lane + s->row[y - dy - s->y0], x, n, left, right);
    }
}

HF_INLINE void splat_four(const struct hf_sums *s, const struct hf_picture *p, const int32_t *half, int x, int y,
                          const int64_t *share)
{
    if (p->rows > 1)
        splat_four_rows(s, half, x, y, share, HF_WHOLE_ROW, 0, p->rows - 2);
    splat_four_rows(s, half, x, y, share, (uint32_t)p->cap, p->rows - 1, p->rows - 1);
}

// From source i on, four in a row with the same picture?
HF_INLINE int splat_is_four(const struct hf_splats *list, int i)
{
    if (i + 4 > list->count)
        return 0;
    for (int k = 1; k < 4; k++)
        if (list->picture[i + k] != list->picture[i] || list->x[i + k] != list->x[i] + k ||
            list->y[i + k] != list->y[i])
            return 0;
    return 1;
}

static void splat_simd(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list)
{
    const int width = s->x1 - s->x0;
    for (int i = 0; i < list->count; i++) {
        const struct hf_picture *p = &a->picture[list->picture[i]];
        const int x = list->x[i] - s->x0, y = list->y[i];
        const int inside = x - p->reach_x >= 0 && x + p->reach_x <= width;
        if (inside && x + 3 + p->reach_x <= width && splat_is_four(list, i)) {
            splat_four(s, p, a->half + p->first, x, y, list->share[i]);
            i += 3;
        } else if (inside) {
            splat_one(s, p, a->half + p->first, x, y, list->share[i], 0);
        } else {
            splat_one(s, p, a->half + p->first, x, y, list->share[i], 1);
        }
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
        const int a = x + (run[i].a >> 8), b = x + (run[i].b >> 8);
        const vl unit = vl_times(one, (uint32_t)run[i].weight), whole = vl_shl8(unit);
        const vl pa = vl_times(unit, (uint32_t)run[i].a & 255), pb = vl_times(unit, (uint32_t)run[i].b & 255);
        int64_t *p = splat_column(row, a, width, 1), *q = splat_column(row, b, width, 1);
        vl_store(p, vl_add(vl_load(p), vl_sub(whole, pa)));
        p = splat_column(row, a + 1, width, 1);
        vl_store(p, vl_add(vl_load(p), pa));
        vl_store(q, vl_sub(vl_load(q), vl_sub(whole, pb)));
        q = splat_column(row, b + 1, width, 1);
        vl_store(q, vl_sub(vl_load(q), pb));
    }
}

static void splat_taps_simd(const struct hf_sums *s, int x, int y, const int16_t *tap, int columns, int rows,
                            const int64_t share[4])
{
    const vl one = vl_load(share), offset = vl_shl8(vl_shl8(one)); // weights are made positive: products want that
    const int width = s->x1 - s->x0, end = hf_min(s->y1 - y, rows);
    x -= s->x0;
    // Columns left of the window come together in its first, those right of it are of no use.
    const int first = hf_max(hf_min(-x, columns), 0), last = hf_max(hf_min(columns, width - x), first);
    for (int j = hf_max(s->y0 - y, 0); j < end; j++) {
        const int16_t *t = tap + (ptrdiff_t)j * columns;
        int64_t *row = s->lane + s->row[y + j - s->y0], *p = row + 4 * (ptrdiff_t)(x + first);
        int before = 0;
        for (int i = 0; i < first; i++)
            before += t[i];
        if (first)
            vl_store(row, vl_add(vl_load(row), vl_sub(vl_times(one, (uint32_t)(before + 65536)), offset)));
        for (int i = first; i < last; i++, p += 4)
            vl_store(p, vl_add(vl_load(p), vl_sub(vl_times(one, (uint32_t)(t[i] + 65536)), offset)));
    }
}

static void settle_simd(int64_t *lane, int n, int channels, const double unscale[4], float *const out[4])
{
    vl sum = vl_set1(0);
    const vl zero = sum;
    for (int x = 0; x < n; x += 4) {
        v4 pixel[4];
        for (int i = 0; i < 4; i++) {
            sum = vl_add(sum, vl_load(lane + 4 * (x + i)));
            pixel[i] = vl_scaled(sum, unscale);
            vl_store(lane + 4 * (x + i), zero);
        }
        v4_transpose(pixel);
        for (int c = 0; c < 4; c++)
            if (c < channels || c == 3)
                v4_store(out[c] + x, pixel[c]);
    }
    for (int x = n; x < n + 2; x++)
        vl_store(lane + 4 * x, zero);
}
