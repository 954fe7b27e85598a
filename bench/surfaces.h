// SPDX-License-Identifier: BSD-3-Clause
// What a picture hides: the second surface of each pixel, and the third.
#ifndef HF_BENCH_SURFACES_H
#define HF_BENCH_SURFACES_H

#include "scene.h"
#include "measure.h"

// The surfaces of a scene behind the first, with their memory.
struct bench_peel {
    int width, height;
    float *planes[4], *depth;  // premultiplied colour and alpha; alpha is the part of the pixel that has such a surface
    uint64_t samples;          // pixels that have one
};

// Read peel number k, from 1, of a picture file: that of scene.exr is scene.peel1.exr. Returns 0, or -1 with *error filled.
int bench_peel_read(struct bench_peel *peel, const char *path, int k, struct tool_error *error);
// Make peel number k of a built-in scene: the same picture, k times as far behind as it is far.
int bench_peel_make(struct bench_peel *peel, const struct bench_scene *scene, int k, struct tool_error *error);
void bench_peel_free(struct bench_peel *peel);

// Let a subject be rendered with peels, which must outlive it.
void bench_subject_peels(struct bench_subject *subject, const struct bench_peel *peels, int count);

#endif
