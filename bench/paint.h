// SPDX-License-Identifier: BSD-3-Clause
// The picture of the built-in scenes, as a function of position.
#ifndef HF_BENCH_PAINT_H
#define HF_BENCH_PAINT_H

#include <stdint.h>

struct bench_colour {
    float r, g, b;
};

// The surface that is visible at a point.
struct bench_surface {
    float t;  // distance from the focus in ranges: -1.7..-0.3 near, 0 sharp, 0.1..3 far
    struct bench_colour colour;
};

// Point (u, v), in picture heights from the top left corner; aspect is width / height.
struct bench_surface bench_paint(float u, float v, float aspect);

// A pseudo-random number in [0, 1) that depends only on its arguments.
float bench_hash(int x, int y, uint32_t seed);

#endif
