// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/picture.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void free_pixels(struct view_pixels *p)
{
    for (int c = 0; c < 4; c++)
        free(p->plane[c]);
    free(p->depth);
}

static void free_picture(struct view_picture *p)
{
    for (int i = 1; i < VIEW_REDUCTIONS; i++)  // the first is the frame's own
        free_pixels(&p->reduced[i]);
    cli_frame_close(&p->frame);
    free((char *)p->args.input);
    free((char *)p->args.depth_file);
    cli_free_args(&p->args);
    view_words_free(&p->words);
    g_mutex_clear(&p->lock);
    free(p);
}

struct view_picture *view_picture_ref(struct view_picture *p)
{
    g_atomic_ref_count_inc(&p->refs);
    return p;
}

void view_picture_unref(struct view_picture *p)
{
    if (p && g_atomic_ref_count_dec(&p->refs))
        free_picture(p);
}

static int load(struct view_picture *p, const char *input, const char *depth_file, struct tool_error *error)
{
    struct hf_io_run run;
    if (view_words_parse(&p->words, &p->args, error)) {
        p->args.input = p->args.depth_file = NULL;
        return -1;
    }
    if (p->args.merge || p->args.other_option) {
        tool_fail(error, -1, "%s: the window shows one picture; the command takes several",
                  p->args.merge ? "--merge" : p->args.other_option);
        p->args.input = p->args.depth_file = NULL;
        return -1;
    }
    p->args.input = strdup(input ? input : p->args.input);
    if (depth_file || p->args.depth_file)
        p->args.depth_file = strdup(depth_file ? depth_file : p->args.depth_file);
    if (!p->args.input || stat(p->args.input, &p->file))
        return tool_fail(error, -1, "%s: %s", p->args.input ? p->args.input : "picture", strerror(errno));
    const int threaded = !hf_io_threads_open(&run, g_get_num_processors() < 4 ? (int)g_get_num_processors() : 4);
    int status = cli_frame_open(&p->frame, &p->args, threaded ? &run : NULL, error);
    if (!status)
        status = cli_frame_load(&p->frame, error);
    p->frame.run = NULL;
    if (threaded)
        hf_io_threads_close(&run);
    return status ? -1 : 0;
}

// Choose the view to look at.
static void show(struct view_picture *p, int view)
{
    p->shown = view < p->frame.view_count ? view : 0;
    struct cli_view *v = &p->frame.views[p->shown];
    const struct hf_image image = cli_view_image(v, 0);
    p->reduced[0] = (struct view_pixels){.width = image.width, .height = image.height, .depth = v->depth};
    for (int c = 0; c < 4; c++)
        p->reduced[0].plane[c] = image.data[c];
}

struct view_picture *view_picture_load(struct view_words *words, const char *input, const char *depth_file, int view,
                                       struct tool_error *error)
{
    struct view_picture *p = calloc(1, sizeof(*p));
    if (!p) {
        tool_fail(error, -1, "out of memory");
        return NULL;
    }
    g_atomic_ref_count_init(&p->refs);
    g_mutex_init(&p->lock);
    p->words = *words;
    *words = (struct view_words){0};
    if (load(p, input, depth_file, error)) {
        free_picture(p);
        return NULL;
    }
    show(p, view);
    return p;
}

struct view_picture *view_picture_make(const struct hf_io_view *view, float *const planes[3], float *depth)
{
    struct view_picture *p = calloc(1, sizeof(*p));
    struct cli_view *v = p ? calloc(1, sizeof(*v)) : NULL;
    if (!v) {
        for (int c = 0; c < 3; c++)
            free(planes[c]);
        free(depth);
        free(p);
        return NULL;
    }
    g_atomic_ref_count_init(&p->refs);
    g_mutex_init(&p->lock);
    p->made = *view;
    *v = (struct cli_view){
        .view = &p->made, .depth = depth, .label = strdup("scene"), .planes = {planes[0], planes[1], planes[2]}};
    p->args.input = strdup("scene");
    p->frame = (struct cli_frame){.args = &p->args, .views = v, .view_count = 1, .loaded = 1};
    show(p, 0);
    return p;
}

const struct cli_view *view_picture_view(const struct view_picture *p)
{
    return &p->frame.views[p->shown];
}

// Means of squares of n x n pixels; those at the right and the lower border are smaller.
static void shrink(const float *from, int width, int height, int n, float *to, int to_width, int to_height)
{
    for (int y = 0; y < to_height; y++)
        for (int x = 0; x < to_width; x++) {
            const int x1 = MIN(width, (x + 1) * n), y1 = MIN(height, (y + 1) * n);
            float sum = 0;
            for (int v = y * n; v < y1; v++)
                for (int u = x * n; u < x1; u++)
                    sum += from[(size_t)v * (size_t)width + (size_t)u];
            to[(size_t)y * (size_t)to_width + (size_t)x] = sum / (float)((x1 - x * n) * (y1 - y * n));
        }
}

// Depth is never averaged: the middle sample of each square. Radii in pixels become smaller with the pixels.
static void shrink_depth(const float *from, int width, int height, int n, float scale, float *to, int to_width,
                         int to_height)
{
    for (int y = 0; y < to_height; y++)
        for (int x = 0; x < to_width; x++) {
            const int u = MIN(width - 1, x * n + n / 2), v = MIN(height - 1, y * n + n / 2);
            to[(size_t)y * (size_t)to_width + (size_t)x] = from[(size_t)v * (size_t)width + (size_t)u] * scale;
        }
}

static int reduce(const struct view_picture *p, int n, struct view_pixels *to)
{
    const struct view_pixels *from = &p->reduced[0];
    *to = (struct view_pixels){.width = (from->width + n - 1) / n, .height = (from->height + n - 1) / n};
    const size_t size = (size_t)to->width * (size_t)to->height * sizeof(float);
    int failed = !(to->depth = hf_io_alloc(size));
    for (int c = 0; c < 4 && !failed; c++)
        failed = from->plane[c] && !(to->plane[c] = hf_io_alloc(size));
    if (failed) {
        free_pixels(to);
        *to = (struct view_pixels){0};
        return -1;
    }
    for (int c = 0; c < 4; c++)
        if (to->plane[c])
            shrink(from->plane[c], from->width, from->height, n, to->plane[c], to->width, to->height);
    const float scale = p->args.depth_type == HF_DEPTH_COC ? 1 / (float)n : 1;
    shrink_depth(from->depth, from->width, from->height, n, scale, to->depth, to->width, to->height);
    return 0;
}

const struct view_pixels *view_picture_at(struct view_picture *p, int n)
{
    struct view_pixels *r = &p->reduced[n - 1];
    g_mutex_lock(&p->lock);
    const int failed = !r->depth && reduce(p, n, r);
    g_mutex_unlock(&p->lock);
    return failed ? NULL : r;
}

int view_picture_setup(struct view_picture *p, const struct cli_args *args, struct cli_setup *setup,
                       struct tool_error *error)
{
    struct cli_args own = *args;
    own.grow = 0;  // which would change the picture
    own.input = p->args.input;
    p->frame.args = &own;
    const int status = cli_frame_setup(&p->frame, error);
    p->frame.args = &p->args;
    if (status)
        return -1;
    *setup = view_picture_view(p)->setup;
    setup->depth.data = view_picture_view(p)->depth;
    return 0;
}

static void divide(float *value, int n, float least)
{
    if (*value != HF_DERIVE)
        *value = fmaxf(*value / (float)n, least);
}

void view_reduce_setup(struct hf_params *params, struct hf_depth *depth, const struct view_pixels *pixels, int n)
{
    depth->data = pixels->depth;
    depth->stride = (ptrdiff_t)pixels->width * (ptrdiff_t)sizeof(float);
    depth->focal_px /= (float)n;
    depth->center_x /= (float)n;
    depth->center_y /= (float)n;
    if (n == 1)
        return;
    params->view.display_width = MAX(1, (params->view.display_width + n / 2) / n);
    params->view.display_height = MAX(1, (params->view.display_height + n / 2) / n);
    divide(&params->max_radius, n, 0);
    divide(&params->layers.spacing, n, 0.25f);
    divide(&params->layers.half_from, n, 1);
    divide(&params->layers.quarter_from, n, 1);
    divide(&params->gaussian.sigma, n, 0);
}

void view_picture_distances(const struct view_picture *p, const struct hf_depth *depth, float *nearest, float *farthest)
{
    enum { GRID = 96 };
    const struct hf_io_view *v = view_picture_view(p)->view;
    *nearest = INFINITY;
    *farthest = 0;
    for (int i = 0; i < GRID * GRID && depth->type != HF_DEPTH_COC; i++) {
        const int x = (int)((int64_t)(i % GRID) * v->width / GRID), y = (int)((int64_t)(i / GRID) * v->height / GRID);
        float z;
        if (hf_depth_at(depth, v->width, v->height, x, y, &z, NULL) != HF_OK)
            continue;
        *nearest = fminf(*nearest, z);
        *farthest = fmaxf(*farthest, z);
    }
    if (*farthest <= 0) {
        *nearest = 1;
        *farthest = 100;
    }
}

int view_picture_changed(const struct view_picture *p)
{
    struct stat now;
    if (stat(p->args.input, &now))
        return 2;
    return now.st_ino != p->file.st_ino || now.st_size != p->file.st_size ||
           now.st_mtim.tv_sec != p->file.st_mtim.tv_sec || now.st_mtim.tv_nsec != p->file.st_mtim.tv_nsec;
}
