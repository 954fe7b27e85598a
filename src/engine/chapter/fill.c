// SPDX-License-Identifier: BSD-3-Clause
// Fill: closes the gaps between the taps by a 3x3 maximum, which makes highlights round and brighter, or a mean,
// which keeps their energy.
#include "engine/chapter/chapter.h"

static float max_3x3(const struct hf_buf *b, int c, int x, int y)
{
    float v = *hf_at(b, c, x, y);
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            const float t = *hf_at(b, c, x + i, y + j);
            v = t > v ? t : v;
        }
    return v + 0;  // of 0 and -0 whichever came first: now 0
}

static float mean_3x3(const struct hf_buf *b, int c, int x, int y)
{
    float row[3];
    for (int j = -1; j <= 1; j++) {
        const float *p = hf_at(b, c, x, y + j);
        row[j + 1] = (p[-1] + p[1]) + p[0];
    }
    return ((row[0] + row[2]) + row[1]) * (1 / 9.0f);
}

// How much a far neighbour of CoC g counts for a pixel of CoC f, 0 to 1. The per-pixel kernel takes only neighbours
// whose CoC differs by at most a quarter of the largest (chapter 3.5). The published demo gives every neighbour full
// weight whatever its CoC, so a quad that becomes slightly far suddenly brightens those around it. By default the
// weight therefore grows from 0 to 1 as g grows to a quarter, and falls from 1 to 0 as the difference grows from a
// quarter to a half.
static float far_counts(const struct hf_setup *s, float f, float g)
{
    const float apart = hf_fields(s)->per_pixel_kernel ? 4 * __builtin_fabsf(f - g) : 0;
    if (hf_chapter(s)->faithful)
        return apart <= 1;
    return hf_saturate(4 * g) * hf_saturate(2 - apart);
}

static float far_max(const struct hf_frame *f, int c, int x, int y)
{
    const struct hf_buf *b = &f->buf[HF_BUF_FAR], *coc = &f->buf[HF_BUF_COC4];
    const float own = *hf_at(coc, 1, x, y);
    const float value = *hf_at(b, c, x, y);
    float v = value;
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            const float part = far_counts(f->s, own, *hf_at(coc, 1, x + i, y + j)), t = *hf_at(b, c, x + i, y + j);
            const float brought = part < 1 ? value + part * (t - value) : t;
            v = brought > v ? brought : v;
        }
    return v + 0;
}

static float far_mean(const struct hf_frame *f, int c, int x, int y)
{
    const struct hf_buf *b = &f->buf[HF_BUF_FAR], *coc = &f->buf[HF_BUF_COC4];
    const float own = *hf_at(coc, 1, x, y);
    float sum[3], n[3];
    for (int j = -1; j <= 1; j++) {
        float t[3], w[3];
        for (int i = -1; i <= 1; i++) {
            const float g = *hf_at(coc, 1, x + i, y + j);
            w[i + 1] = g > 0 ? far_counts(f->s, own, g) : 0;
            t[i + 1] = w[i + 1] > 0 ? w[i + 1] * *hf_at(b, c, x + i, y + j) : 0;
        }
        sum[j + 1] = (t[0] + t[2]) + t[1];
        n[j + 1] = (w[0] + w[2]) + w[1];
    }
    return ((sum[0] + sum[2]) + sum[1]) / ((n[0] + n[2]) + n[1]);
}

static float fill_near(const struct hf_frame *f, int c, int x, int y)
{
    const struct hf_buf *b = &f->buf[HF_BUF_NEAR];
    const float own = *hf_at(b, c, x, y), blur = *hf_at(&f->buf[HF_BUF_BLUR], 0, x, y);
    if (hf_chapter(f->s)->fill == HF_FILL_NONE || !(blur > 0))
        return own;
    return hf_near_part(f->s, own, hf_chapter(f->s)->fill == HF_FILL_MAX ? max_3x3(b, c, x, y) : mean_3x3(b, c, x, y),
                        blur);
}

static float fill_far(const struct hf_frame *f, int c, int x, int y)
{
    if (hf_chapter(f->s)->fill == HF_FILL_NONE || !(*hf_at(&f->buf[HF_BUF_COC4], 1, x, y) > 0))
        return *hf_at(&f->buf[HF_BUF_FAR], c, x, y);
    return hf_chapter(f->s)->fill == HF_FILL_MAX ? far_max(f, c, x, y) : far_mean(f, c, x, y);
}

void hf_chapter_fill_c(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++) {
        float *near[4], *far[4];
        hf_row(&f->buf[HF_BUF_NEAR_FILL], f->s->channels, r.x0, y, near);
        hf_row(&f->buf[HF_BUF_FAR_FILL], f->s->channels, r.x0, y, far);
        for (int c = 0; c < f->s->channels; c++)
            for (int x = r.x0; x < r.x1; x++) {
                if (f->near)
                    near[c][x - r.x0] = fill_near(f, c, x, y);
                if (f->far)
                    far[c][x - r.x0] = fill_far(f, c, x, y);
            }
        // The largest of what a storage holds is what it holds.
        const int rounds = hf_chapter(f->s)->fill == HF_FILL_MEAN ||
                           (hf_chapter(f->s)->fill == HF_FILL_MAX && !hf_chapter(f->s)->faithful);
        if (f->near && rounds)
            hf_store_rgb(f, near, r.x1 - r.x0);
        if (f->far && rounds)
            hf_store_rgb(f, far, r.x1 - r.x0);
    }
}
