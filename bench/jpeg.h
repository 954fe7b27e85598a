// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_BENCH_JPEG_H
#define HF_BENCH_JPEG_H

#include <stdio.h>

// 1 if this build can.
int bench_jpeg_available(void);
// Write a window of packed linear RGB as a data URI of a JPEG with sRGB's curve. Returns 0, or -1.
int bench_jpeg_uri(FILE *out, const float *rgb, int picture_width, int x, int y, int width, int height);

#endif
