// SPDX-License-Identifier: BSD-3-Clause
// What is visible around near pixels, in double precision, from its description: averages over ever wider
// neighbourhoods of half-resolution pixels. For radii up to 30.
#ifndef HF_TESTS_SEEN_H
#define HF_TESTS_SEEN_H

#include "support/image.h"

enum { SEEN_PLANES = 10 };

// The planes, followed by the largest near radius of each quad.
struct seen {
    int width, height, planes;
    double *plane[SEEN_PLANES + 1];
};

struct seen seen_new(int width, int height, int planes);
void seen_free(struct seen *s);
// Pixels may lie up to 20 beyond the frame.
double *seen_at(const struct seen *s, int p, int x, int y);
// The largest near radius of a quad and those up to 7 quads around it.
double seen_widest(const struct seen *s, int x, int y);
// The visible part of a pixel of radius r < 0.
double seen_part(double r, double widest);
// The sum of all neighbourhoods; consumes its argument.
struct seen seen_around(struct seen level);
// A plane at a full-resolution pixel, bilinearly.
double seen_sample(const struct seen *s, int p, int x, int y);

#endif
