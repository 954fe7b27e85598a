// SPDX-License-Identifier: BSD-3-Clause
// The gather's tap set, and its exact collapse onto the half-resolution lattice.
#ifndef HF_TAPS_H
#define HF_TAPS_H

#include "hyperfocal/hyperfocal.h"
#include "base/mem.h"
#include "base/stop.h"

// What a tap set follows from. No padding: keys are compared byte by byte.
struct hf_taps_key {
    float radius;        // h: reach of the outermost ring, half-resolution pixels, > 0
    float scale;         // kernel scale, 0.25..1
    float pixel_aspect;  // x offsets are divided by it
    int blades;          // 0: circles
    float rotation;      // degrees
    int dense;           // the 144-tap grid instead of rings
    float rings;         // how many; between whole numbers a blend of that many and one fewer; 0 with dense or area
    int area;            // instead of taps, all pixels by the area that the aperture covers of each
    int most_x, most_y;  // area: what lies farther away is never met; 0: all may be
};

// All bilinear taps have fixed offsets, so together they are one convolution with fixed weights on whole pixels. The
// 49 taps of the chapter touch 129 lattice points at kernel scale 1, 36 of them distinct by mirror symmetry.
struct hf_taps {
    int count;             // taps: the centre and the rings, or the dense grid, which has none on the centre
    const float *dx, *dy;  // their offsets in half-resolution pixels, kernel scale included; the centre comes first
    const float *share;    // what each counts: 1, but where two numbers of rings are blended

    int rx, ry;     // lattice reach: offsets -rx..rx, -ry..ry
    int symmetric;  // weights mirror in x and in y
    // The weights, each tap by its share, summing to 1 with their scale: only those that are not 0, row by row. Row k has entries first[k] to
    // first[k + 1]. symmetric: ry + 1 rows, for |dy| = k, with column |dx|. Else 2 ry + 1 rows, for dy = k - ry, with
    // column dx + rx. Of areas, a column beyond rx (symmetric) stands for the sum of all from -j to j, j = column - rx - 1.
    int rows;
    const int *first, *column;
    const float *weight;
    float scale;  // what their sums are multiplied by in the end; 1 but for areas, whose covered pixels weigh 1

    int runs;  // there are such columns
    // area: sums[y * (2 rx + 2) + x] of the weights above and left of lattice point (x - rx, y - ry), in units; else NULL.
    const int *sums;
    float unit;

    struct hf_block block;   // owns all of the above
    struct hf_taps_key key;  // what it was built from; radius 0: nothing yet
};

enum { HF_MAX_RINGS = 64 };
// Rings that reach a radius of so many half-resolution pixels, at most 2 apart; and before they are rounded up.
int hf_taps_rings(float radius);
float hf_taps_spaced(float radius);

// (Re)build for a key; does nothing when it is the one of the last call. Returns HF_OK, HF_ERR_MEMORY or HF_ERR_CANCELLED.
int hf_taps_build(struct hf_taps *taps, const struct hf_taps_key *key, const struct hf_mem *mem, atomic_int *stop);
// area: the sum of the weights of offsets x0..x1 - 1, y0..y1 - 1, cut to what there is: exact.
float hf_taps_part(const struct hf_taps *taps, int x0, int x1, int y0, int y1);
void hf_taps_free(struct hf_taps *taps, const struct hf_mem *mem);

#endif
