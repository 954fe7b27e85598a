// SPDX-License-Identifier: BSD-3-Clause
// Puts pictures of any size where the window shows them. Pixels are those of the screen. No GTK.
#ifndef HF_VIEW_COMPOSE_H
#define HF_VIEW_COMPOSE_H

#include <stdint.h>

// Where the picture is on the screen: its top left corner lies at (x, y), and one of its pixels is zoom high and aspect times as
// wide.
struct view_camera {
    double zoom, aspect, x, y;
};

// A part of the picture at 1/n of its size.
struct view_layer {
    const uint32_t *pixels;
    int x, y, width, height;  // of the part, in its own pixels
    int n;
    int from, to;  // columns of the screen that it may cover
};

struct view_screen {
    uint32_t *pixels;
    int width, height;
};

// The camera as it is drawn: whole pixels where one of the picture covers one or more of the screen.
struct view_camera view_camera_drawn(const struct view_camera *camera);

void view_compose_clear(const struct view_screen *screen, uint32_t colour);
// Whether the layer would leave nothing of the screen free.
int view_compose_covers(const struct view_screen *screen, const struct view_camera *camera,
                        const struct view_layer *layer);
// Returns 0, or -1 if there is not enough memory.
int view_compose(const struct view_screen *screen, const struct view_camera *camera, const struct view_layer *layer);

#endif
