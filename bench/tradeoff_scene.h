// SPDX-License-Identifier: BSD-3-Clause
// Pictures with their truth: NAME.exr with depth and a camera in its header, NAME.truth.exr what a lens sees.
#ifndef HF_BENCH_TRADEOFF_SCENE_H
#define HF_BENCH_TRADEOFF_SCENE_H

#include "metrics.h"
#include "scene.h"
#include "tradeoff.h"

struct trade_scene {
    char name[64];
    struct bench_scene picture, truth;
    struct bench_camera camera;
    float largest;  // CoC radius that the depth shows, pixels
    uint8_t *regions;
    struct bench_metrics *metrics;
    int crop_x, crop_y;  // what the page shows: where there are most silhouettes
};

// Signed CoC radius of a depth, pixels: the lens of DESIGN.md, section 4.
float trade_radius(const struct bench_camera *camera, int width, float z);

// Read all scenes of a folder, by name; at most TRADE_SCENES. Returns how many, or -1 with *error filled.
int trade_scenes_read(struct trade_scene scenes[TRADE_SCENES], const char *folder, struct tool_error *error);
void trade_scenes_free(struct trade_scene *scenes, int n);

// Pixels of the crops.
enum { TRADE_CROP_WIDTH = 240, TRADE_CROP_HEIGHT = 160 };

#endif
