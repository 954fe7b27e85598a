// SPDX-License-Identifier: BSD-3-Clause
// Hidden samples: what lies behind a silhouette, where a lens that is larger than a point sees past it. They come from
// the farthest of what is around, at distances that double from level to level.
#include "layers/hidden.h"

#include <math.h>

#include "pixel/pass_c.h"

static float root(float v)
{
    return v > 0 ? sqrtf(v) : 0;
}

// What a pixel is to others: the surface behind its edge, if it is mixed.
struct source {
    float weight, radius, colour[4];
};

static struct source source_of(const struct hf_frame *f, int channels, int x, int y)
{
    const int mixed = *hf_at(&f->buf[HF_LAYERS_BUF_MIXED_AT], 0, x, y) > 0;
    const struct hf_buf *at = &f->buf[mixed ? HF_LAYERS_BUF_MIXED_AT : HF_LAYERS_BUF_SEEN_AT];
    const struct hf_buf *colour = &f->buf[mixed ? HF_LAYERS_BUF_MIXED : HF_LAYERS_BUF_SEEN];
    struct source s = {.weight = *hf_at(at, 0, x, y), .radius = *hf_at(at, 1, x, y)};
    for (int c = 0; c < channels; c++)
        s.colour[c] = root(*hf_at(colour, c, x, y));
    return s;
}

static void quad(const struct hf_frame *f, int channels, int x, int y)
{
    struct source s[4];
    float farthest = HF_LAYERS_NOTHING, sum = 0, r = 0, colour[4] = {0};
    for (int i = 0; i < 4; i++) {
        s[i] = source_of(f, channels, hf_min(2 * x + (i & 1), f->s->width - 1),
                         hf_min(2 * y + (i >> 1), f->s->height - 1));
        farthest = s[i].weight > 0 && s[i].radius > farthest ? s[i].radius : farthest;
    }
    for (int i = 0; i < 4; i++) {
        const float near = 1 - (farthest - s[i].radius) * 0.5f;
        const float g = s[i].weight * (near > 0 ? near : 0);
        sum += g;
        r += g * s[i].radius;
        for (int c = 0; c < channels; c++)
            colour[c] += g * s[i].colour[c];
    }
    const float inverse = sum > 0 ? 1 / sum : 0;
    *hf_at(&f->buf[HF_LAYERS_BUF_QUADS_AT], 0, x, y) = sum * 0.25f;
    *hf_at(&f->buf[HF_LAYERS_BUF_QUADS_AT], 1, x, y) = sum > 0 ? r * inverse : HF_LAYERS_NOTHING;
    for (int c = 0; c < channels; c++)
        *hf_at(&f->buf[HF_LAYERS_BUF_QUADS], c, x, y) = colour[c] * inverse;
}

void hf_layers_quads(const struct hf_frame *f, struct hf_rect r)
{
    for (int y = r.y0; y < r.y1; y++)
        for (int x = r.x0; x < r.x1; x++)
            quad(f, hf_layers(f->s)->channels, x, y);
}

void hf_layers_merge_c(const float *const in[3][6], int channels, float slope, int n, float *const out[6])
{
    for (int x = 0; x < n; x++) {
        const float a = in[0][5][x], b = in[1][5][x], c = in[2][5][x];
        const float ab = a > b ? a : b, farthest = ab > c ? ab : c;
        float g[3], sum = 0;
        for (int i = 0; i < 3; i++) {
            const float near = 1 - (farthest - in[i][5][x]) * slope;
            g[i] = in[i][4][x] * (near > 0 ? near : 0);
        }
        sum = g[0] + g[1] + g[2];
        const float inverse = sum > 0 ? 1 / sum : 0;
        for (int k = 0; k < channels; k++)
            out[k][x] = (g[0] * in[0][k][x] + g[1] * in[1][k][x] + g[2] * in[2][k][x]) * inverse;
        const float r = (g[0] * a + g[1] * b + g[2] * c) * inverse;
        out[4][x] = sum * (1.0f / 3);
        out[5][x] = sum > 0 ? r : HF_LAYERS_NOTHING;
    }
}

void hf_layers_tap_c(const float *const in[6], int channels, const float *nearest, float scale, float off, float part,
                     int n, float *const sum[6])
{
    for (int x = 0; x < n; x++) {
        const float behind = in[5][x] - nearest[x];
        const float a = hf_layers_unit(behind * scale + off);
        const float w = behind < 1 ? 0 : part * a * in[4][x];
        for (int c = 0; c < channels; c++)
            sum[c][x] = sum[c][x] + w * in[c][x];
        sum[4][x] = sum[4][x] + w;
        sum[5][x] = w > 0 ? sum[5][x] + w * in[5][x] : sum[5][x];
    }
}

int hf_layers_extremes_c(const float *radius, const float *weight, const float *share, ptrdiff_t stride, int n,
                         int rows, struct hf_layers_range *out)
{
    struct hf_layers_range range = *out;
    int bright = 0;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < n; x++) {
            const ptrdiff_t at = y * stride + x;
            const float r = radius[at];
            range.low = weight[at] > 0 && r < range.low ? r : range.low;
            range.high = weight[at] > 0 && r > range.high ? r : range.high;
            bright |= share && share[at] > 0;
        }
    *out = range;
    return bright;
}
