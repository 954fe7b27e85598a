// SPDX-License-Identifier: BSD-3-Clause
// FLIP: the difference that a person sees when flipping between two pictures, 0 (none) to 1, for each pixel.
//
// P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. Fairchild, "FLIP: A Difference Evaluator for
// Alternating Images", High Performance Graphics 2020. Colours are filtered by the eye's contrast sensitivity, compared
// in Lab after the Hunt effect; edges and points are compared apart and raise the difference.
#ifndef HF_BENCH_FLIP_H
#define HF_BENCH_FLIP_H

// Pixels per degree for the paper's viewer: 0.7 m from a screen 0.7 m and 3840 pixels wide.
#define BENCH_FLIP_PPD 67.0206432766

struct bench_flip;

// Prepare the reference picture. want: linear RGB, packed, clamped to 0..1. Returns NULL without memory, or if ppd is
// so high that a filter would be wider than 129 pixels.
struct bench_flip *bench_flip_open(const float *want, int width, int height, double ppd);
void bench_flip_map(struct bench_flip *f, const float *got, float *map);
void bench_flip_close(struct bench_flip *f);

// The colour part's largest distance, between green and blue, by which the paper scales.
double bench_flip_largest(void);

#endif
