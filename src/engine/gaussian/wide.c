// SPDX-License-Identifier: BSD-3-Clause
// A gaussian blur whose cost does not depend on its size: four boxes with fractional ends, so that the variance is
// exact (Gwosdek, Grewenig, Bruhn and Weickert, "Theoretical foundations of gaussian convolution by extended box
// filtering", 2011).
//
// The sum of a box of 2l + 1 samples is a suffix of one block and a prefix of the next, with blocks of that length:
// three additions for any length, and no subtraction. So nothing drifts, and a highlight leaves no trace when it leaves
// the window. Sums are in double. They are exact while the samples in the window lie within a factor of 2^(29 - log2(2l
// + 1)) of each other; then shifts, crops and flips of a picture give the same bits. Beyond that, the last bit of one
// in many millions of samples may differ. Each box's result is a float.
#include <math.h>

#include "pixel/pass_c.h"
#include "engine/gaussian/kernels.h"

struct hf_wide hf_wide_of(double variance)
{
    const double v = variance / HF_WIDE_BOXES;
    const int l = (int)(sqrt(12 * v + 1) / 2 - 0.5);
    const double alpha = (2 * l + 1) * (l * (l + 1.0) - 3 * v) / (6 * (v - (l + 1.0) * (l + 1.0)));
    return (struct hf_wide){l, alpha, 1 / (2 * l + 1 + 2 * alpha)};
}

// suffix[i]: the sum from sample i to the end of its block.
static void box_c(const float *in, float *out, int n, const struct hf_wide *w, double *suffix)
{
    const int l = w->l, width = 2 * l + 1;
    const double first = in[0], last = in[(n - 1) * HF_WIDE_LANES];
    for (int i = n - 1; i >= 0; i--) {
        const double v = in[i * HF_WIDE_LANES];
        suffix[i] = i == n - 1 || (i + 1) % width == 0 ? v : v + suffix[i + 1];
    }
    double prefix = 0;  // of the block in which the window ends
    int end = -1;
    for (int i = 0; i < n; i++) {
        const int a = i - l, b = hf_min(i + l, n - 1), block = a > 0 ? (a + width - 1) / width * width : 0;
        for (; end < b; end++)
            prefix = (end + 1) % width == 0 ? in[(end + 1) * HF_WIDE_LANES] : prefix + in[(end + 1) * HF_WIDE_LANES];
        // The window contains one whole block or none.
        double sum = a <= 0 ? prefix : block == a ? suffix[a] : block <= b ? suffix[a] + prefix : suffix[a];
        if (a < 0)
            sum = -a * first + sum;
        if (i + l >= n)
            sum = sum + (i + l - n + 1) * last;
        const double before = in[hf_max(a - 1, 0) * HF_WIDE_LANES];
        const double after = in[hf_min(i + l + 1, n - 1) * HF_WIDE_LANES];
        out[i * HF_WIDE_LANES] = (float)((sum + w->alpha * (before + after)) * w->scale);
    }
}

void hf_wide_block_c(float *block, int n, const struct hf_wide *w, float *work)
{
    float *other = work + HF_WIDE_LANES * (size_t)n;
    for (int x = 0; x < HF_WIDE_LANES; x++)
        for (int i = 0; i < HF_WIDE_BOXES; i++)
            box_c((i % 2 ? other : block) + x, (i % 2 ? block : other) + x, n, w, (double *)(void *)work);
}

// The boxes along an axis, in working pixels. Their variance is that of sigma less m^2 / 4 pixels for m = 2 and 4,
// which averaging m x m pixels and interpolating them again adds.
static struct hf_wide wide_along(const struct hf_setup *s, double sigma)
{
    const double m = 1 << hf_gaussian(s)->resolution, resampling = hf_gaussian(s)->resolution ? m * m / 4 : 0;
    return hf_wide_of(fmax(sigma * sigma - resampling, 0) / (m * m));
}

// Blur whole columns.
void hf_wide_columns_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_wide wide = wide_along(f->s, hf_gaussian(f->s)->sigma);
    const struct hf_rect w = hf_gaussian_working(f->s, r);
    const struct hf_buf *b = hf_gaussian_buf(f, HF_GAUSSIAN_ROWS);
    const int n = w.y1;
    float *block = f->work, *work = block + HF_WIDE_LANES * (size_t)n;
    for (int c = 0; c < f->s->channels; c++)
        for (int x = w.x0; x < w.x1 && !hf_stopped(f->s->stop); x += HF_WIDE_LANES) {
            const size_t bytes = sizeof(float) * (size_t)hf_min(HF_WIDE_LANES, w.x1 - x);
            memset(block, 0, sizeof(float) * HF_WIDE_LANES * (size_t)n);
            for (int y = 0; y < n; y++)
                memcpy(block + HF_WIDE_LANES * (size_t)y, hf_at(b, c, x, y), bytes);
            hf_gaussian_kernels(f)->wide_block(block, n, &wide, work);
            for (int y = 0; y < n; y++)
                memcpy(hf_at(b, c, x, y), block + HF_WIDE_LANES * (size_t)y, bytes);
        }
}

// Blur whole rows, turned into columns.
void hf_wide_rows_pass(const struct hf_frame *f, struct hf_rect r)
{
    const struct hf_wide wide = wide_along(f->s, hf_gaussian(f->s)->sigma / f->s->pixel_aspect);
    const struct hf_rect w = hf_gaussian_working(f->s, r);
    const struct hf_buf *b = hf_gaussian_buf(f, HF_GAUSSIAN_ROWS);
    const int n = w.x1;
    float *block = f->work, *work = block + HF_WIDE_LANES * (size_t)n;
    for (int c = 0; c < f->s->channels; c++)
        for (int y = w.y0; y < w.y1 && !hf_stopped(f->s->stop); y += HF_WIDE_LANES) {
            const int rows = hf_min(HF_WIDE_LANES, w.y1 - y);
            for (int x = 0; x < n; x++)
                for (int i = 0; i < HF_WIDE_LANES; i++)
                    block[x * HF_WIDE_LANES + i] = i < rows ? *hf_at(b, c, x, y + i) : 0;
            hf_gaussian_kernels(f)->wide_block(block, n, &wide, work);
            for (int i = 0; i < rows; i++) {
                float *row = hf_at(b, c, 0, y + i);
                for (int x = 0; x < n; x++)
                    row[x] = block[x * HF_WIDE_LANES + i];
            }
        }
}
