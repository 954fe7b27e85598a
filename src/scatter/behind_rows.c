// SPDX-License-Identifier: BSD-3-Clause
// Scatter: rows of what lies behind near pixels. Which rows, and why: behind.c.
#include "pixel/pass_c.h"
#include "scatter/behind.h"
#include "scatter/kernels.h"

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

int hf_seen_weights_c(const struct hf_scatter *t, const float *radius, const float *widest, int first, int n,
                      float *const out[2])
{
    int some = 0;
    for (int x = first; x < n; x++) {
        // What is near itself is seen behind what is nearer, by twice its radius: not a slope behind itself.
        const float r = radius[x], nearer = hf_saturate(0.5f * widest[x >> 1] + r), hardly = hf_saturate(1.5f + r);
        const float own = r > 0 ? hf_own_part(t, r) : nearer > hardly ? nearer : hardly;
        out[0][x] = 0.25f * own;
        out[1][x] = r > 0 ? 0.25f * (1 - own) : 0;
        some |= (out[0][x] > 0) | (out[1][x] > 0) << 1;
    }
    return some;
}

void hf_seen_row_c(const float *v, const float *weight, float scale, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] += v[2 * i] * (weight[2 * i] * scale) + v[2 * i + 1] * (weight[2 * i + 1] * scale);
}

void hf_third_row_c(const float *a, const float *b, const float *c, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = (1 / 3.0f) * ((a[i] + b[i]) + c[i]);
}

void hf_part_row_c(const float *near, float share, float size, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] = share * hf_saturate(2 - size / hf_behind_span(near[i]));
}

void hf_add_part_c(const float *in, const float *part, int n, float *out)
{
    for (int i = 0; i < n; i++)
        out[i] += part[i] * in[i];
}

void hf_up_row_c(const float *own, const float *over, int n, float *out)
{
    for (int x = 0; x < 2 * n; x++) {
        const int i = x >> 1, j = x & 1 ? i + 1 : i - 1;
        out[x] = 0.75f * (0.75f * own[i] + 0.25f * over[i]) + 0.25f * (0.75f * own[j] + 0.25f * over[j]);
    }
}

static float mix(float a, float b, float t)
{
    return t < 1 ? hf_lerp(a, b, t) : b;
}

void hf_behind_blend_c(const struct hf_scatter_row *row, const float *const weight[2], const float *const colour[2],
                       const float *own, float *out)
{
    for (int i = 0; i < row->n; i++) {
        const float far_weight = row->far ? row->far_weight[i] : 0, near_weight = row->near ? row->near_weight[i] : 0;
        const float mine = own[i] * hf_scatter(row->setup)->dim;
        const float front = near_weight > 0 ? row->near[i] / near_weight : mine;
        const float far = far_weight > 0 ? row->far[i] / far_weight : mine;
        const float reached = hf_saturate(16 * far_weight), sharp = weight[0][i], blurred = weight[1][i];
        float v = mix(front, far, reached);
        if (sharp + blurred > 0) {
            float seen = v;
            if (blurred > 0)
                seen = mix(colour[1][i] / blurred, far, reached);
            if (sharp > 0)
                seen = mix(seen, colour[0][i] / sharp, sharp / (sharp + blurred));
            v = mix(seen, v, HF_BEHIND_NOTHING / ((sharp + blurred) + HF_BEHIND_NOTHING));
        }
        out[i] = v;
    }
}
