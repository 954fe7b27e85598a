// SPDX-License-Identifier: BSD-3-Clause
#include "pixel/convolve.h"

// A run of columns, of areas, is summed from the middle outwards.
static float run_sum(const float *p, int reach, int step)
{
    float sum = *p;
    for (int j = 1; j <= reach; j++)
        sum += p[-j * step] + p[j * step];
    return sum;
}

// One output row. With mirrored weights, pairs of columns are added first. Each row of weights is summed, and the rows are
// added from top to bottom.
static void convolve_row(const struct hf_taps *t, const float *in, ptrdiff_t stride, float *out, int n, float *sum)
{
    const int step = t->step;
    for (int x = 0; x < n; x++)
        out[x] = 0;
    for (int dy = -t->ny; dy <= t->ny; dy++) {
        const float *p = in + dy * step * stride;
        const int k = !t->symmetric ? dy + t->ny : dy < 0 ? -dy : dy;
        for (int x = 0; x < n; x++)
            sum[x] = 0;
        for (int i = t->first[k]; i < t->first[k + 1]; i++) {
            const float w = t->weight[i];
            const int j = t->column[i];
            if (!t->symmetric)
                for (int x = 0; x < n; x++)
                    sum[x] += w * p[x + (j - t->nx) * step];
            else if (j > t->nx)
                for (int x = 0; x < n; x++)
                    sum[x] += w * run_sum(p + x, j - t->nx - 1, step);
            else if (j == 0)
                for (int x = 0; x < n; x++)
                    sum[x] += w * p[x];
            else
                for (int x = 0; x < n; x++)
                    sum[x] += w * (p[x - j * step] + p[x + j * step]);
        }
        for (int x = 0; x < n; x++)
            out[x] += sum[x];
    }
    for (int x = 0; x < n; x++)
        out[x] *= t->scale;
}

void hf_convolve_c(const struct hf_frame *f, struct hf_rect r, const struct hf_taps *t, const struct hf_buf *in,
                   int c_in, const struct hf_buf *out, int c_out)
{
    for (int y = r.y0; y < r.y1 && !hf_stopped(f->s->stop); y++)
        convolve_row(t, hf_at(in, c_in, r.x0, y), in->stride, hf_at(out, c_out, r.x0, y), r.x1 - r.x0, hf_line(f, 0));
}
