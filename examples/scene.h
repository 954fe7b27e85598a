// SPDX-License-Identifier: BSD-3-Clause
// What both examples draw: a ring of cubes that turns before the camera, into a frame buffer in memory.
#ifndef EXAMPLES_SCENE_H
#define EXAMPLES_SCENE_H

#include <GL/gl.h>
#include <GL/osmesa.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define SCENE_NEAR 0.5  // clip planes, scene units
#define SCENE_FAR 60.0
#define SCENE_DEGREES 40.0  // vertical angle of view

// Colour: rows from the top. Depth: window depth as OpenGL reads it, rows from the bottom.
struct buffers {
    int width, height;
    uint8_t *colour;  // R, G, B and a byte of no meaning
    uint32_t *depth;
};

static inline void draw_cube(double size, const float rgb[3])
{
    static const signed char corner[6][4][3] = {
        {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}, {{1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, {1, 1, -1}},
        {{1, -1, 1}, {1, -1, -1}, {1, 1, -1}, {1, 1, 1}}, {{-1, -1, -1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}},
        {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}}, {{-1, -1, -1}, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1}},
    };
    static const float shade[6] = {1, 0.35f, 0.75f, 0.55f, 0.9f, 0.25f};
    glBegin(GL_QUADS);
    for (int face = 0; face < 6; face++) {
        glColor3f(rgb[0] * shade[face], rgb[1] * shade[face], rgb[2] * shade[face]);
        for (int i = 0; i < 4; i++)
            glVertex3d(size * corner[face][i][0], size * corner[face][i][1], size * corner[face][i][2]);
    }
    glEnd();
}

static inline void draw_scene(const struct buffers *b, double seconds)
{
    const double top = SCENE_NEAR * tan(SCENE_DEGREES * M_PI / 360), right = top * b->width / b->height;
    glViewport(0, 0, b->width, b->height);
    glClearColor(0.05f, 0.06f, 0.09f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    glFrustum(-right, right, -top, top, SCENE_NEAR, SCENE_FAR);
    glMatrixMode(GL_MODELVIEW);
    for (int i = 0; i < 48; i++) {
        const double angle = seconds + i * 2 * M_PI / 12, radius = 3 + 6 * (i / 12);
        const float rgb[3] = {0.2f + 0.8f * (float)(i % 3 == 0), 0.2f + 0.7f * (float)(i % 3 == 1),
                              0.9f - 0.2f * (float)(i % 4)};
        glLoadIdentity();
        glTranslated(radius * sin(angle), 0.6 * sin(3 * angle), -8 + radius * cos(angle) * 0.8);
        glRotated(40 * seconds + 30 * i, 0.3, 1, 0.2);
        draw_cube(0.45, rgb);
    }
    glFinish();
    glReadPixels(0, 0, b->width, b->height, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, b->depth);
}

// The focal length of a camera with a 36 mm sensor and this angle of view.
static inline float scene_focal_mm(const struct buffers *b)
{
    return (float)(18 / tan(SCENE_DEGREES * M_PI / 360) * b->height / b->width);
}

#endif
