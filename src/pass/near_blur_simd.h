// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur on vectors: the sums of 2, 4, 8 ... neighbours that the C makes for each pixel are shared between
// pixels, 6 additions a value for 13 wide. No running sum: nothing drifts, and the bits do not depend on where a
// tile starts.

// Up to 9 levels: 2^8 > 128, the largest reach at the largest max_radius and aspect 1; narrow pixels reach farther in x.
enum { BLUR_LEVELS = 12 };

// The windows of one output value: where they begin, left and right of the centre, in their level.
struct blur_terms {
    const float *level[BLUR_LEVELS];
    ptrdiff_t stride[BLUR_LEVELS], left[BLUR_LEVELS], right[BLUR_LEVELS];
    int count;
};

// level[i] holds sums of 2^i values, m values before the first output; offsets are counted in steps.
static void blur_terms_of(struct blur_terms *t, int m, const float *const level[BLUR_LEVELS],
                          const ptrdiff_t step[BLUR_LEVELS], const ptrdiff_t stride[BLUR_LEVELS])
{
    t->count = 0;
    for (int i = 0, covered = 0; 1 << i <= m; i++)
        if (m >> i & 1) {
            const int k = t->count++;
            t->level[k] = level[i];
            t->stride[k] = stride[i];
            t->left[k] = (m - covered - (1 << i)) * step[i];
            t->right[k] = (m + covered + 1) * step[i];
            covered += 1 << i;
        }
}

// A row of sums from the centres and their windows; count is a constant where it is small.
HF_INLINE void blur_sum(const float *centre, const struct blur_terms *t, const int count, int y, float *out, int n,
                        vf scale, enum hf_storage storage)
{
    for (int x = 0; x < n; x += VF_N) {
        vf sum = vf_load(centre + x);
#pragma GCC unroll 4
        for (int k = 0; k < count; k++) {
            const float *p = t->level[k] + y * t->stride[k] + x;
            sum = vf_add(sum, vf_add(vf_load(p + t->left[k]), vf_load(p + t->right[k])));
        }
        vf_store(out + x, coc_round(storage, vf_mul(sum, scale)));
    }
}

static void blur_row(const float *centre, const struct blur_terms *t, int y, float *out, int n, vf scale,
                     enum hf_storage storage)
{
    if (t->count == 1)
        blur_sum(centre, t, 1, y, out, n, scale, storage);
    else if (t->count == 2)
        blur_sum(centre, t, 2, y, out, n, scale, storage);
    else
        blur_sum(centre, t, t->count, y, out, n, scale, storage);
}

static void blur_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x, n = r.x1 - r.x0;
    const vf scale = vf_set1(1 / (float)(2 * m + 1));
    const float *level[BLUR_LEVELS];
    ptrdiff_t one[BLUR_LEVELS], none[BLUR_LEVELS] = {0};
    struct blur_terms terms;
    for (int i = 0; i < BLUR_LEVELS; i++)
        one[i] = 1;
    for (int y = r.y0; y < r.y1; y++) {
        level[0] = hf_at(&f->buf[HF_BUF_MAX], 0, r.x0 - m, y);
        for (int i = 1; 1 << i <= m; i++) {
            float *sum = hf_line(f, i);
            for (int x = 0; x < n + 2 * m - (1 << i) + 1; x += VF_N)
                vf_store(sum + x, vf_add(vf_load(level[i - 1] + x), vf_load(level[i - 1] + x + (1 << i) / 2)));
            level[i] = sum;
        }
        blur_terms_of(&terms, m, level, one, none);
        blur_row(level[0] + m, &terms, 0, hf_at(&f->buf[HF_BUF_BLUR_X], 0, r.x0, y), n, scale, f->s->storage);
    }
}

static void blur_y_strip(const struct hf_frame *f, struct hf_rect r, float *rows)
{
    const int m = f->s->max_y, n = r.y1 - r.y0, width = r.x1 - r.x0;
    const struct hf_buf *b = &f->buf[HF_BUF_BLUR_X];
    const vf scale = vf_set1(1 / (float)(2 * m + 1));
    const float *level[BLUR_LEVELS];
    ptrdiff_t stride[BLUR_LEVELS];
    struct blur_terms terms;
    level[0] = hf_at(b, 0, r.x0, r.y0 - m);
    stride[0] = b->stride;
    for (int i = 1; 1 << i <= m; i++) {
        const int half = (1 << i) / 2, count = n + 2 * m - (1 << i) + 1;
        for (int y = 0; y < count; y++)
            for (int x = 0; x < width; x += VF_N) {
                const float *p = level[i - 1] + y * stride[i - 1] + x;
                vf_store(rows + y * NEAR_STRIP + x, vf_add(vf_load(p), vf_load(p + half * stride[i - 1])));
            }
        level[i] = rows;
        stride[i] = NEAR_STRIP;
        rows += (size_t)count * NEAR_STRIP;
    }
    blur_terms_of(&terms, m, level, stride, stride);
    for (int y = 0; y < n; y++)
        blur_row(level[0] + (y + m) * stride[0], &terms, y, hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0, r.y0 + y), width,
                 scale, f->s->storage);
}

static void blur_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int x = r.x0; x < r.x1; x += NEAR_STRIP)
        blur_y_strip(f, (struct hf_rect){x, r.y0, hf_min(x + NEAR_STRIP, r.x1), r.y1}, f->work);
}
