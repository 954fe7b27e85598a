// SPDX-License-Identifier: BSD-3-Clause
// How far a picture is from the one that it should be. Pictures are linear RGB, packed.
#ifndef HF_BENCH_METRICS_H
#define HF_BENCH_METRICS_H

#include <stddef.h>
#include <stdint.h>

// Where a distance is taken. A pixel may be in several.
enum bench_region {
    BENCH_WHOLE,
    BENCH_SILHOUETTES,  // within the reach of an edge in the depth
    BENCH_NEAR,         // in front of the focus by over a pixel of radius, and no silhouette
    BENCH_FAR,          // behind it
    BENCH_FOCUS,        // neither
    BENCH_HIGHLIGHTS,   // within the reach of a pixel brighter than the display
    BENCH_REGIONS
};

// "whole", "silhouettes", ...
const char *bench_region_name(enum bench_region region);

// Bit r of out[] says that the pixel lies in region r. radius: signed CoC radius of every pixel, near negative.
void bench_regions(uint8_t *out, const float *rgb, const float *radius, int width, int height);

struct bench_distance {
    double share;         // of the picture's pixels; 0: the region is empty, and nothing else says anything
    double psnr;          // dB, of the display-encoded picture: clamped to 0..1, sRGB; INFINITY for the same picture
    double display_rmse;  // 10^(-psnr / 20)
    double linear_rmse;
    double largest;  // linear, of one sample
    double ssim;     // of display-encoded luminance, mean
    double flip;     // mean
    double energy;   // sum of all samples over that of the picture compared with
};

struct bench_metrics;

// Makes what depends on the picture compared with; want and regions must stay. NULL without memory.
struct bench_metrics *bench_metrics_open(const float *want, const uint8_t *regions, int width, int height);
void bench_metrics_compare(struct bench_metrics *m, const float *got, struct bench_distance out[BENCH_REGIONS]);
void bench_metrics_close(struct bench_metrics *m);

// 0..1, sRGB's curve.
float bench_display(float linear);
// Root mean square of the second difference of three display-encoded pictures in a row: what does not change steadily.
double bench_flicker(const float *before, const float *now, const float *after, size_t samples);

#endif
