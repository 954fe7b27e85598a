// SPDX-License-Identifier: BSD-3-Clause
#include "ssim.h"

#include "convolve.h"

#include <stdlib.h>

static const float c1 = 0.01f * 0.01f, c2 = 0.03f * 0.03f;

struct bench_ssim {
    int width, height;
    const float *want;
    struct bench_kernel window;
    float *memory;
    float *mean, *square;  // of want: weighted means of the values and of their squares
    float *got_mean, *got_square, *product;
    float *scratch;
};

struct bench_ssim *bench_ssim_open(const float *want, int width, int height)
{
    const size_t pixels = (size_t)width * (size_t)height;
    struct bench_ssim *s = calloc(1, sizeof *s);
    float *m = malloc(6 * pixels * sizeof *m);
    if (!s || !m) {
        free(s);
        free(m);
        return NULL;
    }
    *s = (struct bench_ssim){width,          height,         want,           bench_gaussian(5, 1.5), m, m, m + pixels,
                             m + 2 * pixels, m + 3 * pixels, m + 4 * pixels, m + 5 * pixels};
    for (size_t i = 0; i < pixels; i++)
        s->square[i] = want[i] * want[i];
    bench_convolve(s->mean, want, s->scratch, width, height, &s->window, &s->window);
    bench_convolve(s->square, s->square, s->scratch, width, height, &s->window, &s->window);
    return s;
}

void bench_ssim_map(struct bench_ssim *s, const float *got, float *map)
{
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    for (size_t i = 0; i < pixels; i++) {
        s->got_square[i] = got[i] * got[i];
        s->product[i] = got[i] * s->want[i];
    }
    const struct bench_kernel *w = &s->window;
    bench_convolve(s->got_mean, got, s->scratch, s->width, s->height, w, w);
    bench_convolve(s->got_square, s->got_square, s->scratch, s->width, s->height, w, w);
    bench_convolve(s->product, s->product, s->scratch, s->width, s->height, w, w);
    for (size_t i = 0; i < pixels; i++) {
        const float a = s->mean[i], b = s->got_mean[i];
        const float aa = s->square[i] - a * a, bb = s->got_square[i] - b * b, ab = s->product[i] - a * b;
        map[i] = (2 * a * b + c1) * (2 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
    }
}

void bench_ssim_close(struct bench_ssim *s)
{
    if (s)
        free(s->memory);
    free(s);
}
