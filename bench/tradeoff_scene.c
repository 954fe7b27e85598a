// SPDX-License-Identifier: BSD-3-Clause
#include "tradeoff_scene.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char ending[] = ".truth.exr";

float trade_radius(const struct bench_camera *c, int width, float z)
{
    const float aperture = c->focal_length_mm / 1000 / (2 * c->f_number);
    const float focal_px = c->focal_length_mm / c->sensor_width_mm * (float)width;
    const float inverse = z > 0 && z < 1e10f ? 1 / z : 0;  // no surface: infinitely far
    return aperture * focal_px * (1 / c->focus - inverse);
}

// Find the window with the most silhouettes, on a grid of half its size.
static void choose_crop(struct trade_scene *s)
{
    long most = -1;
    const int w = s->picture.width, h = s->picture.height;
    for (int y = 0; y + TRADE_CROP_HEIGHT <= h; y += TRADE_CROP_HEIGHT / 2)
        for (int x = 0; x + TRADE_CROP_WIDTH <= w; x += TRADE_CROP_WIDTH / 2) {
            long n = 0;
            for (int v = y; v < y + TRADE_CROP_HEIGHT; v++)
                for (int u = x; u < x + TRADE_CROP_WIDTH; u++) {
                    const uint8_t r = s->regions[(size_t)v * (size_t)w + (size_t)u];
                    n += (r >> BENCH_SILHOUETTES & 1) + (r >> BENCH_HIGHLIGHTS & 1) + 2 * (r >> BENCH_FOCUS & 1);
                }
            if (n > most) {
                most = n;
                s->crop_x = x;
                s->crop_y = y;
            }
        }
}

static int find_regions(struct trade_scene *s, struct tool_error *error)
{
    const size_t pixels = (size_t)s->picture.width * (size_t)s->picture.height;
    float *radius = malloc(pixels * sizeof *radius);
    s->regions = malloc(pixels);
    if (radius && s->regions) {
        for (size_t i = 0; i < pixels; i++) {
            radius[i] = trade_radius(&s->camera, s->picture.width, s->picture.depth[i]);
            s->largest = fmaxf(s->largest, fabsf(radius[i]));
        }
        bench_regions(s->regions, s->picture.rgb, radius, s->picture.width, s->picture.height);
        choose_crop(s);
        s->metrics = bench_metrics_open(s->truth.rgb, s->regions, s->picture.width, s->picture.height);
    }
    free(radius);
    return s->metrics ? 0 : tool_fail(error, -1, "there is not enough memory for %s", s->name);
}

static int read_scene(struct trade_scene *s, const char *folder, struct tool_error *error)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.exr", folder, s->name);
    if (bench_scene_read(&s->picture, path, 1, &s->camera, error))
        return -1;
    if (!(s->camera.sensor_width_mm > 0))
        s->camera.sensor_width_mm = 36;
    if (!(s->camera.focus > 0 && s->camera.f_number > 0 && s->camera.focal_length_mm > 0))
        return tool_fail(error, -1, "%s has no complete camera in its header", path);
    snprintf(path, sizeof path, "%s/%s%s", folder, s->name, ending);
    if (bench_scene_read(&s->truth, path, 0, NULL, error))
        return -1;
    if (s->truth.width != s->picture.width || s->truth.height != s->picture.height)
        return tool_fail(error, -1, "%s is %dx%d, its scene %dx%d", path, s->truth.width, s->truth.height,
                         s->picture.width, s->picture.height);
    return find_regions(s, error);
}

static int has_truth(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name), e = sizeof ending - 1;
    return n > e && n - e < sizeof((struct trade_scene *)0)->name && !strcmp(entry->d_name + n - e, ending);
}

int trade_scenes_read(struct trade_scene scenes[TRADE_SCENES], const char *folder, struct tool_error *error)
{
    struct dirent **entries;
    const int found = scandir(folder, &entries, has_truth, alphasort);
    int n = 0, err = 0;
    if (found < 0)
        return tool_fail(error, -1, "cannot read the folder %s: %s", folder, strerror(errno));
    for (int i = 0; i < found; i++) {
        if (n < TRADE_SCENES && !err) {
            scenes[n] = (struct trade_scene){.name = ""};
            snprintf(scenes[n].name, sizeof scenes[n].name, "%.*s",
                     (int)(strlen(entries[i]->d_name) - (sizeof ending - 1)), entries[i]->d_name);
            err = read_scene(&scenes[n++], folder, error);
        }
        free(entries[i]);
    }
    free(entries);
    if (!err && !n)
        err = tool_fail(error, -1, "there is no NAME%s in the folder %s", ending, folder);
    if (!err && found > TRADE_SCENES)
        err = tool_fail(error, -1, "%s has %d scenes; at most %d are measured at a time", folder, found, TRADE_SCENES);
    if (!err)
        return n;
    trade_scenes_free(scenes, n);
    return -1;
}

void trade_scenes_free(struct trade_scene *scenes, int n)
{
    for (int i = 0; i < n; i++) {
        bench_metrics_close(scenes[i].metrics);
        bench_scene_free(&scenes[i].picture);
        bench_scene_free(&scenes[i].truth);
        free(scenes[i].regions);
    }
}
