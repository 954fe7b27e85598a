// SPDX-License-Identifier: BSD-3-Clause
// Highlights: what of a sample is so much brighter than what lies around it that the edge of its disc would show the
// pixels of a coarser resolution. What they do to it then stays below LEAST of its surroundings, whatever the exposure;
// what is less than PLAIN times as bright as these does not count, or every pattern would be made of highlights.
#include "layers/highlights.h"

#include <math.h>

#include "pixel/pass_c.h"

enum { REACH = 4, PAD = 32 };  // of the mean, half-resolution pixels

#define LEAST 0.001f
#define PLAIN 2

static float root(float v)
{
    return v > 0 ? sqrtf(v) : 0;
}

void hf_layers_roots_c(const float *const above[3], const float *const below[3], int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float v[4];
        for (int i = 0; i < 2; i++) {
            v[i] = root(above[0][2 * x + i] + above[1][2 * x + i] + above[2][2 * x + i]);
            v[2 + i] = root(below[0][2 * x + i] + below[1][2 * x + i] + below[2][2 * x + i]);
        }
        out[x] = ((v[0] + v[2]) + (v[1] + v[3])) * 0.25f;
    }
}

void hf_layers_nine_c(const float *const in[9], int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float sum = in[4][x];
        for (int i = 1; i <= 4; i++)
            sum = sum + (in[4 - i][x] + in[4 + i][x]);
        out[x] = sum * (1.0f / 9);
    }
}

void hf_layers_shares_c(const float *const in[6], const float *limit, int n, float *out)
{
    for (int x = 0; x < n; x++) {
        const float r = in[5][x], m = limit[x / 2], light = in[0][x] + in[1][x] + in[2][x];
        const float cap = (m * m) * (PLAIN + (r * r) * (LEAST * 3.14159265f));
        out[x] = fabsf(r) > HF_LAYERS_FINE && light > cap ? in[4][x] * (1 - cap / light) : 0;
    }
}

size_t hf_layers_highlight_floats(int width, int height)
{
    return ((size_t)width + 2 * PAD) * ((size_t)height + 2 * REACH + 2);
}

void hf_layers_highlights(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_layers_kernels *k = hf_layers_kernels(f);
    const int width = r.x1 - r.x0, height = r.y1 - r.y0, n = hf_min(2 * r.x1, f->s->width) - 2 * r.x0;
    const ptrdiff_t stride = width + 2 * PAD;
    float *mean = f->work + PAD, *down = mean + (height + 2 * REACH) * stride, *across = down + stride;
    for (int y = 0; y < height + 2 * REACH; y++) {
        float *above[4], *below[4];
        const int py = 2 * (r.y0 + y - REACH);
        hf_row(&f->buf[HF_LAYERS_BUF_COLOUR], 3, 2 * (r.x0 - REACH), py, above);
        hf_row(&f->buf[HF_LAYERS_BUF_COLOUR], 3, 2 * (r.x0 - REACH), py + 1, below);
        k->roots((const float *const *)above, (const float *const *)below, width + 2 * REACH,
                 mean + y * stride - REACH);
    }
    for (int y = 0; y < height; y++) {
        const float *in[9];
        for (int i = 0; i < 9; i++)
            in[i] = mean + (y + i) * stride - REACH;
        k->nine(in, width + 2 * REACH, down - REACH);
        for (int i = 0; i < 9; i++)
            in[i] = down + i - REACH;
        k->nine(in, width, across);
        for (int py = 2 * (r.y0 + y); py < hf_min(2 * (r.y0 + y) + 2, f->s->height); py++) {
            float *at[6];
            hf_row(&f->buf[HF_LAYERS_BUF_SEEN], 3, 2 * r.x0, py, at);
            at[4] = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 0, 2 * r.x0, py);
            at[5] = hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 1, 2 * r.x0, py);
            k->shares((const float *const *)at, across, n, hf_at(&f->buf[HF_LAYERS_BUF_SEEN_AT], 2, 2 * r.x0, py));
        }
    }
}
