// SPDX-License-Identifier: BSD-3-Clause
#include "convolve.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { SPAN = 1024 };  // pixels of a row that are filtered together

struct bench_kernel bench_gaussian(int radius, double sigma)
{
    struct bench_kernel k = {.radius = radius};
    double sum = 0;
    for (int i = -radius; i <= radius; i++)
        sum += exp(-i * i / (2 * sigma * sigma));
    for (int i = -radius; i <= radius; i++)
        k.weight[i + radius] = (float)(exp(-i * i / (2 * sigma * sigma)) / sum);
    return k;
}

static int clamp(int i, int n)
{
    return i < 0 ? 0 : i < n ? i : n - 1;
}

static void add_scaled(float *restrict out, const float *restrict in, float weight, int n)
{
    for (int i = 0; i < n; i++)
        out[i] += weight * in[i];
}

static void filter_row(float *out, const float *in, int width, const struct bench_kernel *k)
{
    float padded[SPAN + 2 * BENCH_MOST_RADIUS], sum[SPAN];
    for (int x0 = 0; x0 < width; x0 += SPAN) {
        const int n = width - x0 < SPAN ? width - x0 : SPAN;
        for (int i = 0; i < n + 2 * k->radius; i++)
            padded[i] = in[clamp(x0 + i - k->radius, width)];
        memset(sum, 0, sizeof sum);
        for (int i = 0; i <= 2 * k->radius; i++)
            add_scaled(sum, padded + i, k->weight[i], n);
        memcpy(out + x0, sum, (size_t)n * sizeof *sum);
    }
}

void bench_convolve(float *out, const float *in, float *scratch, int width, int height, const struct bench_kernel *kx,
                    const struct bench_kernel *ky)
{
    const size_t stride = (size_t)width;
    for (int y = 0; y < height; y++)
        filter_row(scratch + (size_t)y * stride, in + (size_t)y * stride, width, kx);
    for (int y = 0; y < height; y++) {
        float *row = out + (size_t)y * stride;
        memset(row, 0, stride * sizeof *row);
        for (int i = -ky->radius; i <= ky->radius; i++)
            add_scaled(row, scratch + (size_t)clamp(y + i, height) * stride, ky->weight[i + ky->radius], width);
    }
}
