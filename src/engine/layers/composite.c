// SPDX-License-Identifier: BSD-3-Clause
// Slices composited from front to back.
#include <math.h>

#include "engine/layers/kernels.h"

void hf_layers_up_c(const float *a, const float *b, int n, float *out)
{
    for (int x = 0; x < n; x++) {
        const float before = 0.75f * a[x - 1] + 0.25f * b[x - 1], at = 0.75f * a[x] + 0.25f * b[x],
                    after = 0.75f * a[x + 1] + 0.25f * b[x + 1];
        out[2 * x] = 0.25f * before + 0.75f * at;
        out[2 * x + 1] = 0.25f * after + 0.75f * at;
    }
}

void hf_layers_blend_c(const struct hf_stack_row *to, int channels, float *const in[5], enum hf_layers_sums sums, int n)
{
    for (int x = 0; x < n; x++) {
        const float v = in[4][x], open = to->open[x],
                    behind = sums == HF_SUMS_HIDDEN && to->behind[x] > open ? to->behind[x] : open;
        const float least = behind > 1e-30f ? behind : 1e-30f;
        const float hold = sums == HF_SUMS_HELD ? (v < to->held[x] ? v : to->held[x]) : 0;
        const float k = hold > 0 ? (v - hold < open ? v - hold : open) / v : open / (v > least ? v : least);
        const float left = open - k * v;
        for (int c = 0; c < channels; c++) {
            to->colour[c][x] = k * in[c][x] + to->colour[c][x];
            in[c][x] = 0;
        }
        in[4][x] = 0;
        to->weight[x] = k * v + to->weight[x];
        to->open[x] = left > 0 ? left : 0;
        if (sums == HF_SUMS_HELD)
            to->held[x] = to->held[x] - hold;
        if (sums != HF_SUMS_HIDING)
            to->behind[x] = to->behind[x] - v > 0 ? to->behind[x] - v : 0;
    }
}

void hf_layers_light_c(const float *part, const float *in, int n, float *out)
{
    for (int x = 0; x < n; x++)
        out[x] = part[x] * in[x] + out[x];
}

void hf_layers_finish_c(const struct hf_stack_row *near, const float *const far[5], const float *const light[6],
                        const float *const own[4], int channels, float faint, int n, float *const out[4])
{
    for (int x = 0; x < n; x++) {
        const float w = near->weight[x], lit = light ? light[4][x] : 0;
        // The part that neither the middle stack nor light covers. Whether far coverage is enough to fill it is asked of far
        // samples and of the light that they have lost to highlights together.
        const float open = light ? 1 - w - lit : 1 - w, left = open > 0 ? open : 0;
        const float least = light ? faint - light[5][x] : faint, enough = least > 1e-30f ? least : 1e-30f;
        const float a = far ? far[4][x] : 0;
        const float g = far ? left / (a > enough ? a : enough) : 0;
        const float sum = w + g * a, rest = lit < 1 ? 1 - lit : 0, whole = sum > HF_LAYERS_SEEN ? sum : HF_LAYERS_SEEN;
        for (int c = 0; c < channels; c++) {
            const float top = far ? near->colour[c][x] + g * far[c][x] : near->colour[c][x];
            float v = ((whole - sum) * own[c][x] + top) / whole;
            v = light ? rest * v + light[c][x] : v;
            if (c == 3)
                v = fabsf(v - 1) < HF_LAYERS_OPAQUE ? 1 : v;
            out[c][x] = v == own[c][x] ? own[c][x] : v;
        }
    }
}
