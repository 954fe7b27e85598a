// SPDX-License-Identifier: BSD-3-Clause
// Distances between a picture and its reference. Pictures are linear RGB, packed.
#ifndef HF_BENCH_METRICS_H
#define HF_BENCH_METRICS_H

#include <stddef.h>
#include <stdint.h>

// Regions in which distances are taken. A pixel may be in several.
enum bench_region {
    BENCH_WHOLE,
    BENCH_SILHOUETTES,  // within the reach of a depth edge
    BENCH_NEAR,         // in front of the focus by more than a pixel of radius, outside silhouettes
    BENCH_FAR,          // the same behind the focus
    BENCH_FOCUS,        // all other pixels outside silhouettes
    BENCH_HIGHLIGHTS,   // within the reach of a pixel brighter than the display
    BENCH_REGIONS
};

// "whole", "silhouettes", ...
const char *bench_region_name(enum bench_region region);

// Bit r of out[] says whether the pixel lies in region r. radius: signed CoC radius of each pixel, near ones negative.
void bench_regions(uint8_t *out, const float *rgb, const float *radius, int width, int height);

struct bench_distance {
    double share;         // of the picture's pixels; 0: the region is empty, and the other members mean nothing
    double psnr;          // dB, of the display-encoded picture: clamped to 0..1, sRGB; INFINITY for identical pictures
    double display_rmse;  // 10^(-psnr / 20)
    double linear_rmse;
    double largest;  // linear, of one sample
    double ssim;     // of display-encoded luminance, mean
    double flip;     // mean
    double energy;   // sum of all samples over that of the reference
};

struct bench_metrics;

// Prepare the reference picture; want and regions must stay valid. NULL without memory.
struct bench_metrics *bench_metrics_open(const float *want, const uint8_t *regions, int width, int height);
void bench_metrics_compare(struct bench_metrics *m, const float *got, struct bench_distance out[BENCH_REGIONS]);
void bench_metrics_close(struct bench_metrics *m);

// 0..1, sRGB's curve.
float bench_display(float linear);
// Root mean square of the second difference of three consecutive display-encoded pictures: any change that is not
// steady.
double bench_flicker(const float *before, const float *now, const float *after, size_t samples);

#endif
