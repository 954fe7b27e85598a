// SPDX-License-Identifier: BSD-3-Clause
// A moving scene, rendered in software: a hall of columns with ornaments and lamps near and far. No GTK.
#ifndef HF_VIEW_SCENE_H
#define HF_VIEW_SCENE_H

// Fill planes of linear colour and of view distance at a time in seconds.
void view_scene(float *const rgb[3], float *depth, int width, int height, double seconds);

#endif
