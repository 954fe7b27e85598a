// SPDX-License-Identifier: BSD-3-Clause
// Structural similarity of two planes.
//
// Z. Wang, A. Bovik, H. Sheikh, E. Simoncelli, "Image quality assessment: from error visibility to structural
// similarity", IEEE Transactions on Image Processing, 2004: window 11 x 11 of a gaussian of sigma 1.5, K1 = 0.01,
// K2 = 0.03, range 1. Clamped at the edges, so that every pixel has a value.
#ifndef HF_BENCH_SSIM_H
#define HF_BENCH_SSIM_H

struct bench_ssim;

// Prepare the reference plane, values 0..1, which must stay valid. NULL without memory.
struct bench_ssim *bench_ssim_open(const float *want, int width, int height);
// map: -1..1 for each pixel, 1 where both are alike.
void bench_ssim_map(struct bench_ssim *s, const float *got, float *map);
void bench_ssim_close(struct bench_ssim *s);

#endif
