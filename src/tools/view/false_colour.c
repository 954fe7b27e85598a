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

// The engine's buffers.

enum kind {
    KIND_COLOUR,
    KIND_SAMPLES,  // colour of samples, some of which are none
    KIND_NUMBER,   // of a channel, not negative
    KIND_FIELDS,   // CoC of the near field and of the far one
    KIND_RADIUS,   // signed
    KIND_WEIGHED,  // weight and radius of samples
    KIND_SLICES,
};

// What buffers hold. "at" behind a sample's name tells which of them there are.
static const struct known_buffer {
    const char *name, *label;
    enum kind kind;
} known[] = {
    {"colour", "Picture as loaded", KIND_COLOUR},
    {"slices", "Slices", KIND_SLICES},
    {"hidden", "Hidden surface", KIND_SAMPLES},
    {"hiddenat", "Hidden surface, radius", KIND_WEIGHED},
    {"beyond", "Surface behind that", KIND_SAMPLES},
    {"beyondat", "Surface behind that, radius", KIND_WEIGHED},
    {"mixed", "Back of mixed pixels", KIND_SAMPLES},
    {"mixedat", "Back of mixed pixels, radius", KIND_WEIGHED},
    {"seen", "Visible surface", KIND_COLOUR},
    {"seenat", "Visible surface, radius", KIND_WEIGHED},
    {"radius", "Radius", KIND_RADIUS},
    {"quads", "Farthest of four", KIND_SAMPLES},
    {"quadsat", "Farthest of four, radius", KIND_WEIGHED},
    {"coc", "CoC, near and far", KIND_FIELDS},
    {"coc4", "CoC, half size", KIND_FIELDS},
    {"cocmax", "Near CoC, largest around", KIND_NUMBER},
    {"cocblur", "Near CoC, blurred", KIND_NUMBER},
    {"color4", "Colour, half size", KIND_COLOUR},
    {"colormulcoc4", "Colour times far CoC", KIND_COLOUR},
    {"near", "Near field", KIND_COLOUR},
    {"far", "Far field", KIND_COLOUR},
};

static struct known_buffer what_is(const struct hf_inspect_buffer *b)
{
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
        if (!strcmp(known[i].name, b->name))
            return known[i];
    return (struct known_buffer){b->name, b->name,
                                 b->channels >= 3   ? KIND_COLOUR
                                 : b->channels == 2 ? KIND_FIELDS
                                                    : KIND_NUMBER};
}

// The sample of a buffer of full, half or quarter resolution at a pixel of the result.
static float sample(const struct hf_inspect_buffer *b, int c, const struct view_result *result, int x, int y)
{
    const int step = MAX(1, (int)lround((double)result->width / b->width));
    const int u = MIN((result->at.x + x) / step, b->width - 1), v = MIN((result->at.y + y) / step, b->height - 1);
    return ((const float *)((const char *)b->data[c] + v * b->stride))[u];
}

// Take a buffer as the picture of the result: channels that it lacks become 0. With weights only what weighs something stays.
static void take_buffer(const struct hf_inspect_buffer *b, int weights, struct view_result *result)
{
    for (int y = 0; y < result->at.height; y++)
        for (int x = 0; x < result->at.width; x++)
            for (int c = 0; c < 3; c++) {
                float *to = &result->plane[c][(size_t)y * (size_t)result->at.width + (size_t)x];
                if (weights)
                    *to = sample(b, 0, result, x, y) > 0 ? *to : 0;
                else
                    *to = c < b->channels ? sample(b, c, result, x, y) : 0;
            }
}

void view_dump_buffer(void *cookie, const struct hf_inspect_buffer *buffer)
{
    struct view_dump *d = cookie;
    const struct known_buffer what = what_is(buffer);
    const size_t n = strlen(buffer->name);
    char *names = NULL;
    if (asprintf(&names, "%s%s\n", d->result->buffers ? d->result->buffers : "", what.label) >= 0) {
        free(d->result->buffers);
        d->result->buffers = names;
    }
    if (!strcmp(what.label, d->wanted)) {
        take_buffer(buffer, 0, d->result);
        d->taken = what.kind == KIND_SAMPLES ? what.name : NULL;
        d->result->kind = (int)what.kind;
        d->result->channels = MIN(buffer->channels, 3);
    } else if (d->taken && n == strlen(d->taken) + 2 && !strncmp(buffer->name, d->taken, n - 2)) {
        take_buffer(buffer, 1, d->result);
    }
}

// Neighbouring slices in colours that differ much.
static uint32_t slice_colour(float place, float grey)
{
    const float below = floorf(place), part = place - below, light = 0.25f + 0.75f * grey;
    float rgb[3];
    for (int c = 0; c < 3; c++) {
        const float a = 0.5f + 0.5f * cosf(2.4f * below + 2.1f * (float)c);
        const float b = 0.5f + 0.5f * cosf(2.4f * (below + 1) + 2.1f * (float)c);
        rgb[c] = light * (a + part * (b - a));
    }
    return view_look_pixel(rgb[0], rgb[1], rgb[2]);
}

static uint32_t buffer_colour(const struct view_result *r, size_t i, float largest, float grey)
{
    const float a = r->plane[0][i], b = r->plane[1][i];
    switch ((enum kind)r->kind) {
    case KIND_NUMBER:
        return view_look_pixel(a / largest, a / largest, a / largest);
    case KIND_FIELDS:
        return view_look_pixel(a / largest, 0.2f * grey, b / largest);
    case KIND_RADIUS:
        return radius_colour(a, largest, grey);
    case KIND_WEIGHED:
        return a > 0 ? radius_colour(b, largest, grey) : 0xff000000u;
    case KIND_SLICES:
        return slice_colour(a, grey);
    default:
        return r->pixels[i];
    }
}

static void paint_buffer(const struct view_pixels *p, struct view_result *r)
{
    const struct hf_region *at = &r->at;
    const size_t n = (size_t)at->width * (size_t)at->height;
    float largest = 1e-6f;
    for (size_t i = 0; i < n; i++) {
        const float a = r->kind == KIND_WEIGHED && !(r->plane[0][i] > 0) ? 0 : r->plane[r->kind == KIND_WEIGHED][i];
        largest = fmaxf(largest, fabsf(a));
        if (r->kind == KIND_FIELDS)
            largest = fmaxf(largest, fabsf(r->plane[1][i]));
    }
    for (int y = 0; y < at->height; y++)
        for (int x = 0; x < at->width; x++)
            row_of(r, y)[x] = buffer_colour(r, (size_t)y * (size_t)at->width + (size_t)x, largest,
                                            grey_of(p, (size_t)(at->y + y) * (size_t)p->width + (size_t)(at->x + x)));
}

void view_false_colour(const struct view_request *q, const struct view_pixels *p, const struct hf_params *params,
                       const struct hf_depth *depth, struct view_result *result)
{
    const struct hf_region *at = &result->at;
    if (q->show == VIEW_SHOW_DEPTH)
        paint_depth(p, depth, result);
    if (q->show == VIEW_SHOW_TILES && result->tiles)
        paint_tiles(&result->report.inner, result->tiles, result->tile_count, result);
    if (result->kind != KIND_COLOUR)
        paint_buffer(p, result);
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
