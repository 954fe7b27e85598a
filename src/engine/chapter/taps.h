// SPDX-License-Identifier: BSD-3-Clause
// The chapter's tap set, and its exact collapse onto the half-resolution lattice.
#ifndef HF_TAPS_H
#define HF_TAPS_H

#include "base/mem.h"
#include "pixel/convolve.h"

// What a tap set follows from. No padding: keys are compared byte by byte.
struct hf_taps_key {
    float radius;        // h: reach of the outermost ring, half-resolution pixels, > 0
    float scale;         // kernel scale, 0.25..1
    float pixel_aspect;  // x offsets are divided by it
    int blades;          // 0: circles
    float rotation;      // degrees
    int dense;           // the 144-tap grid instead of rings
    float rings;         // how many; between whole numbers a blend of that many and one fewer; 0 with dense
};

// All bilinear taps have fixed offsets, so together they are one convolution with fixed weights on whole pixels. The
// 49 taps of the chapter touch 129 lattice points at kernel scale 1, 36 of them distinct by mirror symmetry.
struct hf_tap_set {
    struct hf_taps taps;   // that convolution, each tap by its share
    int count;             // taps: the centre and the rings, or the dense grid, which has none on the centre
    const float *dx, *dy;  // their offsets in half-resolution pixels, kernel scale included; the centre comes first
    const float *share;    // what each counts: 1, but where two numbers of rings are blended

    struct hf_block block;   // owns all of the above
    struct hf_taps_key key;  // what it was built from; radius 0: nothing yet
};

enum { HF_MAX_RINGS = 64 };
// Rings that reach a radius of so many half-resolution pixels, at most 2 apart; and before they are rounded up.
int hf_taps_rings(float radius);
float hf_taps_spaced(float radius);

// (Re)build for a key; does nothing when it is the one of the last call. Returns HF_OK or HF_ERR_MEMORY.
int hf_tap_set_build(struct hf_tap_set *taps, const struct hf_taps_key *key, const struct hf_mem *mem);
void hf_tap_set_free(struct hf_tap_set *taps, const struct hf_mem *mem);

#endif
