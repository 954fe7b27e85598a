// SPDX-License-Identifier: BSD-3-Clause
// A separable filter over a plane, for the metrics.
#ifndef HF_BENCH_CONVOLVE_H
#define HF_BENCH_CONVOLVE_H

enum { BENCH_MOST_RADIUS = 64 };

// Weights at -radius .. radius.
struct bench_kernel {
    int radius;
    float weight[2 * BENCH_MOST_RADIUS + 1];
};

// exp(-x^2 / (2 sigma^2)), its sum 1.
struct bench_kernel bench_gaussian(int radius, double sigma);

// out = the plane filtered along x with kx and along y with ky, clamped at the edges. Planes are packed tightly; scratch
// has the plane's size and is neither in nor out, which may be the same.
void bench_convolve(float *out, const float *in, float *scratch, int width, int height, const struct bench_kernel *kx,
                    const struct bench_kernel *ky);

#endif
