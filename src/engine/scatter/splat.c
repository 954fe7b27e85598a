// SPDX-License-Identifier: BSD-3-Clause
// Scatter: add sprites to the sums, and turn sums into values. walk.c decides which sprites go where.
//
// Sums are 64-bit integers, so no order of additions changes a bit and nothing drifts. A sprite has one span in each
// row. Adding it means adding its share where the span begins and subtracting it where the span ends: two pixels each,
// because ends lie between pixels. One running sum along each row then turns these differences into the picture.
#include <string.h>

#include "engine/scatter/kernels.h"

// Add one end of a span: j units of u at the first pixel and 256 - j at the next.
static void add_end(int64_t *row, int x, int width, const uint64_t u[4], uint64_t first, uint64_t second)
{
    int64_t *p = row + 4 * (ptrdiff_t)hf_max(hf_min(x, width), 0);
    int64_t *q = row + 4 * (ptrdiff_t)hf_max(hf_min(x + 1, width), 0);
    for (int c = 0; c < 4; c++)
        p[c] = (int64_t)((uint64_t)p[c] + u[c] * first);
    for (int c = 0; c < 4; c++)
        q[c] = (int64_t)((uint64_t)q[c] + u[c] * second);
}

static void draw_half(const struct hf_sums *s, int x, int y, const uint64_t u[4], int32_t half)
{
    if (y < s->y0 || y >= s->y1)
        return;
    int64_t *row = s->lane + s->row[y - s->y0];
    const int n = half >> 8, width = s->x1 - s->x0;
    const uint64_t j = (uint64_t)half & 255;
    add_end(row, x - n, width, u, j, 256 - j);
    add_end(row, x + n, width, u, -(256 - j), -j);
}

void hf_splat_runs_c(const struct hf_sums *s, int x, int y, const struct hf_run *run, int rows, const int64_t share[4])
{
    for (int i = hf_max(s->y0 - y, 0); i < hf_min(s->y1 - y, rows); i++) {
        int64_t *row = s->lane + s->row[y + i - s->y0];
        const int width = s->x1 - s->x0, a = x - s->x0 + (run[i].a >> 8), b = x - s->x0 + (run[i].b >> 8);
        const uint64_t fa = (uint64_t)run[i].a & 255, fb = (uint64_t)run[i].b & 255, weight = (uint64_t)run[i].weight;
        uint64_t u[4];
        for (int c = 0; c < 4; c++)
            u[c] = (uint64_t)share[c] * weight;
        add_end(row, a, width, u, 256 - fa, fa);
        add_end(row, b, width, u, -(256 - fb), -fb);
    }
}

void hf_splat_taps_c(const struct hf_sums *s, int x, int y, const int16_t *tap, int columns, int rows,
                     const int64_t share[4])
{
    for (int j = hf_max(s->y0 - y, 0); j < hf_min(s->y1 - y, rows); j++) {
        int64_t *row = s->lane + s->row[y + j - s->y0];
        for (int i = 0; i < columns; i++) {
            int64_t *p = row + 4 * (ptrdiff_t)hf_max(hf_min(x + i - s->x0, s->x1 - s->x0), 0);
            const uint64_t weight = (uint64_t)(int64_t)tap[(ptrdiff_t)j * columns + i];
            for (int c = 0; c < 4; c++)
                p[c] = (int64_t)((uint64_t)p[c] + (uint64_t)share[c] * weight);
        }
    }
}

void hf_splat_c(const struct hf_sums *s, const struct hf_aperture *a, const struct hf_splats *list)
{
    for (int i = 0; i < list->count; i++) {
        const struct hf_picture *p = &a->picture[list->picture[i]];
        const int x = list->x[i] - s->x0, y = list->y[i];
        for (int dy = 0; dy < p->rows; dy++) {
            const uint64_t weight = (uint64_t)(dy == p->rows - 1 ? p->cap : HF_WHOLE_ROW);
            uint64_t u[4];
            for (int c = 0; c < 4; c++)
                u[c] = (uint64_t)list->share[i][c] * weight;
            draw_half(s, x, y + dy, u, a->half[p->first + dy]);
            if (dy)
                draw_half(s, x, y - dy, u, a->half[p->first + dy]);
        }
    }
}

void hf_settle_c(int64_t *const lane[HF_BINS], int bins, int n, int channels, const double (*unscale)[4],
                 float *const out[4])
{
    uint64_t sum[HF_BINS][4] = {{0}};
    for (int x = -HF_SUMS_MARGIN; x < n; x++)
        for (int c = 0; c < 4; c++) {
            double all = 0;
            for (int b = bins - 1; b >= 0; b--) {
                sum[b][c] += (uint64_t)lane[b][4 * x + c];
                all += (double)(int64_t)sum[b][c] * unscale[b][c];
            }
            if (x >= 0 && (c < channels || c == 3))
                out[c][x] = (float)all;
        }
    for (int b = 0; b < bins; b++)
        memset(lane[b] - 4 * HF_SUMS_MARGIN, 0, sizeof *lane[b] * 4 * (size_t)(n + 2 * HF_SUMS_MARGIN));
}
