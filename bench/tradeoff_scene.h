// SPDX-License-Identifier: BSD-3-Clause
// Scenes with their truth: NAME.exr has depth, and a camera in its header; NAME.truth.exr is what a lens sees.
#ifndef HF_BENCH_TRADEOFF_SCENE_H
#define HF_BENCH_TRADEOFF_SCENE_H

#include "metrics.h"
#include "scene.h"
#include "tradeoff.h"

struct trade_scene {
    char name[64];
    struct bench_scene picture, truth;
    struct bench_camera camera;
    float largest;  // largest CoC radius of the depth, pixels
    uint8_t *regions;
    struct bench_metrics *metrics;
    int crop_x, crop_y;  // the window shown on the page: the one with the most silhouettes
};

// The signed CoC radius at a depth, pixels, for a thin lens.
float trade_radius(const struct bench_camera *camera, int width, float z);

// Read all scenes of a folder in the order of their names, at most TRADE_SCENES. Returns how many, or -1 with *error
// filled.
int trade_scenes_read(struct trade_scene scenes[TRADE_SCENES], const char *folder, struct tool_error *error);
void trade_scenes_free(struct trade_scene *scenes, int n);

// Size of the crops, pixels.
enum { TRADE_CROP_WIDTH = 240, TRADE_CROP_HEIGHT = 160 };

#endif
