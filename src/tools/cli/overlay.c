// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/overlay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/target.h"
#include "tools/common/luminance.h"
#include "tools/common/report.h"

typedef void paint(const struct cli_view *v, float *const planes[3]);

// Paint the tiles: near ones red, far ones blue, both violet, sharp ones unchanged, with dark lines between them.
static void paint_tiles(const struct cli_view *v, float *const planes[3])
{
    static const float tint[4][3] = {{1, 1, 1}, {1, 0.25f, 0.2f}, {0.2f, 0.4f, 1}, {0.75f, 0.25f, 0.9f}};
    const struct tool_report *r = &v->report;
    const int width = v->view->width, height = v->view->height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint8_t tile = v->tiles[y / r->inner.tile_height * r->inner.columns + x / r->inner.tile_width];
            const int line = x % r->inner.tile_width == 0 || y % r->inner.tile_height == 0;
            for (int c = 0; c < 3; c++) {
                const size_t i = (size_t)y * (size_t)width + (size_t)x;
                const float colour = v->planes[c][i];
                // Half of the picture plus half of the tint, which is as bright as a mid grey.
                planes[c][i] = line ? 0 : tile == HF_TILE_SHARP ? colour : 0.5f * colour + 0.1f * tint[tile][c];
            }
        }
}

// Paint the pixels: near ones red, those in focus green, far ones blue, as bright as the picture.
static void paint_focus(const struct cli_view *v, float *const planes[3])
{
    static const float tints[3][3] = {{1, 0.06f, 0.04f}, {0.1f, 1, 0.1f}, {0.05f, 0.12f, 1}};
    const size_t n = (size_t)v->view->width * (size_t)v->view->height;
    for (size_t i = 0; i < n; i++) {
        const float r = v->radii[i];
        const float *tint = tints[fabsf(r) < CLI_SHARP_RADIUS ? 1 : r < 0 ? 0 : 2];
        const float luma = tool_luminance(v->planes[0][i], v->planes[1][i], v->planes[2][i]);
        const float grey = luma > 0 ? fminf(luma, 1) : 0;
        for (int c = 0; c < 3; c++)
            planes[c][i] = tint[c] * (0.08f + 0.92f * grey) + 0.1f * grey;
    }
}

enum { OVERLAYS = 2 };
struct overlay {
    const char *option, *file;
    paint *paint;
};

static void list_overlays(const struct cli_args *args, struct overlay list[OVERLAYS])
{
    list[0] = (struct overlay){"--explain-image", args->explain_image, paint_tiles};
    list[1] = (struct overlay){"--focus-image", args->focus_image, paint_focus};
}

// The name of the copy: FILE, or with several views FILE with the view's name before the extension.
static char *image_path(const struct cli_frame *frame, const struct cli_view *v, const char *file)
{
    const char *dot = strrchr(file, '.'), *slash = strrchr(file, '/');
    char *path = NULL;
    if (frame->view_count == 1)
        return strdup(file);
    if (!dot || (slash && dot < slash))
        dot = file + strlen(file);
    const int stem = (int)(dot - file);
    const int n = v->tag[0] ? asprintf(&path, "%.*s.%s%s", stem, file, v->tag, dot)
                            : asprintf(&path, "%.*s.view%d%s", stem, file, v->index, dot);
    if (n < 0)
        return NULL;
    // The view's name comes from the file; it must not lead to another directory.
    for (char *c = path + stem; c < path + n - strlen(dot); c++)
        if (*c == '/')
            *c = '_';
    return path;
}

int cli_overlay_check(const struct cli_frame *frame, struct tool_error *error)
{
    struct overlay list[OVERLAYS];
    int status = 0;
    list_overlays(frame->args, list);
    for (int k = 0; k < OVERLAYS; k++)
        for (int i = 0; i < frame->view_count && !status && list[k].file; i++) {
            char *path = image_path(frame, &frame->views[i], list[k].file);
            status = path ? cli_check_overwrite(frame->args, list[k].option, path, error)
                          : tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", frame->views[i].label);
            free(path);
        }
    return status;
}

static int write_image(const struct cli_frame *frame, const struct cli_view *v, const struct overlay *overlay,
                       struct tool_error *error)
{
    const size_t pixels = (size_t)v->view->width * (size_t)v->view->height;
    float *memory = malloc(3 * pixels * sizeof(float));
    char *path = image_path(frame, v, overlay->file);
    int status = 0;
    if (!memory || !path) {
        status = tool_fail(error, CLI_ALL_FAILED, "%s: out of memory", v->label);
    } else {
        float *const planes[3] = {memory, memory + pixels, memory + 2 * pixels};
        struct hf_io_error io;
        overlay->paint(v, planes);
        const struct hf_io_result result = {.view = v->index, .planes = {planes[0], planes[1], planes[2]}};
        const struct hf_io_job job = {.path = path, .results = &result, .result_count = 1};
        if (hf_io_write(frame->file, &job, NULL, &io))
            status = tool_fail(error, CLI_ALL_FAILED, "%s: %s", overlay->option, io.message);
    }
    free(memory);
    free(path);
    return status;
}

int cli_overlay_write(const struct cli_frame *frame, struct tool_error *error)
{
    struct overlay list[OVERLAYS];
    list_overlays(frame->args, list);
    for (int k = 0; k < OVERLAYS; k++)
        for (int i = 0; i < frame->view_count && list[k].file; i++) {
            const int status = write_image(frame, &frame->views[i], &list[k], error);
            if (status)
                return status;
        }
    return 0;
}
