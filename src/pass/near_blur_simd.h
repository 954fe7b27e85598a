// SPDX-License-Identifier: BSD-3-Clause
// Near CoC blur on vectors: the sums of 2, 4, 8 ... neighbours that the C makes for each pixel are shared between
// pixels, 6 additions a value for 13 wide. No running sum: nothing drifts, and the bits do not depend on where a
// tile starts.

// Up to 9 levels: 2^8 > 128, the largest reach at the largest max_radius and aspect 1; narrow pixels reach farther in x.
enum { BLUR_LEVELS = 12 };

static void blur_x_simd(const struct hf_frame *f, struct hf_rect r)
{
    const int m = f->s->max_x, n = r.x1 - r.x0;
    const vf scale = vf_set1(1 / (float)(2 * m + 1));
    const float *level[BLUR_LEVELS];  // level[i][x]: sum of the 2^i values from x
    for (int y = r.y0; y < r.y1; y++) {
        level[0] = hf_at(&f->buf[HF_BUF_MAX], 0, r.x0 - m, y);
        for (int i = 1; 1 << i <= m; i++) {
            float *sum = hf_line(f, i);
            for (int x = 0; x < n + 2 * m - (1 << i) + 1; x += VF_N)
                vf_store(sum + x, vf_add(vf_load(level[i - 1] + x), vf_load(level[i - 1] + x + (1 << i) / 2)));
            level[i] = sum;
        }
        float *out = hf_at(&f->buf[HF_BUF_BLUR_X], 0, r.x0, y);
        for (int x = 0; x < n; x += VF_N) {
            vf sum = vf_load(level[0] + x + m);
            for (int i = 0, covered = 0; 1 << i <= m; i++)
                if (m >> i & 1) {
                    const float *p = level[i] + x + m;
                    sum = vf_add(sum, vf_add(vf_load(p - covered - (1 << i)), vf_load(p + covered + 1)));
                    covered += 1 << i;
                }
            vf_store(out + x, coc_round(f->s->storage, vf_mul(sum, scale)));
        }
    }
}

static void blur_y_strip(const struct hf_frame *f, struct hf_rect r, float *rows)
{
    const int m = f->s->max_y, n = r.y1 - r.y0, width = r.x1 - r.x0;
    const struct hf_buf *b = &f->buf[HF_BUF_BLUR_X];
    const vf scale = vf_set1(1 / (float)(2 * m + 1));
    const float *level[BLUR_LEVELS];
    ptrdiff_t stride[BLUR_LEVELS];
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
    for (int y = 0; y < n; y++)
        for (int x = 0; x < width; x += VF_N) {
            vf sum = vf_load(level[0] + (y + m) * stride[0] + x);
            for (int i = 0, covered = 0; 1 << i <= m; i++)
                if (m >> i & 1) {
                    const float *p = level[i] + (y + m) * stride[i] + x;
                    sum = vf_add(sum, vf_add(vf_load(p - (covered + (1 << i)) * stride[i]),
                                             vf_load(p + (covered + 1) * stride[i])));
                    covered += 1 << i;
                }
            vf_store(hf_at(&f->buf[HF_BUF_BLUR], 0, r.x0 + x, r.y0 + y),
                     coc_round(f->s->storage, vf_mul(sum, scale)));
        }
}

static void blur_y_simd(const struct hf_frame *f, struct hf_rect r)
{
    for (int x = r.x0; x < r.x1; x += NEAR_STRIP)
        blur_y_strip(f, (struct hf_rect){x, r.y0, hf_min(x + NEAR_STRIP, r.x1), r.y1}, f->work);
}
