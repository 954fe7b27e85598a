// SPDX-License-Identifier: BSD-3-Clause
#include "tools/view/false_colour.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/cli/coc.h"
#include "tools/common/luminance.h"
#include "tools/view/look.h"

const char *const view_show_names[VIEW_SHOWS] = {"after", "before", "depth", "radius", "peaking", "tiles", "buffer"};

static uint32_t *row_of(struct view_result *result, int y)
{
    return result->pixels + (size_t)y * (size_t)result->at.width;
}

// Distances by their inverse, as blur is linear in that: the nearest is white.
static void paint_depth(const struct view_pixels *p, const struct hf_depth *depth, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    float least = INFINITY, most = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int y = 0; y < at->height; y++)
            for (int x = 0; x < at->width; x++) {
                float z;
                const int known = hf_depth_at(depth, p->width, p->height, at->x + x, at->y + y, &z, NULL) == HF_OK;
                const float inverse = known ? 1 / z : 0;
                if (pass) {
                    const float t = most > least ? (inverse - least) / (most - least) : 0.5f;
                    row_of(result, y)[x] = known ? view_look_pixel(t, 0.35f + 0.45f * t, 0.7f - 0.5f * t) : 0xff101010u;
                } else if (known) {
                    least = fminf(least, inverse);
                    most = fmaxf(most, inverse);
                }
            }
}

// Signed radii: near red, far blue, brighter with the radius; in focus green.
static uint32_t radius_colour(float r, float largest, float grey)
{
    const float t = largest > 0 ? sqrtf(fminf(fabsf(r) / largest, 1)) : 0;
    const float low = 0.15f + 0.25f * grey;
    if (fabsf(r) < CLI_SHARP_RADIUS)
        return view_look_pixel(0.1f, 0.45f + 0.5f * grey, 0.15f);
    return r < 0 ? view_look_pixel(0.25f + 0.7f * t, low * (1 - t), low * 0.6f * (1 - t))
                 : view_look_pixel(low * 0.6f * (1 - t), low * (1 - 0.5f * t), 0.3f + 0.7f * t);
}

static float grey_of(const struct view_pixels *p, size_t i)
{
    const float l = tool_luminance(p->plane[0][i], p->plane[1][i], p->plane[2][i]);
    return l > 0 ? sqrtf(fminf(l, 1)) : 0;
}

static void paint_radii(const struct view_pixels *p, const float *radii, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    const size_t n = (size_t)at->width * (size_t)at->height;
    float largest = 1;
    for (size_t i = 0; i < n; i++)
        largest = fmaxf(largest, fabsf(radii[i]));
    for (int y = 0; y < at->height; y++)
        for (int x = 0; x < at->width; x++) {
            const size_t from = (size_t)(at->y + y) * (size_t)p->width + (size_t)(at->x + x);
            row_of(result, y)[x] =
                radius_colour(radii[(size_t)y * (size_t)at->width + (size_t)x], largest, grey_of(p, from));
        }
}

// Mark edges of what is in focus.
static void paint_peaks(const struct view_pixels *p, const float *radii, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    for (int y = 0; y < at->height; y++)
        for (int x = 0; x < at->width; x++) {
            const int u = at->x + x, v = at->y + y;
            if (u + 1 >= p->width || v + 1 >= p->height ||
                fabsf(radii[(size_t)y * (size_t)at->width + (size_t)x]) >= CLI_SHARP_RADIUS)
                continue;
            const size_t i = (size_t)v * (size_t)p->width + (size_t)u;
            const float here = grey_of(p, i);
            const float step = fabsf(grey_of(p, i + 1) - here) + fabsf(grey_of(p, i + (size_t)p->width) - here);
            if (step > 0.08f)
                row_of(result, y)[x] = view_look_pixel(0.1f, 1, 0.2f);
        }
}

int view_radii(const struct hf_depth *depth, int width, int height, const struct hf_params *params,
               const struct hf_region *at, float *radii)
{
    const struct hf_io_box box = {at->x, at->y, at->x + at->width, at->y + at->height};
    return cli_coc_radii(depth, width, height, params, &box, radii);
}

static uint32_t tinted(uint32_t pixel, float r, float g, float b)
{
    return view_look_pixel(0.6f * (float)(pixel >> 16 & 255) / 255 + 0.4f * r,
                           0.6f * (float)(pixel >> 8 & 255) / 255 + 0.4f * g,
                           0.6f * (float)(pixel & 255) / 255 + 0.4f * b);
}

// As --explain-image: near red, far blue, both violet; sharp tiles as they are.
static void paint_tiles(const struct hf_inspect_report *r, const uint8_t *tiles, size_t count,
                        struct view_result *result)
{
    static const float tint[4][3] = {{1, 1, 1}, {1, 0.25f, 0.2f}, {0.2f, 0.4f, 1}, {0.75f, 0.25f, 0.9f}};
    const struct hf_region *at = &result->at;
    for (int y = 0; y < at->height && r->tile_width > 0 && r->tile_height > 0; y++)
        for (int x = 0; x < at->width; x++) {
            const int u = at->x + x, v = at->y + y;
            const size_t i = (size_t)(v / r->tile_height) * (size_t)r->columns + (size_t)(u / r->tile_width);
            const int tile = i < count ? tiles[i] : 0;
            uint32_t *to = &row_of(result, y)[x];
            if (u % r->tile_width == 0 || v % r->tile_height == 0)
                *to = 0xff000000u;
            else if (tile)
                *to = tinted(*to, tint[tile][0], tint[tile][1], tint[tile][2]);
        }
}

void view_false_colour(const struct view_request *q, const struct view_pixels *p, const struct hf_params *params,
                       const struct hf_depth *depth, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    if (q->show == VIEW_SHOW_DEPTH)
        paint_depth(p, depth, result);
    if (q->show == VIEW_SHOW_TILES && result->tiles)
        paint_tiles(&result->report.inner, result->tiles, result->tile_count, result);
    if (q->show != VIEW_SHOW_COC && q->show != VIEW_SHOW_PEAKING)
        return;
    float *radii = malloc((size_t)at->width * (size_t)at->height * sizeof(float));
    if (radii && !view_radii(depth, p->width, p->height, params, at, radii)) {
        if (q->show == VIEW_SHOW_COC)
            paint_radii(p, radii, result);
        else
            paint_peaks(p, radii, result);
    }
    free(radii);
}

// Fit a buffer of full, half or quarter resolution to the picture.
static void take_buffer(const struct hf_inspect_buffer *b, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    const int step = MAX(1, (int)lround((double)result->width / b->width));
    for (int c = 0; c < 3; c++)
        for (int y = 0; y < at->height; y++)
            for (int x = 0; x < at->width; x++) {
                const int u = MIN((at->x + x) / step, b->width - 1), v = MIN((at->y + y) / step, b->height - 1);
                const float *plane = b->data[b->channels >= 3 ? c : b->channels == 2 ? (c ? 1 : 0) : 0];
                result->plane[c][(size_t)y * (size_t)at->width + (size_t)x] =
                    *(const float *)((const char *)plane + v * b->stride + (ptrdiff_t)u * (ptrdiff_t)sizeof(float));
            }
}

void view_dump_buffer(void *cookie, const struct hf_inspect_buffer *buffer)
{
    struct view_dump *d = cookie;
    char *names = NULL;
    if (asprintf(&names, "%s%s\n", d->result->buffers ? d->result->buffers : "", buffer->name) >= 0) {
        free(d->result->buffers);
        d->result->buffers = names;
    }
    if (!strcmp(buffer->name, d->wanted))
        take_buffer(buffer, d->result);
}
