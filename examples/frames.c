// SPDX-License-Identifier: BSD-3-Clause
// A software renderer with depth of field: a ring of cubes turns before the camera, Mesa draws each frame into memory,
// and hyperfocal defocuses it there, in place, within a time budget.
//
//     frames [WIDTHxHEIGHT [FRAMES [LAST.ppm [BUDGET_MS]]]]
//
// A frame buffer is what such a renderer has: 8-bit sRGB colour, rows from the top, and OpenGL's window depth as 32-bit
// whole numbers, rows from the bottom. Neither is converted or turned around here: format and stride say what they are.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <hyperfocal/hyperfocal.h>

#include "scene.h"

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void log_line(void *cookie, const struct hf_message *message)
{
    (void)cookie;
    if (message->level != HF_LOG_INFO)
        fprintf(stderr, "hyperfocal: %s\n", message->sentence);
}

// Defocus the frame where it lies, and say what it took.
static int defocus(struct hf_context *c, const struct buffers *b, const struct hf_params *p, int frame)
{
    const struct hf_image picture = {.size = sizeof picture,
                                     .width = b->width,
                                     .height = b->height,
                                     .format = HF_FORMAT_RGBX8,
                                     .data = {b->colour},
                                     .stride = {(ptrdiff_t)b->width * 4},
                                     .transfer = HF_TRANSFER_SRGB};
    const struct hf_depth depth = {.size = sizeof depth,
                                   .data = b->depth + (size_t)b->width * (size_t)(b->height - 1),
                                   .stride = -(ptrdiff_t)b->width * 4,
                                   .type = HF_DEPTH_NDC_D3D,
                                   .format = HF_DEPTH_FORMAT_UNORM32,
                                   .near_plane = (float)SCENE_NEAR,
                                   .far_plane = (float)SCENE_FAR};
    struct hf_report r = {.size = sizeof r};
    const int err = hf_render(c, &picture, &picture, &depth, p);
    if (err)
        return err;
    hf_get_report(c, &r);
    const double pixels = (double)b->width * b->height;
    printf("frame %3d: %.2f ms, blurred %.0f %%, budget step %d\n", frame, r.total_ms,
           100 * (1 - (double)r.sharp_pixels / pixels), r.budget_step);
    return HF_OK;
}

static int write_ppm(const char *path, const struct buffers *b)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return -1;
    fprintf(file, "P6 %d %d 255\n", b->width, b->height);
    for (size_t i = 0; i < (size_t)b->width * (size_t)b->height; i++)
        fwrite(b->colour + 4 * i, 1, 3, file);
    return fclose(file);
}

static int render_frames(const struct buffers *b, int frames, float budget_ms)
{
    const struct hf_config config = {.size = sizeof config, .log = log_line};
    struct hf_params p = hf_default_params();
    struct hf_context *c;
    int err = hf_open(&c, &config);
    p.model = HF_MODEL_LENS;
    p.focus = 6;
    p.lens.f_number = 0.7f;
    p.lens.world_unit_m = 0.25f;
    p.lens.focal_length_mm = scene_focal_mm(b);
    p.run.budget_ms = budget_ms;
    for (int i = 0; i < frames && !err; i++) {
        const double start = now_ms();
        draw_scene(b, i / 24.0);
        const double drawn = now_ms();
        err = defocus(c, b, &p, i);
        if (!err && i == frames - 1)
            printf("last frame: %.2f ms drawn, %.2f ms defocused\n", drawn - start, now_ms() - drawn);
    }
    if (err)
        fprintf(stderr, "frames: %s\n", hf_error_string(err));
    hf_close(&c);
    return err;
}

int main(int argc, char **argv)
{
    struct buffers b = {.width = 1280, .height = 720};
    if (argc > 1 && (sscanf(argv[1], "%dx%d", &b.width, &b.height) != 2 || b.width < 1 || b.height < 1 ||
                     b.width > 8192 || b.height > 8192)) {
        fprintf(stderr, "frames: the size \"%s\" is not WIDTHxHEIGHT, 1 to 8192 each\n", argv[1]);
        return 1;
    }
    const int frames = argc > 2 ? atoi(argv[2]) : 48;
    const size_t pixels = (size_t)b.width * (size_t)b.height;
    OSMesaContext gl = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, NULL);
    b.colour = malloc(pixels * 4);
    b.depth = malloc(pixels * 4);
    int failed = !gl || !b.colour || !b.depth || !OSMesaMakeCurrent(gl, b.colour, GL_UNSIGNED_BYTE, b.width, b.height);
    if (failed) {
        fprintf(stderr, "frames: Mesa could not be started\n");
    } else {
        OSMesaPixelStore(OSMESA_Y_UP, 0);
        failed = render_frames(&b, frames, argc > 4 ? (float)atof(argv[4]) : 16) != HF_OK;
        if (!failed && argc > 3 && write_ppm(argv[3], &b)) {
            fprintf(stderr, "frames: %s could not be written\n", argv[3]);
            failed = 1;
        }
    }
    free(b.colour);
    free(b.depth);
    if (gl)
        OSMesaDestroyContext(gl);
    return failed;
}
