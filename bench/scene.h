// SPDX-License-Identifier: BSD-3-Clause
// Pictures to measure on: built-in scenes, painted at any size without a file, and picture files.
//
// The built-in scenes show one picture, a house at night behind a railing, and differ only in depth. So differences in
// time come from the depth. Painting uses an integer hash, and no function of libm that rounds differently elsewhere:
// the same size gives the same bits on every run and machine.
#ifndef HF_BENCH_SCENE_H
#define HF_BENCH_SCENE_H

#include "tools/common/error.h"

// A picture: width * height pixels, rows packed tightly.
struct bench_scene {
    int width, height;
    float *rgb;    // 3 floats a pixel, linear
    float *depth;  // view depth, scene units
};

// The focus for which depths are painted.
struct bench_optics {
    float focus;       // scene units, > 0
    float range;       // scene units, >= 0; 0 and INFINITY paint as focus / 2
    float max_radius;  // pixels; only `both` uses it
};

// The depth of each pixel, in ranges from the focus: -1 and less is fully near, +1 and more fully far, 0 sharp.
//   mixed   near, sharp and far in about equal parts
//   near    near everywhere, blurred by 0.2 to 1
//   far     far everywhere, blurred by 0.2 to 1
//   both    near discs all over a far background: the blurred near CoC is > 0 on every pixel, the far CoC on most
//   full    far everywhere, blurred by 1: one radius
//   focus   all sharp
//   band:P  a band of P % of the rows is blurred, its left half near, its right half far; all else is sharp. In
//           band-near:P, band-far:P and band-both:P the band is as in `near`, `far` or `both`
extern const char *const bench_scene_names[];  // NULL ends it; "band:P" stands for all bands

// 1 if the name is that of a built-in scene. *band receives the share of a band in 0..1.
int bench_scene_builtin(const char *name, float *band);

// Paint a built-in scene. Returns 0, or -1 with *error filled and an empty scene.
int bench_scene_paint(struct bench_scene *scene, const char *name, int width, int height,
                      const struct bench_optics *optics, struct tool_error *error);

// The depth of another built-in scene for a picture that was painted as `mixed` with the same optics.
int bench_scene_depth(const struct bench_scene *mixed, const char *name, const struct bench_optics *optics,
                      float *depth, struct tool_error *error);

// The camera that a file names; NAN what it does not.
struct bench_camera {
    float focus;  // metres
    float f_number, focal_length_mm, sensor_width_mm;
};

// Read the first view with depth of a picture file, or with_depth 0 the first view, without. Colour only: alpha is not
// read. camera may be NULL. Fails in builds without the file layer.
int bench_scene_read(struct bench_scene *scene, const char *path, int with_depth, struct bench_camera *camera,
                     struct tool_error *error);

void bench_scene_free(struct bench_scene *scene);

#endif
