// SPDX-License-Identifier: BSD-3-Clause
// Row kernels of the disocclusion fill; behind.c says which rows, and why.
#include "pixel/behind.h"
#include "pixel/kernels.h"

void hf_near_row_c(const float *radius, int n, float *out)
{
    for (int i = 0; i < n; i++) {
        const float least = radius[2 * i] < radius[2 * i + 1] ? radius[2 * i] : radius[2 * i + 1];
        out[i] = 0 - least > out[i] ? 0 - least : out[i];
    }
}

void hf_most_row_c(const float *a, const float *b, const float *c, int n, float *out)
{
    for (int i = 0; i < n; i++) {
        const float m = a[i] > b[i] ? a[i] : b[i];
        out[i] = m > c[i] ? m : c[i];
    }
}

void hf_seen_row_c(const float *v, const float *weight, float scale, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] += v[2 * i] * (weight[2 * i] * scale) + v[2 * i + 1] * (weight[2 * i + 1] * scale);
}

static void third_row(const float *a, const float *b, const float *c, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = (1 / 3.0f) * ((a[i] + b[i]) + c[i]);
}

static void part_row(const float *near, float share, float size, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = share * hf_saturate(2 - size / hf_behind_span(near[i]));
}

void hf_add_part_c(const float *in, const float *part, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] += part[i] * in[i];
}

static void up_row(const float *own, const float *over, int n, float *out)
{
    for (int x = 0; x < 2 * n; x++) {
        const int i = x >> 1, j = x & 1 ? i + 1 : i - 1;
        out[x] = 0.75f * (0.75f * own[i] + 0.25f * over[i]) + 0.25f * (0.75f * own[j] + 0.25f * over[j]);
    }
}

void hf_behind_rows_c(struct hf_pixel_kernels *k)
{
    k->behind = (struct hf_behind_kernels){.near_row = hf_near_row_c,
                                           .most_row = hf_most_row_c,
                                           .seen_row = hf_seen_row_c,
                                           .third_row = third_row,
                                           .part_row = part_row,
                                           .add_part = hf_add_part_c,
                                           .up_row = up_row};
}
