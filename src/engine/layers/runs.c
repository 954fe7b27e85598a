// SPDX-License-Identifier: BSD-3-Clause
// Rows of shapes. A run is a sum of windows of 1, 2, 4, ... pixels. No sums are subtracted, so nothing drifts, and
// sources of 0 leave exactly 0.
#include "engine/layers/kernels.h"

void hf_layers_pairs_c(const float *in, int apart, int n, float *out)
{
    for (int x = 0; x < n; x++)
        out[x] = in[x] + in[x + apart];
}

void hf_layers_runs_c(const struct hf_shape_run *run, int count, const float *window, ptrdiff_t plane,
                      const float *part, int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float sum = 0;
        for (int i = 0; i < count; i++) {
            const struct hf_shape_run *r = &run[i];
            const float *in = window + x + r->start;
            float v = r->before * in[-1];
            v = r->after * in[r->length] + v;
            for (int left = r->length, k = 0; left; left >>= 1, k++)
                if (left & 1) {
                    v = v + in[k * plane];
                    in += 1 << k;
                }
            sum = r->weight * v + sum;
        }
        out[x] = part ? part[x] * sum + out[x] : out[x] + sum;
    }
}

void hf_layers_weights_c(const float *weight, int count, const float *in, int n, float *out)
{
    for (int x = 0; x < n; x++) {
        float sum = 0;
        for (int i = 0; i < count; i++)
            sum = weight[i] * in[x - i] + sum;
        out[x] = out[x] + sum;
    }
}

void hf_layers_stamp_c(const float *weight, int n, float v, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = v * weight[i] + out[i];
}
