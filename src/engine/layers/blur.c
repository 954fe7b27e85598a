// SPDX-License-Identifier: BSD-3-Clause
// The sources of a slice, and its disc.
#include "engine/layers/kernels.h"

void hf_layers_weigh_c(const struct hf_slice *s, const float *const in[6], const float *share, ptrdiff_t stride,
                       int rows, int channels, int n, int add, float *const out[5], uint8_t *any)
{
    for (int x = 0; x < n; x++) {
        float sum[5] = {0};
        for (int y = 0; y < rows; y++) {
            const ptrdiff_t at = y * stride + x;
            const float r = in[5][at], r2 = r * r, weight = in[4] ? in[4][at] : 1;
            const float before = (r2 - s->before_square) * s->before_scale,
                        after = 1 - (r2 - s->square) * s->after_scale;
            const float part = r < s->radius ? before : after;
            // A sample without weight has no defined radius and colour.
            if (!(weight > 0 && r > s->before && r < s->after))
                continue;
            const float shown = part * s->scale, w = shown * (share ? weight - share[at] : weight);
            for (int c = 0; c < channels; c++)
                sum[c] = sum[c] + w * in[c][at];
            sum[4] = sum[4] + w;
        }
        any[x / 16] |= sum[4] > 0;
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

// The sources `away` pixels from x on either side; at x there is one.
static float pair_of(const float *in, int x, int away)
{
    return away ? in[x - away] + in[x + away] : in[x];
}

// A row of sources' part of one row of the disc. sum holds the samples up to `have` pixels from x; it grows as needed.
static float disc_row(const float *in, int x, struct hf_disc_row row, int *have, float *sum)
{
    for (; *have < row.n; ++*have)
        *sum = *sum + pair_of(in, x, *have + 1);
    return row.f * pair_of(in, x, *have + 1) + *sum;
}

static void disc_plane(const struct hf_slice *s, const float *upper, const float *lower, int n, int from, int to,
                       float *out, ptrdiff_t stride)
{
    for (int x = 0; x < n; x++) {
        float sum[2] = {0}, last[2] = {0};
        int have[2] = {-1, -1};
        for (int d = s->rows - 1; d >= hf_layers_least_row(from, to); d--) {
            const float u = disc_row(upper, x, s->row[d], &have[0], &sum[0]);
            const float l = disc_row(lower, x, s->row[d], &have[1], &sum[1]);
            if (-d >= from && -d < to)
                out[-d * stride + x] += u + last[1];
            if (d + 1 >= from && d + 1 < to)
                out[(d + 1) * stride + x] += l + last[0];
            last[0] = u;
            last[1] = l;
        }
    }
}

void hf_layers_disc_c(const struct hf_slice *s, const struct hf_layers_sources *in)
{
    for (int i = 0; i < in->planes; i++)
        disc_plane(s, in->upper + i * in->plane, in->lower + i * in->plane, in->n, in->from, in->to,
                   in->out + i * in->out_plane, in->stride);
}
