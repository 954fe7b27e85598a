// SPDX-License-Identifier: BSD-3-Clause
// A slice's sources and its disc.
#include "layers/kernels.h"

void hf_layers_weigh_c(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                       int rows, int channels, int n, int add, float *const out[5])
{
    for (int x = 0; x < n; x++) {
        float sum[5] = {0};
        for (int y = 0; y < rows; y++) {
            const ptrdiff_t at = y * stride + x;
            const float r = in[5][at], r2 = r * r;
            const float before = (r2 - s->before_square) * s->before_scale,
                        after = 1 - (r2 - s->square) * s->after_scale;
            const float part = r < s->radius ? before : after;
            const float shown = (r > s->before && r < s->after ? part : 0) * s->scale;
            const float w = shown * in[4][at], v = share ? shown * (in[4][at] - share[at]) : w;
            for (int c = 0; c < channels; c++)
                sum[c] = sum[c] + v * in[c][at];
            sum[4] = sum[4] + w;
        }
        for (int c = 0; c < 5; c++)
            if (c < channels || c == 4)
                out[c][x] = add ? out[c][x] + sum[c] : sum[c];
    }
}

void hf_layers_fold_c(const float *in, int n, float *out)
{
    for (int x = 0; x < n; x++)
        out[x] = in[2 * x] + in[2 * x + 1];
}

void hf_layers_disc_c(const struct hf_slice *s, const float *in, int n, int from, int to, float *out, ptrdiff_t stride)
{
    for (int x = 0; x < n; x++) {
        float sum = 0;
        int have = -1;
        for (int d = s->rows - 1; d >= 0; d--) {
            const struct hf_disc_row row = s->row[d];
            while (have < row.n) {
                have++;
                sum = sum + (have ? in[x - have] + in[x + have] : in[x]);
            }
            const float v = row.f * (in[x - have - 1] + in[x + have + 1]) + sum;
            if (-d >= from && -d < to)
                out[-d * stride + x] += v;
            if (d && d >= from && d < to)
                out[d * stride + x] += v;
        }
    }
}
