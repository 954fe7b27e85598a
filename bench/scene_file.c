// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#if HF_HAVE_IO
#include "tools/io/io.h"

#include <math.h>
#include <stdlib.h>

// The index of the first view that has a depth, or -1.
static int view_with_depth(const struct hf_io_file *file)
{
    for (int i = 0; i < hf_io_view_count(file); i++)
        if (hf_io_view(file, i)->depth_part >= 0)
            return i;
    return -1;
}

static void interleave(float *rgb, float *const planes[3], size_t pixels)
{
    for (size_t i = 0; i < pixels; i++)
        for (int c = 0; c < 3; c++)
            rgb[i * 3 + (size_t)c] = planes[c][i];
}

static int read_view(struct bench_scene *scene, struct hf_io_file *file, int view, int with_depth,
                     struct tool_error *error)
{
    const size_t pixels = (size_t)scene->width * (size_t)scene->height;
    float *memory = malloc(pixels * 3 * sizeof(float));
    scene->rgb = malloc(pixels * 3 * sizeof(float));
    if (with_depth)
        scene->depth = malloc(pixels * sizeof(float));
    int result = -1;
    if (memory && scene->rgb && (scene->depth || !with_depth)) {
        float *planes[4] = {memory, memory + pixels, memory + 2 * pixels, NULL};
        struct hf_io_error io;
        if (!hf_io_read_colour(file, view, planes, &io) &&
            (!with_depth || !hf_io_read_depth(file, view, scene->depth, &io))) {
            interleave(scene->rgb, planes, pixels);
            result = 0;
        } else {
            tool_fail(error, -1, "%s", io.message);
        }
    } else {
        tool_fail(error, -1, "there is not enough memory for a scene of %dx%d", scene->width, scene->height);
    }
    free(memory);
    return result;
}

int bench_scene_read(struct bench_scene *scene, const char *path, int with_depth, struct bench_camera *camera,
                     struct tool_error *error)
{
    *scene = (struct bench_scene){0};
    struct hf_io_error io;
    struct hf_io_file *file;
    if (hf_io_open(&file, path, NULL, &io))
        return tool_fail(error, -1, "%s", io.message);
    const int view = with_depth ? view_with_depth(file) : 0;
    int result = -1;
    if (view < 0) {
        tool_fail(error, -1, "%s has no depth channel", path);
    } else {
        const struct hf_io_view *v = hf_io_view(file, view);
        scene->width = v->width;
        scene->height = v->height;
        if (camera)
            *camera = (struct bench_camera){v->camera.focus, v->camera.f_number, v->camera.focal_length_mm,
                                            v->camera.sensor_width_mm};
        result = read_view(scene, file, view, with_depth, error);
    }
    hf_io_close(&file);
    if (result)
        bench_scene_free(scene);
    return result;
}

#else

int bench_scene_read(struct bench_scene *scene, const char *path, int with_depth, struct bench_camera *camera,
                     struct tool_error *error)
{
    (void)with_depth;
    (void)camera;
    *scene = (struct bench_scene){0};
    return tool_fail(error, -1, "there is no built-in scene '%s', and this build reads no files", path);
}

#endif
