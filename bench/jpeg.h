// SPDX-License-Identifier: BSD-3-Clause
#ifndef HF_BENCH_JPEG_H
#define HF_BENCH_JPEG_H

#include <stdio.h>

// Returns 1 if this build can write JPEG.
int bench_jpeg_available(void);
// Write a window of packed linear RGB as a data URI of a JPEG, with the sRGB curve. Returns 0, or -1.
int bench_jpeg_uri(FILE *out, const float *rgb, int picture_width, int x, int y, int width, int height);

#endif
